// Copying as many bytes: what bulk builders are measured by.
#ifndef HALFSPACE_BENCH_BASELINES_COPY_H_
#define HALFSPACE_BENCH_BASELINES_COPY_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/inner/target_loops.h"
#include "halfspace/targets.h"

namespace halfspace::bench {

class Copy {
 public:
  // Reads half of so many bytes and writes the other half.
  explicit Copy(std::size_t bytes)
      : from_(bytes / 2 / sizeof(Lines)), to_(from_.size()) {}

  // With the widest vectors. Stores past the caches if `streamed`, which is
  // faster or not.
  void Run(bool streamed) {
    loop_(streamed, from_[0].words.data(), to_[0].words.data(),
          from_.size() * from_[0].words.size());
  }

 private:
  struct alignas(64) Lines {
    std::array<std::uint32_t, 64> words;
  };

  std::vector<Lines> from_;
  std::vector<Lines> to_;
  decltype(TargetLoops::copy) loop_ = LoopsFor(SupportedTargets().front()).copy;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_BASELINES_COPY_H_
