// Target: the instruction set that a call runs on. targets.h lists them.
//
// Thread safety: a plain value.
#ifndef HALFSPACE_TARGET_H_
#define HALFSPACE_TARGET_H_

#include <cstddef>
#include <cstdint>

#include "halfspace/export.h"

namespace halfspace {

// A std::string_view that is defined in targets.h, because the headers of the
// calls do not need the 5000 lines of <string_view>.
class TargetName;

// A handle of one target, a plain value. A default-constructed handle stands
// for the chosen target.
class Target {
 public:
  constexpr Target() = default;

  // Returns Highway's name, for example "AVX2", or "auto" for a default handle.
  // Include targets.h to call it.
  HALFSPACE_API TargetName name() const;

  // Returns the number of float lanes of one vector. On SVE the hardware
  // determines it. Returns 0 for a default handle and for a target that is not
  // supported here.
  HALFSPACE_API std::size_t lanes() const;

  // Returns the number of float lanes of the vectors that test one query on
  // more than 64 objects. With AVX-512 it is 8 or 16, whichever is faster on
  // this CPU. Elsewhere it is lanes().
  HALFSPACE_API std::size_t one_query_lanes() const;

  // Returns Highway's bit (HWY_AVX2 and so on), or 0 for a default handle. The
  // meaning of a bit can change with the version of Highway. Do not store it:
  // store the name.
  constexpr std::int64_t highway_bit() const { return highway_bit_; }
  static constexpr Target FromHighwayBit(std::int64_t bit) {
    Target target;
    target.highway_bit_ = bit;
    return target;
  }

  friend constexpr bool operator==(Target a, Target b) {
    return a.highway_bit_ == b.highway_bit_;
  }
  friend constexpr bool operator!=(Target a, Target b) { return !(a == b); }

 private:
  std::int64_t highway_bit_ = 0;
};

}  // namespace halfspace

#endif  // HALFSPACE_TARGET_H_
