// A call of kernels.h, and the checked one of reject.h, beside loops that are
// written by hand for the target.
#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/baselines/by_hand.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/working_set.h"
#include "halfspace/kernels.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

Kernels<float>::OfBound KernelsFor(ShapeKind shape, Target target) {
  const Kernels<float>& kernels = KernelsOf<float>(target);
  return shape == ShapeKind::kAabb      ? kernels.boxes3
         : shape == ShapeKind::kSimplex ? kernels.simplices3
                                        : kernels.octahedra3;
}

void AddRows(Run& run, WorkingSet& set, ShapeKind shape, Target target,
             Table& table) {
  const LoopByHand by_hand = LoopByHandOf(shape, target.name());
  if (by_hand == nullptr) return;
  const std::string place = "tier/" + std::string(NameOf(shape)) + "/" +
                            NameOf(target) + "/" +
                            std::to_string(set.objects()) + "/";
  // Of each query, its values one after the other, and a mask that survives.
  const std::size_t count = PlaneCountOf(shape);
  std::vector<float> values;
  for (const Aabo3& query : set.queries()) {
    const std::vector<float> of_query = QueryOf(shape, query);
    values.insert(values.end(), of_query.begin(), of_query.end());
  }
  const std::vector<const float*> planes = PlanesOf(shape, set.view());
  const auto unchecked = [&](const char* name, LoopByHand loop) {
    return set.CallCase(
        place + name, shape, [&, loop](std::size_t q, std::uint64_t* mask) {
          loop(planes.data(), set.objects(), &values[q * count], mask);
        });
  };
  const auto checked = WithShape(
      shape, set.view(), set.queries().front(),
      [&]<typename Query>(const auto& view, const Query& /*query*/) {
        std::vector<Query> queries;
        for (const Aabo3& query : set.queries()) {
          queries.push_back(SeenAs<Query>(query));
        }
        return set.CallCase(place + "reject.h", shape,
                            [view, target, queries = std::move(queries)](
                                std::size_t q, std::uint64_t* mask) {
                              SurvivorMask(view, queries[q],
                                           {mask, MaskWords(view.size)},
                                           {.target = target});
                            });
      });
  constexpr const char* kNames[] = {"by hand", "kernels.h", "reject.h"};
  const std::vector<Timing> timings =
      run.Time({unchecked(kNames[0], by_hand),
                unchecked(kNames[1], KernelsFor(shape, target).one), checked});
  for (std::size_t i = 0; i < timings.size(); ++i) {
    table.Add({NameOf(shape), NameOf(target), set.objects(), kNames[i],
               SpreadOf(timings[i]), RatioOf(timings[i], timings[0])});
  }
}

}  // namespace

Tables RunTier(Run& run) {
  Table table{"tier",
              "a call of kernels.h and one of reject.h, beside loops by hand",
              {Key("shape"), Key("target"), Key("objects"), Key("by"),
               Value("time", "ns", 1), Lower("over by hand")}};
  for (std::size_t objects : {64, 256, 4096, 16384}) {
    WorkingSet set(run.Measured(), {"tier", objects});
    for (ShapeKind shape : kShapes) {
      for (Target target : run.targets) {
        AddRows(run, set, shape, target, table);
      }
    }
  }
  if (table.is_empty()) {
    table.notes.push_back(
        "There are loops by hand for AVX2 and AVX3 on x86-64, and for NEON on "
        "aarch64.");
  }
  return {table};
}

}  // namespace halfspace::bench
