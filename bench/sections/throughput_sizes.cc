#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "bench/baselines/register_scan.h"
#include "bench/measure/line_fit.h"
#include "bench/sections/throughput.h"
#include "halfspace/reject.h"

namespace halfspace::bench {
namespace {

// Of a cache level: three sizes, none above half of it.
struct Share {
  std::size_t eighths;
  const char* name;
};
constexpr std::array<Share, 3> kShares = {{{2, "1/4"}, {3, "3/8"}, {4, "1/2"}}};

constexpr std::array<std::size_t, 7> kFitted = {64,  128, 256, 384,
                                                512, 768, 1024};

// One flat call after the other on the first objects of a world.
class Calls {
 public:
  Calls(const Workload& workload, std::size_t most)
      : world_(ResizedTo(workload.objects, most)),
        queries_(workload.queries),
        mask_(MaskWords(most)) {}

  // Its items are `items` for a call. The view and the queries are of that
  // shape beforehand, as a user's are.
  Case FlatCase(std::string name, ShapeKind shape, std::size_t objects,
                Target target, double items) {
    const std::size_t calls = CallsOfRun(objects);
    Case c;
    c.name = std::move(name);
    c.items = items * static_cast<double>(calls);
    WithShape(shape, First(objects), queries_.front(),
              [&](const auto& view, const auto& query) {
                c.run = [this, target, calls, view,
                         queries = QueriesLike(query),
                         next = std::size_t{0}]() mutable {
                  for (std::size_t i = 0; i < calls; ++i) {
                    RejectMask(view, queries[next], mask_,
                               {.schedule = Schedule::kFlat, .target = target});
                    next = next + 1 == queries.size() ? 0 : next + 1;
                  }
                };
              });
    return c;
  }

  Case RegisterCase(std::string name, ShapeKind shape, std::size_t objects,
                    RegisterScan scan) {
    const std::size_t calls = CallsOfRun(objects);
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(calls);
    c.run = [this, shape, objects, calls, scan,
             planes = PlanesOf(shape, world_.view()),
             query = QueryOf(shape, queries_[0])] {
      for (std::size_t i = 0; i < calls; ++i) {
        scan(shape, planes.data(), query.data(), objects, mask_.data());
      }
    };
    return c;
  }

 private:
  static std::size_t CallsOfRun(std::size_t objects) {
    return std::max<std::size_t>(1, kObjectsPerRun / objects);
  }
  AaboView3 First(std::size_t objects) const {
    AaboView3 view = world_.view();
    view.size = objects;
    return view;
  }
  template <typename Query>
  std::vector<Query> QueriesLike(const Query&) const {
    std::vector<Query> queries;
    for (const Aabo3& query : queries_) queries.push_back(SeenAs<Query>(query));
    return queries;
  }

  AaboWorld3 world_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint64_t> mask_;
};

std::size_t BytesOfRecord(ShapeKind shape) {
  return PlaneCountOf(shape) * sizeof(float);
}

// ns per object over three sizes in one level.
void RunFlatness(const Workload& workload, const Machine& machine, int level,
                 Throughput& throughput) {
  const std::size_t bytes = machine.CacheBytes(level);
  const std::string set = "L" + std::to_string(level);
  Calls calls(workload, bytes / 2 / BytesOfRecord(ShapeKind::kSimplex));
  for (Target target : throughput.targets()) {
    double worst = 0.0;
    ShapeKind worst_shape = kShapes.front();
    for (ShapeKind shape : kShapes) {
      std::vector<Case> cases;
      std::vector<ThroughputRow> rows;
      for (const Share& share : kShares) {
        ThroughputRow row;
        row.name = std::string(NameOf(shape)) + " flat, " + share.name;
        row.objects =
            bytes * share.eighths / 8 / BytesOfRecord(shape) / 64 * 64;
        row.queries = 1;
        row.working_set = set;
        row.target = NameOf(target);
        cases.push_back(calls.FlatCase(
            "sizes/" + set + "/" + row.target + "/" + row.name, shape,
            row.objects, target, static_cast<double>(row.objects)));
        rows.push_back(std::move(row));
      }
      const Timings timings = throughput.TimeBriefly(std::move(cases));
      double low = timings[0].Median();
      double high = low;
      for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].ns_per_pair = timings[i].Median();
        low = std::min(low, rows[i].ns_per_pair);
        high = std::max(high, rows[i].ns_per_pair);
        throughput.AddRowUnder(
            {level == 1 ? Ceiling::Kind::kRegisters : Ceiling::Kind::kRead,
             shape, set, target},
            rows[i]);
      }
      if (high / low > worst) {
        worst = high / low;
        worst_shape = shape;
      }
    }
    throughput.AddRatio(aims::kSizes, target,
                        "ns per object, slowest of three sizes over fastest, " +
                            set + ", " + NameOf(target) + " (" +
                            NameOf(worst_shape) + ")",
                        worst);
  }
}

// what a call costs by itself; and what an object costs without
// that, against registers (threshold 2).
void RunFit(Calls& calls, ShapeKind shape, Target target,
            std::size_t half_of_l1, Throughput& throughput) {
  const std::string name = NameOf(target) + "/" + NameOf(shape);
  const RegisterScan scan = RegisterScansFor(target).one;
  std::vector<Case> cases;
  cases.reserve(2 * kFitted.size());
  for (std::size_t objects : kFitted) {
    cases.push_back(
        calls.FlatCase("call/" + name + "/" + std::to_string(objects), shape,
                       objects, target, 1.0));
  }
  if (scan != nullptr) {
    for (std::size_t objects : kFitted) {
      cases.push_back(calls.RegisterCase(
          "call-registers/" + name + "/" + std::to_string(objects), shape,
          objects, scan));
    }
  }
  const Timings timings = throughput.TimeBriefly(std::move(cases));
  const auto fit = [&](std::size_t first, std::size_t most) {
    std::vector<double> sizes;
    std::vector<double> times;
    for (std::size_t i = 0; i < kFitted.size() && kFitted[i] <= most; ++i) {
      sizes.push_back(static_cast<double>(kFitted[i]));
      times.push_back(timings[first + i].Median());
    }
    return FitLine(sizes, times);
  };
  const std::string which =
      std::string(NameOf(shape)) + " flat, " + NameOf(target);
  throughput.AddRatio(aims::kCall, target, "ns of a call by itself, " + which,
                      fit(0, kFitted.back()).intercept);
  if (scan == nullptr) return;
  const std::size_t most = half_of_l1 / BytesOfRecord(shape);
  throughput.AddRatio(
      aims::kRegisters, target,
      std::string(NameOf(shape)) + " flat, L1, " + NameOf(target) +
          ": % of registers, one query, slope over sizes",
      100.0 * fit(kFitted.size(), most).slope / fit(0, most).slope);
}

}  // namespace

void AddSizeParts(const Workload& workload, const Machine& machine,
                  ThroughputParts& parts) {
  for (int level = 1; level <= 3; ++level) {
    if (machine.are_caches_known() && !machine.HasCache(level)) continue;
    parts.push_back([&workload, &machine, level](Throughput& throughput) {
      RunFlatness(workload, machine, level, throughput);
    });
  }
  parts.push_back([&workload, &machine](Throughput& throughput) {
    const std::size_t half = machine.CacheBytes(1) / 2;
    Calls calls(workload, kFitted.back());
    for (Target target : throughput.targets()) {
      for (ShapeKind shape : kShapes)
        RunFit(calls, shape, target, half, throughput);
    }
  });
}

}  // namespace halfspace::bench
