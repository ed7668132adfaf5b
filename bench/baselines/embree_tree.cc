#include <embree3/rtcore.h>

#include <stdexcept>

#include "bench/baselines/box_tree.h"

namespace halfspace::bench {
namespace {

// One for the process, as it sets how many threads Embree uses there.
class Device {
 public:
  Device() : device_(rtcNewDevice("threads=1")) {
    if (device_ == nullptr) throw std::runtime_error("Embree: no device");
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { rtcReleaseDevice(device_); }

  static RTCDevice Get() {
    static const Device device;
    return device.device_;
  }

 private:
  RTCDevice device_;
};

// A tree of user geometry. Its queries of points are spheres, so that it has
// none for boxes.
class EmbreeTree : public PairFinder {
 public:
  explicit EmbreeTree(std::span<const Aabb3> boxes)
      : boxes_(boxes.begin(), boxes.end()), scene_(rtcNewScene(Device::Get())) {
    const RTCGeometry geometry =
        rtcNewGeometry(Device::Get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry,
                                     static_cast<unsigned>(boxes_.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &EmbreeTree::Bound, nullptr);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(Device::Get()) != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree: no tree");
    }
  }
  ~EmbreeTree() override { rtcReleaseScene(scene_); }

  void Pairs(std::vector<IndexPair>& found) override {
    found.clear();
    if (boxes_.empty()) return;  // Embree has no collider for it.
    PairSearch search{boxes_.data(), &found};
    rtcCollide(scene_, scene_, &EmbreeTree::TakePairs, &search);
  }

 private:
  struct PairSearch {
    const Aabb3* boxes;
    std::vector<IndexPair>* found;
  };

  static void Bound(const RTCBoundsFunctionArguments* arguments) {
    const auto* tree =
        static_cast<const EmbreeTree*>(arguments->geometryUserPtr);
    const Aabb3& box = tree->boxes_[arguments->primID];
    RTCBounds& bounds = *arguments->bounds_o;
    bounds.lower_x = box.min[0];
    bounds.lower_y = box.min[1];
    bounds.lower_z = box.min[2];
    bounds.upper_x = box.max[0];
    bounds.upper_y = box.max[1];
    bounds.upper_z = box.max[2];
  }
  // Embree finds each pair in both orders.
  static void TakePairs(void* user, RTCCollision* collisions, unsigned count) {
    const auto& search = *static_cast<const PairSearch*>(user);
    for (unsigned i = 0; i < count; ++i) {
      const unsigned a = collisions[i].primID0;
      const unsigned b = collisions[i].primID1;
      if (a < b && Touches(search.boxes[a], search.boxes[b])) {
        search.found->push_back({a, b});
      }
    }
  }

  std::vector<Aabb3> boxes_;
  RTCScene scene_;
};

const Registered<PairFinder> kPairs("Embree", [](auto boxes) {
  return std::make_unique<EmbreeTree>(boxes);
});

}  // namespace
}  // namespace halfspace::bench
