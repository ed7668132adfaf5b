// The shapes as data: which stored plane is compared with which value of the
// query, in which order, and where an early-out may stop.
//
// Plane indices follow detail::Scan: all minima (X, Y, ..., D), then all
// maxima. The kernels know nothing else about a shape.
#ifndef HALFSPACE_KERNELS_PLANES_H_
#define HALFSPACE_KERNELS_PLANES_H_

#include <array>
#include <cstddef>

namespace halfspace::kernels {

// One half-space test.
struct Plane {
  std::size_t object;  // index of the stored plane
  std::size_t query;   // index of the query's value
  bool is_min;         // rejects if object > query; else if object < query
};

// A schedule of a shape: its planes in evaluation order, and the ends of its
// stages. After each stage but the last, a group of objects that are all
// rejected is done.
template <std::size_t kPlaneCount, std::size_t kStageCount>
struct Order {
  std::array<Plane, kPlaneCount> planes;
  std::array<std::size_t, kStageCount> stage_ends;
};

namespace detail {

// The interval tests of axis `k`, for a shape that stores `axes` minima and
// as many maxima on both sides of the test.
constexpr Plane MinPlane(std::size_t k, std::size_t axes) {
  return {k, axes + k, true};
}
constexpr Plane MaxPlane(std::size_t k, std::size_t axes) {
  return {axes + k, k, false};
}

template <std::size_t kAxes>
constexpr auto IntervalPlanes() {
  std::array<Plane, 2 * kAxes> planes{};
  for (std::size_t k = 0; k < kAxes; ++k) {
    planes[2 * k] = MinPlane(k, kAxes);
    planes[2 * k + 1] = MaxPlane(k, kAxes);
  }
  return planes;
}

template <std::size_t kStages>
constexpr auto StagesOf(std::size_t planes_per_stage) {
  std::array<std::size_t, kStages> ends{};
  for (std::size_t s = 0; s < kStages; ++s)
    ends[s] = (s + 1) * planes_per_stage;
  return ends;
}

// A simplex: object minima against the query's maxima.
template <std::size_t kAxes>
constexpr auto SimplexPlanes() {
  std::array<Plane, kAxes> planes{};
  for (std::size_t k = 0; k < kAxes; ++k) planes[k] = {k, k, true};
  return planes;
}

// The up simplex of an octahedron.
template <std::size_t kAxes>
constexpr auto UpSimplexPlanes() {
  std::array<Plane, kAxes> planes{};
  for (std::size_t k = 0; k < kAxes; ++k) planes[k] = MinPlane(k, kAxes);
  return planes;
}

// Both simplices of an octahedron, the up simplex first.
template <std::size_t kAxes>
constexpr auto OpposingSimplexPlanes() {
  std::array<Plane, 2 * kAxes> planes{};
  for (std::size_t k = 0; k < kAxes; ++k) {
    planes[k] = MinPlane(k, kAxes);
    planes[kAxes + k] = MaxPlane(k, kAxes);
  }
  return planes;
}

}  // namespace detail

template <int kDims>
struct SimplexFlat {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr Order<kAxes, 1> kOrder = {detail::SimplexPlanes<kAxes>(),
                                             detail::StagesOf<1>(kAxes)};
};

template <int kDims>
struct SimplexByAxis {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr std::size_t kGroup = 16;
  static constexpr Order<kAxes, kAxes> kOrder = {detail::SimplexPlanes<kAxes>(),
                                                 detail::StagesOf<kAxes>(1)};
};

template <int kDims>
struct AabbFlat {
  static constexpr std::size_t kAxes = kDims;
  static constexpr Order<2 * kAxes, 1> kOrder = {
      detail::IntervalPlanes<kAxes>(), detail::StagesOf<1>(2 * kAxes)};
};

template <int kDims>
struct AabbByAxis {
  static constexpr std::size_t kAxes = kDims;
  static constexpr std::size_t kGroup = 16;
  static constexpr Order<2 * kAxes, kAxes> kOrder = {
      detail::IntervalPlanes<kAxes>(), detail::StagesOf<kAxes>(2)};
};

template <int kDims>
struct AaboFlat {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr Order<2 * kAxes, 1> kOrder = {
      detail::OpposingSimplexPlanes<kAxes>(), detail::StagesOf<1>(2 * kAxes)};
};

template <int kDims>
struct AaboByAxis {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr std::size_t kGroup = 16;
  static constexpr Order<2 * kAxes, kAxes> kOrder = {
      detail::IntervalPlanes<kAxes>(), detail::StagesOf<kAxes>(2)};
};

template <int kDims>
struct AaboBySimplex {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr std::size_t kGroup = 64;
  static constexpr Order<2 * kAxes, 2> kOrder = {
      detail::OpposingSimplexPlanes<kAxes>(), detail::StagesOf<2>(kAxes)};
};

// The first stage of AaboBySimplex alone: for codes, whose candidates are
// tested with floats anyway.
template <int kDims>
struct AaboUp {
  static constexpr std::size_t kAxes = kDims + 1;
  static constexpr Order<kAxes, 1> kOrder = {detail::UpSimplexPlanes<kAxes>(),
                                             detail::StagesOf<1>(kAxes)};
};

// From one query to the next: as many values as planes, unless some are left
// out.
template <class Shape>
inline constexpr std::size_t kQueryValues = Shape::kOrder.planes.size();
template <int kDims>
inline constexpr std::size_t kQueryValues<AaboUp<kDims>> =
    2 * AaboUp<kDims>::kAxes;

// Which value of the query the kPlane-th test of a shape compares with. A
// constant: no std::array function may be called from per-target code.
template <class Shape, std::size_t kPlane>
inline constexpr std::size_t kQueryIndex = Shape::kOrder.planes[kPlane].query;

// Which stored plane it tests.
template <class Shape, std::size_t kPlane>
inline constexpr std::size_t kObjectIndex = Shape::kOrder.planes[kPlane].object;

}  // namespace halfspace::kernels

#endif  // HALFSPACE_KERNELS_PLANES_H_
