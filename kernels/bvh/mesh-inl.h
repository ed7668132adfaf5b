// Rays and closest points on a triangle mesh. The walk enters the nearest child
// first. Vectors of floats reject most triangles of a group, and a function
// tests the others exactly. docs/exactness.md proves that no triangle is
// rejected that the function would have accepted.
#if defined(HALFSPACE_KERNELS_BVH_MESH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef HALFSPACE_KERNELS_BVH_MESH_INL_H_
#undef HALFSPACE_KERNELS_BVH_MESH_INL_H_
#else
#define HALFSPACE_KERNELS_BVH_MESH_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hwy/highway.h"
#include "kernels/bvh/half_space_sum-inl.h"
#include "kernels/bvh/mesh.h"
#include "kernels/scan/words-inl.h"

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using MeshTag = hn::CappedTag<float, detail::kMeshLanes>;

// At least the distance of a coordinate of any point of the cube from that of
// `point`.
HWY_INLINE float ReachOf(const detail::MeshCube& cube, const float* point) {
  float most = 0;
  for (size_t k = 0; k < 3; ++k) {
    const float apart = cube.center[k] - point[k];
    most = HWY_MAX(most, HWY_MAX(apart, -apart));
  }
  return (most + cube.half) * (1 + 0x1p-16f);
}

// Search has the following members, and most_key(), which only falls:
//   ReadKeys(node, keys)    writes the keys of the children, and returns a bit
//                           for each whose key is not above most_key()
//   TakeGroup(group, bits)  tests its triangles. False ends the search.
template <class Search>
HWY_INLINE void WalkMesh(const detail::MeshTree& tree, Search& search) {
  struct Entry {
    float key;
    detail::MeshRef ref;
  };
  Entry waiting[detail::kMeshWaiting];
  size_t count = 0;
  detail::MeshRef ref = tree.root;
  for (;;) {
    const size_t index = detail::MeshIndexOf(ref);
    uint64_t bits = detail::MeshLanesOf(ref);
    if ((ref & detail::kMeshGroupBit) != 0) {
      if (!search.TakeGroup(tree.groups[index], bits)) return;
    } else {
      const detail::MeshNode& node = tree.nodes[index];
      HWY_ALIGN float keys[detail::kMeshLanes];
      bits &= search.ReadKeys(node, keys);
      // Those of this node wait in descending order.
      const size_t first = count;
      for (; bits != 0; bits &= bits - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
        size_t i = count++;
        for (; i > first && waiting[i - 1].key < keys[lane]; --i) {
          waiting[i] = waiting[i - 1];
        }
        waiting[i] = {keys[lane], node.child[lane]};
      }
    }
    do {
      if (count == 0) return;
      --count;
    } while (waiting[count].key > search.most_key());
    ref = waiting[count].ref;
  }
}

class MeshCaster {
 public:
  explicit MeshCaster(const detail::MeshCast& cast)
      : cast_(cast), limit_(cast.line.max_t) {}

  float most_key() const { return limit_ + detail::kApartOnLine; }

  // The key is the t at which the ray enters the box.
  HWY_INLINE uint64_t ReadKeys(const detail::MeshNode& node,
                               float* keys) const {
    const MeshTag d;
    uint64_t bits = 0;
    for (size_t i = 0; i < detail::kMeshLanes; i += hn::Lanes(d)) {
      auto enter = hn::Zero(d);
      auto exit = hn::Set(d, limit_);
      for (size_t p = 0; p < 3; ++p) enter = GreaterOf(At(node, p, i), enter);
      for (size_t p = 3; p < 6; ++p) exit = LesserOf(At(node, p, i), exit);
      exit = hn::Add(exit, hn::Set(d, detail::kApartOnLine));
      bits |= LaneBits(d, hn::Le(enter, exit)) << i;
      hn::Store(enter, d, keys + i);
    }
    return bits;
  }

