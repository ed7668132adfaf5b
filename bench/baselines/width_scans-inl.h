// How many lanes a loop has: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

size_t OneQueryLanes() { return hn::Lanes(OneTag<float>()); }

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();
