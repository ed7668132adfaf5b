// Bounds of clouds on three kinds of axes: part of target_loops.cc.

HWY_BEFORE_NAMESPACE();
namespace halfspace {
namespace HWY_NAMESPACE {

// The projections of a vector of points. That on the last axis is negated,
// which saves an operation.
struct StandardAxes {
  static constexpr size_t kCopied = 3;
  static constexpr float kRoundings = 2;

  template <size_t kAxis, class D, class V>
  static HWY_INLINE V Project(D /*d*/, V x, V y, V z) {
    if constexpr (kAxis == 0) return x;
    if constexpr (kAxis == 1) return y;
    if constexpr (kAxis == 2) return z;
    if constexpr (kAxis == 3) return hn::Add(x, hn::Add(y, z));
  }
};

struct RegularSigns {
  static constexpr size_t kCopied = 0;
  static constexpr float kRoundings = 2;

  template <size_t kAxis, class D, class V>
  static HWY_INLINE V Project(D /*d*/, V x, V y, V z) {
    if constexpr (kAxis == 0) return hn::Add(x, hn::Add(y, z));
    if constexpr (kAxis == 1) return hn::Sub(x, hn::Add(y, z));
    if constexpr (kAxis == 2) return hn::Sub(hn::Sub(y, z), x);
    if constexpr (kAxis == 3) return hn::Add(x, hn::Sub(y, z));
  }
};

struct RegularAxes {
  static constexpr size_t kCopied = 0;
  static constexpr float kRoundings = 3;

  template <size_t kAxis, class D, class V>
  static HWY_INLINE V Project(D d, V x, V y, V z) {
    const V c = hn::Set(d, bench::kRootOfThird);
    return RegularSigns::Project<kAxis>(d, hn::Mul(x, c), hn::Mul(y, c),
                                        hn::Mul(z, c));
  }
};

HWY_INLINE float Larger(float a, float b) { return a < b ? b : a; }
HWY_INLINE float Magnitude(float a) { return a < 0 ? -a : a; }

// Least and greatest projections of the points of one cloud, as computed.
struct Projections {
  float min[4];
  float max[4];
};

template <class D, class V>
HWY_INLINE void Reduce(D d, V min, V max, size_t axis, Projections& to) {
  to.min[axis] = hn::GetLane(hn::MinOfLanes(d, min));
  to.max[axis] = hn::GetLane(hn::MaxOfLanes(d, max));
}

template <class Of, class D>
HWY_INLINE void ProjectCloud(D d, const float* x, const float* y,
                             const float* z, size_t points, Projections& to) {
  const size_t lanes = hn::Lanes(d);
  // The last vector overlaps the one before it.
  const size_t last = points - lanes;
  auto px = hn::LoadU(d, x + last);
  auto py = hn::LoadU(d, y + last);
  auto pz = hn::LoadU(d, z + last);
  auto min0 = Of::template Project<0>(d, px, py, pz);
  auto min1 = Of::template Project<1>(d, px, py, pz);
  auto min2 = Of::template Project<2>(d, px, py, pz);
  auto min3 = Of::template Project<3>(d, px, py, pz);
  auto max0 = min0;
  auto max1 = min1;
  auto max2 = min2;
  auto max3 = min3;
  for (size_t i = 0; i < last; i += lanes) {
    px = hn::LoadU(d, x + i);
    py = hn::LoadU(d, y + i);
    pz = hn::LoadU(d, z + i);
    const auto p0 = Of::template Project<0>(d, px, py, pz);
    const auto p1 = Of::template Project<1>(d, px, py, pz);
    const auto p2 = Of::template Project<2>(d, px, py, pz);
    const auto p3 = Of::template Project<3>(d, px, py, pz);
    min0 = hn::Min(min0, p0);
    min1 = hn::Min(min1, p1);
    min2 = hn::Min(min2, p2);
    min3 = hn::Min(min3, p3);
    max0 = hn::Max(max0, p0);
    max1 = hn::Max(max1, p1);
    max2 = hn::Max(max2, p2);
    max3 = hn::Max(max3, p3);
  }
  Reduce(d, min0, max0, 0, to);
  Reduce(d, min1, max1, 1, to);
  Reduce(d, min2, max2, 2, to);
  Reduce(d, min3, max3, 3, to);
}

// The most that the coordinates' products may sum to in magnitude.
template <class Of>
HWY_INLINE float LargestSum(const Projections& of) {
  float largest = 0;
  for (size_t k = 0; k < 4; ++k) {
    const float magnitude = Larger(Magnitude(of.min[k]), Magnitude(of.max[k]));
    if constexpr (Of::kCopied == 0) {
      largest = Larger(largest, magnitude);
    } else {
      if (k < Of::kCopied) largest += magnitude;
    }
  }
  return largest;
}

template <class Of>
void BoundAll(const float* const* coordinates, size_t clouds, size_t points,
              float* const* min, float* const* max) {
  constexpr float kUlp = 0x1p-24f;
  // Of products that underflow.
  constexpr float kLeast = 0x1p-140f;
  const hn::CappedTag<float, 16> d;
  for (size_t c = 0; c < clouds; ++c) {
    const size_t first = c * points;
    Projections of;
    ProjectCloud<Of>(d, coordinates[0] + first, coordinates[1] + first,
                     coordinates[2] + first, points, of);
    const float pad =
        LargestSum<Of>(of) * ((Of::kRoundings + 2) * kUlp) + kLeast;
    for (size_t k = 0; k < 3; ++k) {
      const float moved = k < Of::kCopied ? 0 : pad;
      min[k][c] = of.min[k] - moved;
      max[k][c] = of.max[k] + moved;
    }
    min[3][c] = -of.max[3] - pad;
    max[3][c] = -of.min[3] + pad;
  }
}

void BoundCloudsOn(bench::Axes axes, const float* const* coordinates,
                   size_t clouds, size_t points, float* const* min,
                   float* const* max) {
  switch (axes) {
    case bench::Axes::kStandard:
      return BoundAll<StandardAxes>(coordinates, clouds, points, min, max);
    case bench::Axes::kRegular:
      return BoundAll<RegularAxes>(coordinates, clouds, points, min, max);
    case bench::Axes::kRegularSigns:
      return BoundAll<RegularSigns>(coordinates, clouds, points, min, max);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace halfspace
HWY_AFTER_NAMESPACE();
