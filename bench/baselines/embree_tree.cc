#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/baselines/box_tree.h"
#include "bench/baselines/touches.h"

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

RTCRay RayOf(const Segment<3>& segment) {
  RTCRay ray{};
  ray.org_x = segment.a[0];
  ray.org_y = segment.a[1];
  ray.org_z = segment.a[2];
  ray.dir_x = segment.b[0] - segment.a[0];
  ray.dir_y = segment.b[1] - segment.a[1];
  ray.dir_z = segment.b[2] - segment.a[2];
  ray.tfar = 1;
  ray.mask = ~0u;
  return ray;
}

// A tree of user geometry. Its queries of points are spheres, so that it has
// none for boxes. The ends of a segment are at most twice as far from 0, on
// each axis, as the farthest corner of a box.
class EmbreeTree : public LineTree, public PairFinder {
 public:
  explicit EmbreeTree(std::span<const Aabb3> boxes)
      : boxes_(boxes.begin(), boxes.end()), scene_(rtcNewScene(Device::Get())) {
    float farthest = 0;
    for (const Aabb3& box : boxes_) {
      for (std::size_t k = 0; k < 3; ++k) {
        farthest =
            std::max({farthest, std::abs(box.min[k]), std::abs(box.max[k])});
      }
    }
    // A ray's direction, its reciprocal and its product with the origin are
    // rounded to float, which moves the ray by a few ulps of the farthest
    // coordinate.
    slack_ = farthest * 0x1p-18f;

    const RTCGeometry geometry =
        rtcNewGeometry(Device::Get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry,
                                     static_cast<unsigned>(boxes_.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(geometry, &EmbreeTree::Bound, nullptr);
    rtcSetGeometryOccludedFunction(geometry, &EmbreeTree::TakeOnLine);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(Device::Get()) != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree: no tree");
    }
  }
  ~EmbreeTree() override { rtcReleaseScene(scene_); }

  void Along(const Segment<3>& segment,
             std::vector<std::uint32_t>& found) const override {
    found.clear();
    LineSearch search{{}, &segment, &found};
    rtcInitIntersectContext(&search.context);
    RTCRay ray = RayOf(segment);
    rtcOccluded1(scene_, &search.context, &ray);
  }

  void Pairs(std::vector<IndexPair>& found) override {
    found.clear();
    if (boxes_.empty()) return;  // Embree has no collider for it.
    PairSearch search{boxes_.data(), &found};
    rtcCollide(scene_, scene_, &EmbreeTree::TakePairs, &search);
  }

 private:
  struct LineSearch {
    RTCIntersectContext context;  // first, as Embree hands it on
    const Segment<3>* segment;
    std::vector<std::uint32_t>* found;
  };
  struct PairSearch {
    const Aabb3* boxes;
    std::vector<IndexPair>* found;
  };

  static void Bound(const RTCBoundsFunctionArguments* arguments) {
    const auto* tree =
        static_cast<const EmbreeTree*>(arguments->geometryUserPtr);
    const Aabb3& box = tree->boxes_[arguments->primID];
    RTCBounds& bounds = *arguments->bounds_o;
    bounds.lower_x = tree->Below(box.min[0]);
    bounds.lower_y = tree->Below(box.min[1]);
    bounds.lower_z = tree->Below(box.min[2]);
    bounds.upper_x = tree->Above(box.max[0]);
    bounds.upper_y = tree->Above(box.max[1]);
    bounds.upper_z = tree->Above(box.max[2]);
  }
  float Below(float value) const {
    return std::nextafter(value - slack_, -std::numeric_limits<float>::max());
  }
  float Above(float value) const {
    return std::nextafter(value + slack_, std::numeric_limits<float>::max());
  }

  // As no hit is ever told, the ray goes on.
  static void TakeOnLine(const RTCOccludedFunctionNArguments* arguments) {
    const auto* tree =
        static_cast<const EmbreeTree*>(arguments->geometryUserPtr);
    const auto& search =
        *reinterpret_cast<const LineSearch*>(arguments->context);
    if (Touches(*search.segment, tree->boxes_[arguments->primID])) {
      search.found->push_back(arguments->primID);
    }
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
  float slack_;
};

const Registered<LineTree> kLines("Embree", [](auto boxes) {
  return std::make_unique<EmbreeTree>(boxes);
});
const Registered<PairFinder> kPairs("Embree", [](auto boxes) {
  return std::make_unique<EmbreeTree>(boxes);
});

}  // namespace
}  // namespace halfspace::bench
