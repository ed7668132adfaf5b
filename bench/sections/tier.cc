// A call of kernels.h, and the checked one of reject.h, beside loops that are
// written by hand for the target.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bench/base/shape.h"
#include "bench/base/text.h"
#include "bench/baselines/by_hand.h"
#include "bench/sections/run.h"
#include "bench/sections/sections.h"
#include "bench/worlds/working_set.h"
#include "halfspace/kernels.h"
#include "halfspace/reject.h"
#include "tests/reference/reference.h"

namespace halfspace::bench {
namespace {

constexpr std::size_t kSizes[] = {64, 256, 4096, 16384};

// The objects and queries of a shape, as the calls take them.
struct Arrays {
  AaboWorld3 world;
  ShapeKind shape;
  std::vector<const float*> planes;
  std::vector<float> values;  // of one query after the other
  std::vector<Aabo3> queries;

  std::size_t size() const { return world.size(); }
  const float* ValuesOf(std::size_t query) const {
    return &values[query * PlaneCountOf(shape)];
  }
};

// Whether the masks of some queries are those of the reference.
template <typename Test>
std::string Check(const Arrays& arrays, const Test& test) {
  std::vector<std::uint64_t> mask(MaskWords(arrays.size()));
  std::vector<std::uint64_t> rejected(mask.size());
  const std::size_t checked = std::min<std::size_t>(64, arrays.queries.size());
  for (std::size_t q = 0; q < checked; ++q) {
    WithShape(arrays.shape, arrays.world.view(), arrays.queries[q],
              [&](const auto& view, const auto& query) {
                reference::RejectMask(view, query, rejected.data());
              });
    test(q, mask.data());
    for (std::size_t w = 0; w < mask.size(); ++w) {
      if (mask[w] != ~rejected[w]) {
        return "query " + std::to_string(q) +
               ": the mask is not the scalar reference's";
      }
    }
  }
  return {};
}

// Calls test(query, mask) for one query after the other.
template <typename Test>
Case CaseOf(std::string name, const std::shared_ptr<Arrays>& arrays,
            const Test& test) {
  Case c = CaseOfQueries(
      std::move(name), arrays->queries.size(), arrays->size(),
      [test, mask = std::vector<std::uint64_t>(MaskWords(arrays->size()))](
          std::size_t q) mutable { test(q, mask.data()); });
  c.check = [arrays, test] { return Check(*arrays, test); };
  return c;
}

// One that calls function(planes, n, query, mask).
Case UncheckedCase(std::string name, const std::shared_ptr<Arrays>& arrays,
                   LoopByHand function) {
  return CaseOf(
      std::move(name), arrays,
      [arrays = arrays.get(), function](std::size_t q, std::uint64_t* mask) {
        function(arrays->planes.data(), arrays->size(), arrays->ValuesOf(q),
                 mask);
      });
}

// One that calls SurvivorMask().
Case CheckedCase(std::string name, const std::shared_ptr<Arrays>& arrays,
                 Target target) {
  return WithShape(
      arrays->shape, arrays->world.view(), arrays->queries.front(),
      [&]<typename Query>(const auto& view, const Query& /*query*/) {
        std::vector<Query> queries;
        for (const Aabo3& query : arrays->queries) {
          queries.push_back(SeenAs<Query>(query));
        }
        return CaseOf(
            std::move(name), arrays, [=](std::size_t q, std::uint64_t* mask) {
              SurvivorMask(view, queries[q], {mask, MaskWords(view.size)},
                           {.target = target});
            });
      });
}

Kernels<float>::OfBound KernelsFor(ShapeKind shape, Target target) {
  const Kernels<float>& kernels = KernelsOf<float>(target);
  return shape == ShapeKind::kAabb      ? kernels.boxes3
         : shape == ShapeKind::kSimplex ? kernels.simplices3
                                        : kernels.octahedra3;
}

void AddRows(Run& run, const std::shared_ptr<Arrays>& arrays, Table& table) {
  for (Target target : run.targets) {
    const LoopByHand by_hand = LoopByHandOf(arrays->shape, target.name());
    if (by_hand == nullptr) continue;
    const std::string place = std::string(NameOf(arrays->shape)) + "/" +
                              NameOf(target) + "/" +
                              std::to_string(arrays->size());
    const std::vector<Timing> timings =
        run.Time({UncheckedCase("tier/by hand/" + place, arrays, by_hand),
                  UncheckedCase("tier/kernels/" + place, arrays,
                                KernelsFor(arrays->shape, target).one),
                  CheckedCase("tier/checked/" + place, arrays, target)});
    table.Add({NameOf(arrays->shape), NameOf(target), arrays->size(),
               SpreadOf(timings[0]), SpreadOf(timings[1]),
               RatioOf(timings[1], timings[0]),
               RatioOf(timings[2], timings[0])});
  }
}

}  // namespace

Tables RunTier(Run& run) {
  Table table{
      "tier",
      "a call of kernels.h and one of reject.h, beside loops by hand",
      {Key("shape"), Key("target"), Key("objects"), Value("by hand", "ns", 1),
       Value("kernels.h", "ns", 1), Lower("kernels.h / by hand", "", 2),
       Lower("reject.h / by hand", "", 2)}};
  const Workload& workload = run.Measured();
  for (std::size_t objects : kSizes) {
    for (ShapeKind shape : kShapes) {
      auto arrays = std::make_shared<Arrays>();
      arrays->world = ResizedTo(workload.objects, objects);
      arrays->shape = shape;
      arrays->planes = PlanesOf(shape, arrays->world.view());
      arrays->queries = workload.timed_queries;
      for (const Aabo3& query : arrays->queries) {
        const std::vector<float> values = QueryOf(shape, query);
        arrays->values.insert(arrays->values.end(), values.begin(),
                              values.end());
      }
      AddRows(run, arrays, table);
    }
  }
  if (table.is_empty()) {
    table.notes.push_back(
        "There are loops by hand for SSE4, AVX2 and AVX3 on x86-64, and for "
        "NEON on aarch64.");
  }
  return {table};
}

}  // namespace halfspace::bench
