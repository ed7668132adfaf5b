// Bodies that move, and what is asked about them: what broad phases are
// measured on.
#ifndef HALFSPACE_BENCH_WORLDS_BODY_SCENE_H_
#define HALFSPACE_BENCH_WORLDS_BODY_SCENE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "bench/baselines/body_space.h"
#include "bench/worlds/random.h"
#include "halfspace/bounds.h"

namespace halfspace::bench {

enum class BodyKind {
  kGas,        // sides of 0.5 to 1.5, an eighth of the space; a quarter in 2D
  kSparse,     // the same bodies, a hundredth of the space
  kPile,       // a lattice of sides 1 that touch, and tremble
  kLogNormal,  // as dense as the gas
  kBepu,       // sides of 1 + 99 x^10, about as many pairs as bodies
  kFast,       // sides of 1, a tenth of the space, up to 2 sides in a frame
};
const char* NameOf(BodyKind kind);

// Moving bodies. A seed makes the same scene on every machine. A body moves
// through kStates places, and then back again.
template <int kDims>
class BodyScene {
 public:
  using Box = Aabb<kDims>;
  using Ids = std::vector<std::uint32_t>;

  static constexpr std::size_t kStates = 17;

  BodyScene(BodyKind kind, std::size_t bodies, std::uint64_t seed);

  std::size_t size() const { return boxes_.size(); }
  Ids AllIds() const;
  // Returns the ids of this share of bodies, the same in each frame.
  Ids Some(std::size_t percent) const;
  // The boxes of these bodies in a state.
  std::vector<Box> At(const Ids& ids, std::size_t state) const;

  // Whether these are the pairs after some bodies have moved to a state: those
  // that touch and have one of the bodies. A pair that touches by less than the
  // slack (BodySpace::Slack()) may be missing.
  bool ArePairs(const Ids& moved, std::size_t state, float slack,
                std::vector<IndexPair>& found) const;

 private:
  std::vector<Box> boxes_;
  std::vector<Point<kDims>> velocities_;  // of a frame
  std::uint64_t seed_;
};

}  // namespace halfspace::bench

#endif  // HALFSPACE_BENCH_WORLDS_BODY_SCENE_H_