  HWY_INLINE bool TakeGroup(const detail::MeshGroup& group, uint64_t bits) {
    bits &= Candidates(group) & ~uint64_t{group.are_points};
    for (; bits != 0; bits &= bits - 1) {
      const float limit = cast_.function(
          cast_.context, group, hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
      if (limit < limit_) limit_ = limit;
      if (limit_ < 0) return false;
    }
    return true;
  }

 private:
  HWY_INLINE hn::Vec<MeshTag> At(const detail::MeshNode& node, size_t p,
                                 size_t i) const {
    const MeshTag d;
    const detail::LinePlane& plane = cast_.line.plane[p];
    return hn::Mul(hn::Sub(hn::Load(d, node.planes[plane.plane] + i),
                           hn::Set(d, plane.offset)),
                   hn::Set(d, plane.inverse));
  }

  HWY_INLINE hn::Vec<MeshTag> From(const detail::MeshGroup& group,
                                   size_t corner, size_t axis, size_t i) const {
    const MeshTag d;
    return hn::Sub(
        hn::Load(d, group.corners[3 * corner + cast_.axis[axis]] + i),
        hn::Set(d, cast_.origin[cast_.axis[axis]]));
  }
  // A corner after a shear that turns the ray into axis 2.
  HWY_INLINE hn::Vec<MeshTag> Sheared(const detail::MeshGroup& group,
                                      size_t corner, size_t axis, size_t i,
                                      hn::Vec<MeshTag> z) const {
    const MeshTag d;
    return hn::NegMulAdd(hn::Set(d, cast_.shear[axis]), z,
                         From(group, corner, axis, i));
  }

  // A bit for each triangle that the ray can hit up to the limit.
  HWY_INLINE uint64_t Candidates(const detail::MeshGroup& group) const {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    const float reach = ReachOf(group.cube, cast_.origin);
    const float apart = reach * 0x1p-21f + 0x1p-140f;
    const float error =
        reach < 0x1p60f ? 8 * apart * (4 * group.cube.half + apart) + 0x1p-140f
                        : kInf;
    // Where the ray is between t = 0 and the limit, on axis 2.
    const bool is_up = cast_.speed > 0;
    const double speed = is_up ? cast_.speed : -cast_.speed;
    const auto way = static_cast<float>(
        (limit_ + 0x1p-149) * speed * (1 + 0x1p-20) + 0x1p-140);
    const float lowest = is_up ? 0.0f : -way;
    const float highest = is_up ? way : 0.0f;
    const MeshTag d;
    uint64_t bits = 0;
    for (size_t i = 0; i < detail::kMeshLanes; i += hn::Lanes(d)) {
      const auto az = From(group, 0, 2, i);
      const auto bz = From(group, 1, 2, i);
      const auto cz = From(group, 2, 2, i);
      const auto ax = Sheared(group, 0, 0, i, az);
      const auto ay = Sheared(group, 0, 1, i, az);
      const auto bx = Sheared(group, 1, 0, i, bz);
      const auto by = Sheared(group, 1, 1, i, bz);
      const auto cx = Sheared(group, 2, 0, i, cz);
      const auto cy = Sheared(group, 2, 1, i, cz);
      const auto side_a = hn::Sub(hn::Mul(bx, cy), hn::Mul(by, cx));
      const auto side_b = hn::Sub(hn::Mul(cx, ay), hn::Mul(cy, ax));
      const auto side_c = hn::Sub(hn::Mul(ax, by), hn::Mul(ay, bx));
      const auto most = hn::Max(side_a, hn::Max(side_b, side_c));
      const auto least = hn::Min(side_a, hn::Min(side_b, side_c));
      const auto misses = hn::And(hn::Gt(most, hn::Set(d, error)),
                                  hn::Lt(least, hn::Set(d, -error)));
      const auto low = hn::Min(az, hn::Min(bz, cz));
      const auto high = hn::Max(az, hn::Max(bz, cz));
      const auto is_out = hn::Or(hn::Gt(low, hn::Set(d, highest)),
                                 hn::Lt(high, hn::Set(d, lowest)));
      bits |= LaneBits(d, hn::Not(hn::Or(misses, is_out))) << i;
    }
    return bits;
  }

  const detail::MeshCast& cast_;
  float limit_;
};

template <class V>
HWY_INLINE V DotOf(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, hn::Mul(az, bz)));
}

