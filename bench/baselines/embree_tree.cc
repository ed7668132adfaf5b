#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bench/baselines/box_tree.h"
#include "bench/baselines/triangles.h"

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

// The closest point of a triangle, by the corner, edge or face whose region it
// is in (Ericson, "Real-Time Collision Detection", 5.1.5).
Vector3 ClosestOf(const Triangle3& triangle, const Vector3& point) {
  const auto moved = [](const Vector3& from, float part, const Vector3& way) {
    return Vector3{from[0] + part * way[0], from[1] + part * way[1],
                   from[2] + part * way[2]};
  };
  const auto& [a, b, c] = triangle;
  const Vector3 ab = Minus(b, a);
  const Vector3 ac = Minus(c, a);
  const Vector3 from_a = Minus(point, a);
  const float ab_a = Dot(ab, from_a);
  const float ac_a = Dot(ac, from_a);
  if (ab_a <= 0 && ac_a <= 0) return a;
  const Vector3 from_b = Minus(point, b);
  const float ab_b = Dot(ab, from_b);
  const float ac_b = Dot(ac, from_b);
  if (ab_b >= 0 && ac_b <= ab_b) return b;
  const Vector3 from_c = Minus(point, c);
  const float ab_c = Dot(ab, from_c);
  const float ac_c = Dot(ac, from_c);
  if (ac_c >= 0 && ab_c <= ac_c) return c;
  const float of_c = ab_a * ac_b - ab_b * ac_a;
  if (of_c <= 0 && ab_a >= 0 && ab_b <= 0) {
    return moved(a, ab_a / (ab_a - ab_b), ab);
  }
  const float of_b = ab_c * ac_a - ab_a * ac_c;
  if (of_b <= 0 && ac_a >= 0 && ac_c <= 0) {
    return moved(a, ac_a / (ac_a - ac_c), ac);
  }
  const float of_a = ab_b * ac_c - ab_c * ac_b;
  const float up = ac_b - ab_b;
  const float down = ab_c - ac_c;
  if (of_a <= 0 && up >= 0 && down >= 0) {
    return moved(b, up / (up + down), Minus(c, b));
  }
  const float sum = of_a + of_b + of_c;
  return moved(moved(a, of_b / sum, ab), of_c / sum, ac);
}

// With and without Embree's flag for edges that no ray passes.
class EmbreeTriangles : public TriangleTree {
 public:
  EmbreeTriangles(Input triangles, RTCSceneFlags flags)
      : triangles_(triangles.begin(), triangles.end()),
        scene_(rtcNewScene(Device::Get())) {
    rtcSetSceneFlags(scene_, flags);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    const RTCGeometry geometry =
        rtcNewGeometry(Device::Get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* const corners = static_cast<Triangle3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3),
        3 * triangles_.size()));
    auto* const indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
        3 * sizeof(unsigned), triangles_.size()));
    for (unsigned i = 0; i < triangles_.size(); ++i) {
      corners[i] = triangles_[i];
      for (unsigned c = 3 * i; c < 3 * i + 3; ++c) indices[c] = c;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    if (rtcGetDeviceError(Device::Get()) != RTC_ERROR_NONE) {
      throw std::runtime_error("Embree: no triangles");
    }
  }
  ~EmbreeTriangles() override { rtcReleaseScene(scene_); }

  float FirstHit(const Ray<3>& ray) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit hit{};
    hit.ray = RayOf(ray);
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &hit);
    return hit.hit.geomID == RTC_INVALID_GEOMETRY_ID
               ? std::numeric_limits<float>::infinity()
               : hit.ray.tfar;
  }
  bool IsHit(const Ray<3>& ray) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay its = RayOf(ray);
    rtcOccluded1(scene_, &context, &its);
    return its.tfar < 0;
  }
  float Distance(const Point<3>& point) const override {
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    constexpr float kFar = std::numeric_limits<float>::infinity();
    RTCPointQuery query = {point[0], point[1], point[2], 0, kFar};
    Search search = {triangles_.data(), kFar};
    rtcPointQuery(scene_, &query, &context, &EmbreeTriangles::Take, &search);
    return std::sqrt(search.squared);
  }

 private:
  struct Search {
    const Triangle3* triangles;
    float squared;
  };

  static RTCRay RayOf(const Ray<3>& ray) {
    RTCRay its{};
    its.org_x = ray.origin[0];
    its.org_y = ray.origin[1];
    its.org_z = ray.origin[2];
    its.dir_x = ray.direction[0];
    its.dir_y = ray.direction[1];
    its.dir_z = ray.direction[2];
    its.tfar = ray.max_t;
    its.mask = ~0u;
    return its;
  }
  static bool Take(RTCPointQueryFunctionArguments* arguments) {
    auto& search = *static_cast<Search*>(arguments->userPtr);
    const Vector3 point = {arguments->query->x, arguments->query->y,
                           arguments->query->z};
    const Vector3 way =
        Minus(ClosestOf(search.triangles[arguments->primID], point), point);
    const float squared = Dot(way, way);
    if (squared >= search.squared) return false;
    search.squared = squared;
    arguments->query->radius = std::sqrt(squared);
    return true;
  }

  std::vector<Triangle3> triangles_;
  RTCScene scene_;
};

const Registered<TriangleTree> kRobust("Embree, robust", [](auto triangles) {
  return std::make_unique<EmbreeTriangles>(triangles, RTC_SCENE_FLAG_ROBUST);
});
const Registered<TriangleTree> kTriangles("Embree", [](auto triangles) {
  return std::make_unique<EmbreeTriangles>(triangles, RTC_SCENE_FLAG_NONE);
});

const Registered<PairFinder> kPairs("Embree", [](auto boxes) {
  return std::make_unique<EmbreeTree>(boxes);
});

}  // namespace
}  // namespace halfspace::bench
