// Internal. The calls of reject.h and reject_many.h after the types are gone:
// the boundary between the caller's translation unit and the library. Not part
// of the interface.
#ifndef HALFSPACE_DETAIL_SCAN_H_
#define HALFSPACE_DETAIL_SCAN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "halfspace/detail/plane_arrays.h"
#include "halfspace/export.h"
#include "halfspace/targets.h"
#include "halfspace/world.h"

namespace halfspace {

struct Options;
struct SurvivorCount;
struct SurvivorFlag;
struct SurvivorTile;

namespace detail {

class CodeBook;

enum class Shape : std::uint8_t { kSimplex, kAabb, kAabo };
enum class Element : std::uint8_t { kFloat32, kFloat64, kCode8, kCode16 };

template <typename T>
inline constexpr Element kElementOf = Element::kFloat32;
template <>
inline constexpr Element kElementOf<double> = Element::kFloat64;
template <>
inline constexpr Element kElementOf<std::int8_t> = Element::kCode8;
template <>
inline constexpr Element kElementOf<std::int16_t> = Element::kCode16;

// All minima, then all maxima; a simplex world has only minima.
using PlanePointers = std::array<const void*, kMaxPlanes>;

// Where the planes begin, known while their number is a constant: a call that
// is right is then checked in a few cycles.
struct AddressRange {
  std::uintptr_t lowest;
  std::uintptr_t highest;
  std::uintptr_t bits;  // of all addresses
};

// One world and its queries. The queries lie one after another, each with all
// minima, then all maxima; that of a simplex has only maxima.
//
// Pointers are left uninitialised past the planes of the shape: clearing them
// costs a tenth of a call.
struct Scan {
  Shape shape;
  Element element;  // of `planes`
  std::uint8_t dims;
  std::uint8_t axes;  // minima; as many maxima, unless it is a simplex
  std::uint8_t plane_count;
  std::uint8_t element_bytes;  // of a value of `planes`
  std::uint8_t query_bytes;    // of a value of `queries`
  std::uint8_t record_bytes;   // of an object's values in `planes`
  std::size_t size;
  PlanePointers planes;
  AddressRange addresses;

  const void* queries;
  std::size_t query_count;

  // If it is not null, `planes` are codes, and queries, which are floats, are
  // coded with it.
  const CodeBook* book;

  // What survives the codes is tested with these floats too.
  bool is_confirmed;
  FloatColumns confirming;
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

template <typename View, typename Pointers>
void ListPlanes(const View& view, Pointers& planes) {
  std::size_t p = 0;
  for (const auto* plane : view.min) planes[p++] = plane;
  if constexpr (HasMax<View>) {
    for (const auto* plane : view.max) planes[p++] = plane;
  }
}

template <std::size_t kPlanes>
AddressRange AddressesOf(const PlanePointers& planes) {
  AddressRange range{~std::uintptr_t{0}, 0, 0};
  for (std::size_t p = 0; p < kPlanes; ++p) {
    const auto address = reinterpret_cast<std::uintptr_t>(planes[p]);
    range.lowest = address < range.lowest ? address : range.lowest;
    range.highest = address > range.highest ? address : range.highest;
    range.bits |= address;
  }
  return range;
}

template <typename View>
Scan MakeScan(const View& view, std::span<const typename View::Query> queries) {
  using Query = typename View::Query;
  using Scalar = typename Query::Scalar;
  static_assert(std::is_standard_layout_v<Query> &&
                    sizeof(Query) == kPlaneCount<Query> * sizeof(Scalar),
                "a query is read as a list of its values");
  Scan scan;
  scan.shape = ShapeOf(view);
  scan.element = kElementOf<Scalar>;
  scan.dims = View::Bound::kDimensions;
  scan.axes = View::Bound::kAxes;
  scan.plane_count = kPlaneCount<typename View::Bound>;
  scan.element_bytes = sizeof(Scalar);
  scan.query_bytes = sizeof(Scalar);
  scan.record_bytes = scan.plane_count * sizeof(Scalar);
  scan.size = view.size;
  ListPlanes(view, scan.planes);
  scan.addresses = AddressesOf<kPlaneCount<typename View::Bound>>(scan.planes);
  scan.queries = queries.data();
  scan.query_count = queries.size();
  scan.book = nullptr;
  scan.is_confirmed = false;
  return scan;
}

// The queries must outlive the result. MakeScan of coded views is found by
// argument-dependent lookup.
template <typename View>
Scan ScanOf(const View& view, std::span<const typename View::Query> queries) {
  return MakeScan(view, queries);
}
template <typename View>
Scan ScanOfOne(const View& view, const typename View::Query& query) {
  return MakeScan(view, std::span<const typename View::Query>(&query, 1));
}

// One query.
HALFSPACE_API Target RejectMask(const Scan& scan, std::span<std::uint64_t> mask,
                                const Options& options);
HALFSPACE_API Target SurvivorMask(const Scan& scan,
                                  std::span<std::uint64_t> mask,
                                  const Options& options);
HALFSPACE_API SurvivorCount Survivors(const Scan& scan,
                                      std::span<std::uint32_t> indices,
                                      const Options& options);
HALFSPACE_API SurvivorCount CountSurvivors(const Scan& scan,
                                           const Options& options);
HALFSPACE_API SurvivorFlag AnySurvivor(const Scan& scan,
                                       const Options& options);

// Many queries.
HALFSPACE_API Target RejectMasks(const Scan& scan,
                                 std::span<std::uint64_t> rows,
                                 const Options& options);
HALFSPACE_API Target SurvivorMasks(const Scan& scan,
                                   std::span<std::uint64_t> rows,
                                   const Options& options);
HALFSPACE_API SurvivorCount
SurvivorPairs(const Scan& scan, std::span<std::uint32_t> query_indices,
              std::span<std::uint32_t> object_indices, const Options& options);
HALFSPACE_API Target SurvivorCounts(const Scan& scan,
                                    std::span<std::size_t> counts,
                                    const Options& options);

using TileFunction = void (*)(void* context, const SurvivorTile& tile);
HALFSPACE_API Target ForEachTile(const Scan& scan, TileFunction function,
                                 void* context, const Options& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SCAN_H_
