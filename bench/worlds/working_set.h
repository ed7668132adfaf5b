// A workload, cut to the sizes of the caches and of memory.
#ifndef HALFSPACE_BENCH_WORLDS_WORKING_SET_H_
#define HALFSPACE_BENCH_WORLDS_WORKING_SET_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/base/shape.h"
#include "bench/measure/machine.h"
#include "bench/measure/measure.h"
#include "bench/worlds/workload.h"
#include "halfspace/reject.h"

namespace halfspace::bench {

// One run of a case goes through this many objects at least, so that calls of a
// function object cost nothing beside them.
inline constexpr std::size_t kObjectsPerRun = std::size_t{1} << 16;

// The objects of sets beyond L1 are a multiple of this.
inline constexpr std::size_t kSetStep = 4096;

// A case that calls test(q) for one of `queries` queries after the other, each
// over so many objects. It is timed per call.
template <typename Test>
Case CaseOfQueries(std::size_t queries, std::size_t objects, Test test) {
  return InTurn(queries,
                std::clamp<std::size_t>(kObjectsPerRun / objects, 1, queries),
                std::move(test));
}

// A case that calls once(), which goes through so many objects, until a run has
// gone through enough. It is timed per object.
template <typename Once>
Case CaseOfObjects(std::size_t objects, Once once) {
  const std::size_t rounds = std::max<std::size_t>(1, kObjectsPerRun / objects);
  Case c;
  c.items = static_cast<double>(objects * rounds);
  c.run = [rounds, once = std::move(once)]() mutable {
    for (std::size_t i = 0; i < rounds; ++i) once();
  };
  return c;
}

// Where the planes of a world lie, and how many objects that is.
struct WorkingSetSize {
  std::string name;                  // "L1", "L2", "L3" or "memory"
  std::size_t objects = 0;           // a multiple of 4096, in L1 of 64
  std::string why_not_reached = {};  // empty if it is
  std::size_t bytes = 0;  // half the cache; in memory, of the simplex
};

// The octahedra take at most half of each cache; in "memory" the smallest
// record, the simplex's, takes four times the last level and 256 MiB at least,
// or it is not reached because that is more than a quarter of the free memory,
// or emulated.
std::vector<WorkingSetSize> WorkingSetSizes(const Machine& machine);

// A world of a given size, a mask to write, and the right answers.
class WorkingSet {
 public:
  WorkingSet(const Workload& workload, const WorkingSetSize& size)
      : WorkingSet(workload.objects, workload.timed_queries, size) {}
  WorkingSet(const AaboWorld3& objects, std::vector<Aabo3> queries,
             const WorkingSetSize& size);

  const std::string& name() const { return name_; }
  const AaboView3& view() const { return view_; }
  std::size_t objects() const { return view_.size; }
  const std::vector<Aabo3>& queries() const { return queries_; }
  std::vector<std::uint64_t>& mask() { return mask_; }

  // Empty if `write`, called for each query that has been answered by the
  // scalar reference, leaves the right reject mask; else what is wrong.
  using WriteMask = std::function<void(std::size_t query)>;
  std::string Check(ShapeKind shape, const WriteMask& write);

  // A case that calls `write` for one query after the other, of all that are to
  // be timed. It is timed per object.
  Case MakeCase(ShapeKind shape, const WriteMask& write);

  // The case of test(query, mask), which writes the survivor mask. It is timed
  // per call, without a function pointer.
  template <typename Test>
  Case CallCase(ShapeKind shape, const Test& test) {
    const auto write = [this, test](std::size_t q) { test(q, mask_.data()); };
    Case c = CaseOfQueries(queries_.size(), objects(), write);
    c.check = [this, shape, write] {
      return Check(shape, [this, write](std::size_t q) {
        write(q);
        for (std::uint64_t& word : mask_) word = ~word;
      });
    };
    return c;
  }

  // The case of a call of the library.
  Case LibraryCase(ShapeKind shape, const Options& options);

  // The case of scan(planes, query, size, mask) over the planes of the shape,
  // which writes the reject mask.
  using Scan =
      std::function<void(const float* const* planes, const float* query,
                         std::size_t size, std::uint64_t* mask)>;
  Case LoopCase(ShapeKind shape, const Scan& scan);

  // Reading the shape's planes, `turn` bytes of each in turn, with the vectors
  // of a target.
  Case ReadCase(ShapeKind shape, std::size_t turn, Target target) const;

 private:
  std::string name_;
  AaboWorld3 world_;
  AaboView3 view_;
  std::vector<Aabo3> queries_;
  std::vector<std::uint64_t> mask_;
  std::size_t checked_queries_;
  // Per shape, the reference's masks of the checked queries, one after another.
  // Made by the first check of the shape.
  std::array<std::vector<std::uint64_t>, kShapes.size()> expected_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_WORKING_SET_H_
