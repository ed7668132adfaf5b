// The paper's work metric: half-spaces evaluated per object when a batch of w
// objects stops after the first half-space that leaves all of them rejected.
// It counts, it does not time: the same on every machine.
#ifndef HALFSPACE_BENCH_PAPER_WORK_COUNT_H_
#define HALFSPACE_BENCH_PAPER_WORK_COUNT_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bench/base/shape.h"
#include "halfspace/bounds.h"
#include "halfspace/world.h"

namespace halfspace::bench {

inline constexpr std::array<std::size_t, 7> kWorkWidths = {1,   8,    16,  64,
                                                           256, 1024, 4096};

// Averages over batches and queries, in the order of kWorkWidths. Planes are
// evaluated in the order of loops.h.
using WorkCount = PerShape<std::array<double, kWorkWidths.size()>>;

// The batches of `width` objects, a power of two, that have a bit of a mask.
// The last one may be short.
std::size_t BatchesLeft(std::span<const std::uint64_t> kept, std::size_t width);

// Adds up the batches in which each half-space was evaluated. Objects past the
// last full word of 64 are left out.
class WorkCounter {
 public:
  explicit WorkCounter(const AaboView3& objects) : objects_(objects) {}

  void Add(const Aabo3& query);
  WorkCount Average() const;

  // The sum over all queries.
  const PerShape<std::size_t>& survivors() const { return survivors_; }

  // The share of objects that reach each half-space of a shape: Pr[S_k] at
  // w = 1.
  std::vector<double> Reached(ShapeKind shape) const;

 private:
  // Batches that reach a half-space: per shape, per half-space in the order of
  // evaluation, per width.
  using ByWidth = std::array<std::size_t, kWorkWidths.size()>;

  AaboView3 objects_;
  std::size_t queries_ = 0;
  PerShape<std::array<ByWidth, 8>> reached_;
  PerShape<std::size_t> survivors_;
};

// Table 1 of "The Bounding Simplex: A SIMD-Era Rejection Primitive".
inline constexpr WorkCount kPaperWork = {
    .aabb = {1.56, 2.29, 2.64, 3.58, 4.27, 5.07, 5.77},
    .simplex = {1.87, 3.09, 3.39, 3.79, 3.93, 3.98, 4.00},
    .aabo = {1.87, 3.09, 3.40, 3.80, 4.00, 4.23, 4.90}};

inline constexpr PerShape<std::size_t> kPaperSurvivors = {21'814, 47'559,
                                                          20'039};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_PAPER_WORK_COUNT_H_
