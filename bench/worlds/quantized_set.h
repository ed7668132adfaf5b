// Quantized octahedra and their floats, and the cases that are timed and
// checked on them with one query at a time.
#ifndef HALFSPACE_BENCH_WORLDS_QUANTIZED_SET_H_
#define HALFSPACE_BENCH_WORLDS_QUANTIZED_SET_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bench/baselines/plane_reader.h"
#include "bench/measure/measure.h"
#include "bench/worlds/workload.h"
#include "halfspace/quantized.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

// A quantized world of octahedra, larger than the last-level cache.
class QuantizedSet {
 public:
  QuantizedSet(const Workload& workload, std::size_t objects)
      : floats_(ResizedTo(workload.objects, objects)),
        world_(floats_),
        queries_(workload.queries),
        indices_(objects),
        mask_(MaskWords(objects)) {}

  std::size_t objects() const { return world_.size(); }
  const AaboWorld3& floats() const { return floats_; }
  const QuantizedWorld<AaboView3>& world() const { return world_; }

  // The quantized planes in order: all minima, which are the first stage, then
  // all maxima.
  BytePlanes QuantizedPlanes(std::size_t count) const {
    const auto view = world_.quantized().view();
    BytePlanes planes;
    for (std::size_t p = 0; p < count; ++p) {
      planes.push_back(reinterpret_cast<const unsigned char*>(
          view.planes().planes().plane(p)));
    }
    return planes;
  }

  // Survivors as indices, checked against those of the floats.
  template <typename AnyWorld>
  Case IndicesCase(std::string name, const AnyWorld& world,
                   const Options& options) {
    Case c = CaseOf(std::move(name));
    c.run = [this, &world, options, next = std::size_t{0}]() mutable {
      std::ignore = Survivors(world, queries_[next], indices_, options);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    c.check = [this, &world, options]() -> std::string {
      for (std::size_t q = 0; q < Checked(); ++q) {
        const auto list = [&](const auto& any, const Options& how) {
          indices_.resize(objects());
          const std::size_t count = Survivors(any, queries_[q], indices_, how);
          return std::vector<std::uint32_t>(
              indices_.begin(),
              indices_.begin() + static_cast<std::ptrdiff_t>(count));
        };
        if (list(world, options) !=
            list(floats_, {.schedule = Schedule::kFlat})) {
          return "query " + std::to_string(q) +
                 ": the survivors are not those of the floats";
        }
      }
      return {};
    };
    return c;
  }

  // Quantized bounds alone, as a mask that keeps all that the floats keep.
  Case QuantizedCase(std::string name, const Options& options) {
    Case c = CaseOf(std::move(name));
    c.run = [this, options, next = std::size_t{0}]() mutable {
      SurvivorMask(world_.quantized(), queries_[next], mask_, options);
      next = next + 1 == queries_.size() ? 0 : next + 1;
    };
    c.check = [this, options]() -> std::string {
      std::vector<std::uint64_t> exact(mask_.size());
      for (std::size_t q = 0; q < Checked(); ++q) {
        SurvivorMask(floats_, queries_[q], exact);
        SurvivorMask(world_.quantized(), queries_[q], mask_, options);
        for (std::size_t w = 0; w < exact.size(); ++w) {
          if ((exact[w] & ~mask_[w]) != 0)
            return "a quantized bound falsely rejects";
        }
      }
      return {};
    };
    return c;
  }

  Case ReadCase(std::string name, std::size_t planes, ReadWay way,
                Target target) {
    Case c = CaseOf(std::move(name));
    c.run = [this, read = PlaneReaderFor(target), way,
             list = QuantizedPlanes(planes)] {
      KeepResult(read(way, list.data(), list.size(), objects()));
    };
    return c;
  }

 private:
  static constexpr std::size_t kCheckedQueries = 2;

  Case CaseOf(std::string name) const {
    Case c;
    c.name = std::move(name);
    c.items = static_cast<double>(objects());
    return c;
  }
  std::size_t Checked() const {
    return std::min(kCheckedQueries, queries_.size());
  }

  AaboWorld3 floats_;
  QuantizedWorld<AaboView3> world_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint32_t> indices_;
  std::vector<std::uint64_t> mask_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_QUANTIZED_SET_H_