// The squared distance of the origin from an edge that begins at x, y, z.
// `along` is their scalar product, and `length` the squared length of the edge.
template <class D, class V>
HWY_INLINE V SquaredFromEdge(D d, V x, V y, V z, V ex, V ey, V ez, V along,
                             V length) {
  const auto part =
      hn::Div(hn::Neg(along), hn::Max(length, hn::Set(d, 0x1p-126f)));
  const auto s = hn::Max(hn::Zero(d), hn::Min(part, hn::Set(d, 1.0f)));
  const auto qx = hn::MulAdd(s, ex, x);
  const auto qy = hn::MulAdd(s, ey, y);
  const auto qz = hn::MulAdd(s, ez, z);
  return DotOf(qx, qy, qz, qx, qy, qz);
}

class MeshNearestFinder {
 public:
  explicit MeshNearestFinder(const detail::MeshNearest& search)
      : search_(search),
        error_(ReachOf(search.tree->cube, search.point) * 0x1p-40f),
        limit_(search.limit) {
    most_key_ = KeyAt(error_);
  }

  float most_key() const { return most_key_; }

  // The key is the squared distance of the box.
  HWY_INLINE uint64_t ReadKeys(const detail::MeshNode& node,
                               float* keys) const {
    const MeshTag d;
    uint64_t bits = 0;
    for (size_t i = 0; i < detail::kMeshLanes; i += hn::Lanes(d)) {
      auto sum = hn::Zero(d);
      for (size_t k = 0; k < 3; ++k) {
        const auto at = hn::Set(d, search_.point[k]);
        const auto below = hn::Sub(hn::Load(d, node.planes[k] + i), at);
        const auto above = hn::Sub(at, hn::Load(d, node.planes[3 + k] + i));
        const auto gap = hn::Max(hn::Max(below, above), hn::Zero(d));
        sum = hn::MulAdd(gap, gap, sum);
      }
      bits |= LaneBits(d, hn::Le(sum, hn::Set(d, most_key_))) << i;
      hn::Store(sum, d, keys + i);
    }
    return bits;
  }

  // Tests the triangle with the least key first.
  HWY_INLINE bool TakeGroup(const detail::MeshGroup& group, uint64_t bits) {
    HWY_ALIGN float keys[detail::kMeshLanes] = {};
    const float reach = ReachOf(group.cube, search_.point);
    // Nothing overflows in the keys.
    if (reach < 0x1p30f) WriteKeys(group, reach, keys);
    const float error = reach * 0x1p-18f + error_;
    while (bits != 0) {
      size_t nearest = hwy::Num0BitsBelowLS1Bit_Nonzero64(bits);
      for (uint64_t left = bits & (bits - 1); left != 0; left &= left - 1) {
        const size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
        nearest = keys[lane] < keys[nearest] ? lane : nearest;
      }
      if (keys[nearest] > KeyAt(error)) break;
      const float limit = search_.function(search_.context, group, nearest);
      if (limit < limit_) limit_ = limit;
      bits &= ~(uint64_t{1} << nearest);
    }
    most_key_ = KeyAt(error_);
    return true;
  }

 private:
  // The greatest key of what is within the limit, if keys are of distances that
  // are off by less than the error.
  float KeyAt(float error) const {
    const float most = (limit_ + error + 0x1p-60f) * (1 + 0x1p-18f);
    return most * most;
  }

