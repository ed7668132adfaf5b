// Internal. The calls of reject.h and reject_many.h after the types are gone:
// the boundary between the caller's translation unit and the library. Not part
// of the interface.
#ifndef HALFSPACE_DETAIL_SCAN_H_
#define HALFSPACE_DETAIL_SCAN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/span.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

struct Options;
struct SurvivorTile;

namespace detail {

class Quantizer;
struct TargetKernels;

enum class Shape : std::uint8_t { kSimplex, kAabb, kAabo };

// The way of a scan through its planes: one enumerator for each kernel.
enum Way : std::uint8_t {
  kMinima,           // the minima of every object, all at once
  kMinimaStreaming,  // the same for one query out of the caches
  kAll,              // minima and maxima of every object
  kAllStreaming,
  kByAxis,     // axis after axis, for groups of objects that have a survivor
  kBySimplex,  // the minima, then the maxima of the nonzero words
  kWays
};

// The kernels of bounds with kAxes axes whose planes are stored as T: one entry
// for each compiled target, best first. Each table is in an object file of its
// own, so that a program links those that its worlds name, and no others.
template <std::size_t kAxes, typename T>
struct HALFSPACE_API KernelsOf {
  static const TargetKernels* const kTargets;
};

#define HALFSPACE_DECLARE_KERNELS(T)      \
  extern template struct KernelsOf<2, T>; \
  extern template struct KernelsOf<3, T>; \
  extern template struct KernelsOf<4, T>; \
  extern template struct KernelsOf<5, T>
HALFSPACE_DECLARE_KERNELS(float);
HALFSPACE_DECLARE_KERNELS(double);
HALFSPACE_DECLARE_KERNELS(std::int8_t);
HALFSPACE_DECLARE_KERNELS(std::int16_t);
#undef HALFSPACE_DECLARE_KERNELS

// All minima, then all maxima; a simplex world has only minima.
using PlanePointers = std::array<const void*, kMaxPlanes>;

// Where the planes begin. Computed where their number is a constant, so that a
// valid call is checked in a few cycles.
struct AddressRange {
  std::uintptr_t lowest;
  std::uintptr_t highest;
  std::uintptr_t bits;  // of all addresses
};

// One call: a world and its queries, and what the library computes from them.
// The queries are stored one after another, each with all minima, then all
// maxima; a query of simplices has only maxima.
//
// Pointers after the planes of the shape are left uninitialised, because
// clearing them costs a tenth of a call.
struct Scan {
  PlanePointers planes;
  AddressRange addresses;
  std::size_t size;
  const TargetKernels* all_kernels;  // of each target
  Shape shape;
  std::uint8_t axes;  // minima; as many maxima, unless it is a simplex
  std::uint8_t plane_count;
  std::uint8_t first_max;  // of a query's values, of which there are as many
  std::uint8_t element_bytes;       // of a value of `planes`
  std::uint8_t record_bytes;        // of an object's values in `planes`
  std::uint8_t query_bytes;         // of a value of `queries`
  std::uint8_t query_record_bytes;  // of a query

  // If it is not null, `planes` are quantized bounds, and encode() encodes
  // queries, which are floats: `count` of them from number `first` on.
  const Quantizer* quantizer;
  void (*encode)(const Scan& scan, std::size_t first, std::size_t count,
                 void* quantized);

  const void* queries;
  std::size_t query_count;

  // Survivors of the quantized bounds are refined by these floats.
  bool is_refined;
  FloatColumns floats;

