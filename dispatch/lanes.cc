// The vector length of every target; SVE has to ask the hardware.
#include "dispatch/target_table.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "dispatch/lanes.cc"
#include "hwy/foreach_target.h"  // IWYU pragma: keep
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

size_t FloatLanes() {
  return hwy::HWY_NAMESPACE::Lanes(hwy::HWY_NAMESPACE::ScalableTag<float>());
}

}  // namespace HWY_NAMESPACE

namespace dispatch {

template <>
std::size_t LanesOf<HWY_TARGET>() {
  return HWY_NAMESPACE::FloatLanes();
}

}  // namespace dispatch
}  // namespace halfspace
HWY_AFTER_NAMESPACE();