  // Writes squared distances of triangles, of which those that are not exact
  // are below.
  HWY_INLINE void WriteKeys(const detail::MeshGroup& group, float reach,
                            float* keys) const {
    const MeshTag d;
    const auto tiny = hn::Set(d, 0x1p-120f);
    const auto least = hn::Set(d, 0x1p-140f);
    const auto of_height = hn::Set(d, reach * 0x1p-18f);
    const auto of_side = hn::Set(d, reach * (4 * group.cube.half) * 0x1p-16f);
    const auto px = hn::Set(d, search_.point[0]);
    const auto py = hn::Set(d, search_.point[1]);
    const auto pz = hn::Set(d, search_.point[2]);
    for (size_t i = 0; i < detail::kMeshLanes; i += hn::Lanes(d)) {
      const auto a0 = hn::Load(d, group.corners[0] + i);
      const auto a1 = hn::Load(d, group.corners[1] + i);
      const auto a2 = hn::Load(d, group.corners[2] + i);
      const auto b0 = hn::Load(d, group.corners[3] + i);
      const auto b1 = hn::Load(d, group.corners[4] + i);
      const auto b2 = hn::Load(d, group.corners[5] + i);
      const auto c0 = hn::Load(d, group.corners[6] + i);
      const auto c1 = hn::Load(d, group.corners[7] + i);
      const auto c2 = hn::Load(d, group.corners[8] + i);
      const auto ax = hn::Sub(a0, px);
      const auto ay = hn::Sub(a1, py);
      const auto az = hn::Sub(a2, pz);
      const auto bx = hn::Sub(b0, px);
      const auto by = hn::Sub(b1, py);
      const auto bz = hn::Sub(b2, pz);
      const auto ux = hn::Sub(b0, a0);
      const auto uy = hn::Sub(b1, a1);
      const auto uz = hn::Sub(b2, a2);
      const auto vx = hn::Sub(c0, a0);
      const auto vy = hn::Sub(c1, a1);
      const auto vz = hn::Sub(c2, a2);
      const auto wx = hn::Sub(c0, b0);
      const auto wy = hn::Sub(c1, b1);
      const auto wz = hn::Sub(c2, b2);
      const auto uu = DotOf(ux, uy, uz, ux, uy, uz);
      const auto vv = DotOf(vx, vy, vz, vx, vy, vz);
      const auto ww = DotOf(wx, wy, wz, wx, wy, wz);
      const auto uv = DotOf(ux, uy, uz, vx, vy, vz);
      const auto au = DotOf(ax, ay, az, ux, uy, uz);
      const auto av = DotOf(ax, ay, az, vx, vy, vz);
      const auto bw = DotOf(bx, by, bz, wx, wy, wz);
      const auto on_u = SquaredFromEdge(d, ax, ay, az, ux, uy, uz, au, uu);
      const auto on_v = SquaredFromEdge(d, ax, ay, az, vx, vy, vz, av, vv);
      const auto on_w = SquaredFromEdge(d, bx, by, bz, wx, wy, wz, bw, ww);
      const auto on_edge = hn::Min(on_u, hn::Min(on_v, on_w));
      const auto nx = hn::Sub(hn::Mul(uy, vz), hn::Mul(uz, vy));
      const auto ny = hn::Sub(hn::Mul(uz, vx), hn::Mul(ux, vz));
      const auto nz = hn::Sub(hn::Mul(ux, vy), hn::Mul(uy, vx));
      const auto nn = DotOf(nx, ny, nz, nx, ny, nz);
      const auto size = hn::Add(hn::Max(uu, hn::Max(vv, ww)), tiny);
      // The weights of c, b and a of the point below, times nn.
      const auto of_c = hn::Sub(hn::Mul(uv, au), hn::Mul(uu, av));
      const auto of_b = hn::Sub(hn::Mul(uv, av), hn::Mul(vv, au));
      const auto of_a = hn::Sub(nn, hn::Add(of_b, of_c));
      const auto is_beyond = hn::Lt(hn::Min(of_a, hn::Min(of_b, of_c)),
                                    hn::Neg(hn::MulAdd(of_side, size, least)));
      // The distance of the plane, times the square root of nn.
      const auto height =
          hn::Max(hn::Zero(d), hn::Sub(hn::Abs(DotOf(ax, ay, az, nx, ny, nz)),
                                       hn::MulAdd(of_height, size, least)));
      const auto most_nn = hn::MulAdd(hn::Mul(size, size), hn::Set(d, 0x1p-18f),
                                      hn::Add(nn, hn::Set(d, 0x1p-126f)));
      const auto on_plane = hn::Mul(hn::Div(height, most_nn), height);
      hn::Store(hn::IfThenElse(is_beyond, on_edge, hn::Min(on_edge, on_plane)),
                d, keys + i);
    }
  }

  const detail::MeshNearest& search_;
  const float error_;  // of the exact test, in the mesh
  float limit_;
  float most_key_;
};

inline void CastAtMesh(const detail::MeshCast& cast) {
  MeshCaster caster(cast);
  WalkMesh(*cast.tree, caster);
}

inline void FindNearestOfMesh(const detail::MeshNearest& search) {
  MeshNearestFinder finder(search);
  WalkMesh(*search.tree, finder);
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();

#endif  // HALFSPACE_KERNELS_BVH_MESH_INL_H_