  // Set by the library.
  Way way;
  bool is_streaming;
  bool is_aligned;  // the range begins at a multiple of 64 bytes in each plane
  const TargetKernels* kernels;  // of the target that runs
  const char* call;              // its name, for messages
  std::size_t begin;             // the range of objects
  std::size_t end;
};

template <int kDims, typename T>
constexpr Shape ShapeOf(const SimplexView<kDims, T>&) {
  return Shape::kSimplex;
}
template <int kDims, typename T>
constexpr Shape ShapeOf(const AabbView<kDims, T>&) {
  return Shape::kAabb;
}
template <int kDims, typename T>
constexpr Shape ShapeOf(const AaboView<kDims, T>&) {
  return Shape::kAabo;
}

template <std::size_t kPlane, typename View>
const void* PlaneOf(const View& view) {
  if constexpr (kPlane < View::Bound::kAxes) {
    return view.min[kPlane];
  } else {
    return view.max[kPlane - View::Bound::kAxes];
  }
}

// plane_at(number) is a plane. Each is read once, by itself: a copy in vectors
// waits for the stores that made the view, which took a call 5 ns more.
template <std::size_t... kPlane, typename PlaneAt>
void AddPlanes(std::index_sequence<kPlane...>, const PlaneAt& plane_at,
               Scan& scan) {
  AddressRange range{~std::uintptr_t{0}, 0, 0};
  const auto add = [&](std::size_t p, const void* plane) {
    scan.planes[p] = plane;
    const auto address = reinterpret_cast<std::uintptr_t>(plane);
    range.lowest = address < range.lowest ? address : range.lowest;
    range.highest = address > range.highest ? address : range.highest;
    range.bits |= address;
  };
  (add(kPlane, plane_at(std::integral_constant<std::size_t, kPlane>())), ...);
  scan.addresses = range;
}

// A scan of a View's bounds without its planes.
template <typename View>
Scan ScanOfQueries(Span<const typename View::Query> queries) {
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  using Scalar = typename Query::Scalar;
  static_assert(std::is_standard_layout_v<Query> &&
                    sizeof(Query) == kPlaneCount<Query> * sizeof(Scalar),
                "a query is read as a list of its values");
  Scan scan;
  scan.shape = ShapeOf(View());
  scan.axes = Bound::kAxes;
  scan.plane_count = kPlaneCount<Bound>;
  scan.first_max = HasMin<Query> ? Bound::kAxes : 0;
  scan.query_bytes = sizeof(Scalar);
  scan.query_record_bytes = sizeof(Query);
  scan.queries = queries.data();
  scan.query_count = queries.size();
  scan.quantizer = nullptr;
  scan.is_refined = false;
  return scan;
}

template <typename View>
Scan MakeScan(const View& view, Span<const typename View::Query> queries) {
  using Bound = typename View::Bound;
  Scan scan = ScanOfQueries<View>(queries);
  scan.all_kernels = KernelsOf<Bound::kAxes, typename Bound::Scalar>::kTargets;
  scan.element_bytes = sizeof(typename Bound::Scalar);
  scan.record_bytes = sizeof(Bound);
  scan.size = view.size;
  AddPlanes(
      std::make_index_sequence<kPlaneCount<Bound>>(),
      [&view](auto plane) { return PlaneOf<plane()>(view); }, scan);
  return scan;
}

// The queries must outlive the result. MakeScan of quantized views is found by
// argument-dependent lookup.
template <typename AnyWorld>
Scan ScanOf(const AnyWorld& world,
            Span<const typename AnyWorld::Query> queries) {
  return MakeScan(world.view(), queries);
}
template <typename AnyWorld>
Scan ScanOfOne(const AnyWorld& world, const typename AnyWorld::Query& query) {
  return MakeScan(world.view(),
                  Span<const typename AnyWorld::Query>(&query, 1));
}

// What AnySurvivor returns if there is none.
inline constexpr std::size_t kNoSurvivor = ~std::size_t{0};

// One query.
HALFSPACE_API void RejectMask(Scan&& scan, Span<std::uint64_t> mask,
                              const Options& options);
HALFSPACE_API void SurvivorMask(Scan&& scan, Span<std::uint64_t> mask,
                                const Options& options);
HALFSPACE_API std::size_t Survivors(Scan&& scan, Span<std::uint32_t> indices,
                                    const Options& options);
HALFSPACE_API std::size_t CountSurvivors(Scan&& scan, const Options& options);
HALFSPACE_API std::size_t AnySurvivor(Scan&& scan, const Options& options);

// Many queries.
HALFSPACE_API void RejectMasks(Scan&& scan, Span<std::uint64_t> rows,
                               const Options& options);
HALFSPACE_API void SurvivorMasks(Scan&& scan, Span<std::uint64_t> rows,
                                 const Options& options);
HALFSPACE_API std::size_t SurvivorPairs(Scan&& scan,
                                        Span<std::uint32_t> query_indices,
                                        Span<std::uint32_t> object_indices,
                                        const Options& options);
HALFSPACE_API void SurvivorCounts(Scan&& scan, Span<std::size_t> counts,
                                  const Options& options);

// Returns whether to go on.
using TileFunction = bool (*)(void* context, const SurvivorTile& tile);
HALFSPACE_API void ForEachTile(Scan&& scan, TileFunction function,
                               void* context, const Options& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SCAN_H_
