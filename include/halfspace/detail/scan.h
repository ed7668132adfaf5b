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
#include "halfspace/target.h"
#include "halfspace/visit.h"
#include "halfspace/world.h"

namespace halfspace {

struct Options;

namespace detail {

class Quantizer;
struct TargetKernels;

// How a scan goes through its planes. Each has its own kernel.
enum ScanKernel : std::uint8_t {
  kMinima,           // the minima of every object, all at once
  kMinimaStreaming,  // the same for one query out of the caches
  kAll,              // minima and maxima of every object
  kAllStreaming,
  kByAxis,     // axis after axis, for groups of objects that have a survivor
  kByHalf,     // the same, after half of the axes at once
  kBySimplex,  // the minima, then the maxima of the nonzero words
  kAdaptive,   // chooses among those with maxima while it runs
  kScanKernels
};

// The kernels of bounds with kAxes axes whose planes are stored as T: one entry
// for each compiled target, best first. Each table is in an object file of its
// own, so that a program links those that its worlds name, and no others.
template <std::size_t kAxes, typename T>
struct HALFSPACE_API ScanKernelsOf {
  static const TargetKernels* const kTargets;
};

#define HALFSPACE_DECLARE_KERNELS(T)          \
  extern template struct ScanKernelsOf<2, T>; \
  extern template struct ScanKernelsOf<3, T>; \
  extern template struct ScanKernelsOf<4, T>
HALFSPACE_DECLARE_KERNELS(float);
HALFSPACE_DECLARE_KERNELS(double);  // of boxes
HALFSPACE_DECLARE_KERNELS(std::int8_t);
HALFSPACE_DECLARE_KERNELS(std::int16_t);
extern template struct ScanKernelsOf<5, float>;
extern template struct ScanKernelsOf<5, std::int8_t>;
extern template struct ScanKernelsOf<5, std::int16_t>;
#undef HALFSPACE_DECLARE_KERNELS

struct Scan;

// A type of world, and how its queries are stored: one after another, each with
// all minima, then all maxima. A query of simplices has only maxima.
struct ScanType : PlaneLayout {
  const TargetKernels* const* all_kernels;  // of each target
  // If it is not null, planes are quantized bounds, and encode() encodes
  // queries, which are floats: `count` of them from number `first` on.
  void (*encode)(const Scan& scan, std::size_t first, std::size_t count,
                 void* quantized);
  bool is_refined;                  // by floats
  ScanKernel flat;                  // through all planes at once
  std::uint8_t element_bytes;       // of a value of a plane
  std::uint8_t record_bytes;        // of an object's values in the planes
  std::uint8_t query_bytes;         // of a value of a query
  std::uint8_t query_record_bytes;  // of a query
};

// Where the planes begin. Computed where their number is a constant, so that a
// valid call is checked in a few cycles.
struct AddressRange {
  std::uintptr_t lowest;
  std::uintptr_t highest;
  std::uintptr_t bits;  // of all addresses
};

// One call: a world and its queries, and what the library computes from them.
// Fields that a type of world does not need are left uninitialised.
struct Scan {
  const ScanType* type;
  const void* planes;  // the pointers of a view: all minima, then all maxima
  AddressRange addresses;
  std::size_t size;
  const void* queries;
  std::size_t query_count;

  const Quantizer* quantizer;  // of quantized bounds

  // Set by the library.
  ScanKernel kernel;
  bool is_streaming;
  bool is_in_memory;  // the planes are larger than the caches
  bool is_wide;       // with vectors of 512 bits, if the target has them
  const TargetKernels* kernels;  // of the target that runs
  const char* call;              // its name, for messages
  std::size_t begin;             // the range of objects
  std::size_t end;

  Columns floats;  // that refine quantized bounds

  template <typename T>
  const T* Plane(std::size_t p) const {
    return static_cast<const T* const*>(planes)[p];
  }
};

template <typename View>
auto PlaneList(const View& view) {
  if constexpr (HasMin<View>) {
    static_assert(
        std::is_standard_layout_v<View> &&
            offsetof(View, size) ==
                kPlaneCount<typename View::Bound> * sizeof(view.min[0]),
        "the planes of a view are read as one list");
    return view.min.data();
  } else {
    return view.planes.data();
  }
}

template <typename Stored>
void EncodeQueries(const Scan& scan, std::size_t first, std::size_t count,
                   void* quantized);

template <typename View, typename = void>
inline constexpr bool kIsRefined = false;
template <typename View>
inline constexpr bool kIsRefined<View, std::void_t<decltype(View::floats)>> =
    true;

template <typename View, typename T>
constexpr ScanType MakeScanType() {
  using Bound = typename View::Bound;
  using Query = typename View::Query;
  using Scalar = typename Query::Scalar;
  static_assert(std::is_standard_layout_v<Query> &&
                    sizeof(Query) == kPlaneCount<Query> * sizeof(Scalar),
                "a query is read as a list of its values");
  ScanType type{};
  static_cast<PlaneLayout&>(type) = kLayoutOf<Bound>;
  type.all_kernels = &ScanKernelsOf<Bound::kAxes, T>::kTargets;
  if constexpr (std::is_integral_v<T>) type.encode = &EncodeQueries<T>;
  type.is_refined = kIsRefined<View>;
  type.flat = HasMax<Bound> ? kAll : kMinima;
  type.element_bytes = sizeof(T);
  type.record_bytes = kPlaneCount<Bound> * sizeof(T);
  type.query_bytes = sizeof(Scalar);
  type.query_record_bytes = sizeof(Query);
  return type;
}

// Initialized by the compiler, except in a program that uses a DLL: there the
// address of the kernels is no constant.
template <typename View, typename T>
const ScanType* ScanTypeOf() {
  static const ScanType type = MakeScanType<View, T>();
  return &type;
}

// Each pointer is read once, by itself: a copy in vectors waits for the stores
// that made the view, which took a call 5 ns more.
template <typename T, std::size_t... kPlane>
AddressRange AddressesOf(const T* const* planes,
                         std::index_sequence<kPlane...>) {
  AddressRange range{~std::uintptr_t{0}, 0, 0};
  const auto add = [&range](const T* plane) {
    const auto address = reinterpret_cast<std::uintptr_t>(plane);
    range.lowest = address < range.lowest ? address : range.lowest;
    range.highest = address > range.highest ? address : range.highest;
    range.bits |= address;
  };
  (add(planes[kPlane]), ...);
  return range;
}

// View and queries must outlive the result.
template <typename View>
Scan ScanOf(const View& view, const typename View::Query* queries,
            std::size_t query_count) {
  const auto* const planes = PlaneList(view);
  using T = std::remove_const_t<
      std::remove_pointer_t<std::remove_reference_t<decltype(planes[0])>>>;
  Scan scan;
  scan.type = ScanTypeOf<View, std::remove_const_t<T>>();
  scan.planes = planes;
  scan.addresses = AddressesOf(
      planes, std::make_index_sequence<kPlaneCount<typename View::Bound>>());
  scan.size = view.size;
  scan.queries = queries;
  scan.query_count = query_count;
  if constexpr (std::is_integral_v<T>) scan.quantizer = view.quantizer;
  if constexpr (kIsRefined<View>) scan.floats = ColumnsOf(view.floats);
  return scan;
}

// What a call asks a world, by the type of the query. reject_shapes.h adds
// half-spaces.
template <typename View, typename Query, typename = void>
struct Asked {
  static_assert(sizeof(Query) == 0,
                "a flat world takes queries of its own type, World::Query, and "
                "if its planes are floats, also half-spaces: include "
                "reject_shapes.h. Bound other shapes first (fit.h)");
  static Scan Of(const View& view, const Query& query);
};
template <typename View, typename Query>
struct Asked<View, Query,
             std::enable_if_t<std::is_convertible_v<
                 const Query&, const typename View::Query&>>> {
  static Scan Of(const View& view, const typename View::Query& query) {
    return ScanOf(view, &query, 1);
  }
};

// A type only if the world has a view.
template <typename AnyWorld, typename Query>
using AskedOf =
    Asked<std::decay_t<decltype(std::declval<const AnyWorld&>().view())>,
          Query>;

// What AnySurvivor returns if there is none.
inline constexpr std::size_t kNoSurvivor = ~std::size_t{0};

// One query.
HALFSPACE_API void RejectMask(Scan&& scan, Span<std::uint64_t> mask,
                              const Options& options);
HALFSPACE_API void SurvivorMask(Scan&& scan, Span<std::uint64_t> mask,
                                const Options& options);
HALFSPACE_API std::size_t Survivors(Scan&& scan, Span<std::uint32_t> indices,
                                    const Options& options, std::size_t skip);
HALFSPACE_API std::size_t CountSurvivors(Scan&& scan, const Options& options);
HALFSPACE_API std::size_t AnySurvivor(Scan&& scan, const Options& options);
using SomeFunction = bool (*)(void* context, Span<const std::uint32_t> indices);
HALFSPACE_API void ForEachSurvivor(Scan&& scan, SomeFunction function,
                                   void* context, const Options& options);

// Shapes (reject_shapes.h), declared here for the calls of reject.h.
//
// A scan without queries, and the region in front of `count` half-spaces, each
// a normal and an offset. For spheres also the points within `radius` of a box,
// if `low` is not null.
struct ShapeScan {
  Scan scan;
  const float* half_spaces;
  std::size_t count;
  const float* low = nullptr;
  const float* high = nullptr;
  float radius = 0;
};

// Calls run(context, scan) with the scan of a shape, after its checks.
HALFSPACE_API void RunShape(const ShapeScan& shape, const char* call,
                            void (*run)(void* context, Scan&& scan),
                            void* context);

// Calls function with the scan, or with the scan that RunShape() makes of the
// shape, and returns its result.
template <typename Function>
auto Ask(Scan&& scan, const char*, const Function& function) {
  return function(std::move(scan));
}
template <typename Function>
auto Ask(const ShapeScan& shape, const char* call, const Function& function) {
  using Result = decltype(function(std::declval<Scan>()));
  if constexpr (std::is_void_v<Result>) {
    const auto run = [](void* context, Scan&& scan) {
      (*static_cast<const Function*>(context))(std::move(scan));
    };
    RunShape(shape, call, run, const_cast<Function*>(&function));
  } else {
    Result result{};
    Ask(shape, call, [&](Scan&& scan) { result = function(std::move(scan)); });
    return result;
  }
}

HALFSPACE_API void ClassifyMasks(const ShapeScan& shape,
                                 Span<std::uint64_t> survivors,
                                 Span<std::uint64_t> inside,
                                 const Options& options);

// Many queries.
HALFSPACE_API void SurvivorMasks(Scan&& scan, Span<std::uint64_t> rows,
                                 const Options& options, std::size_t row_words);
HALFSPACE_API std::size_t SurvivorPairs(Scan&& scan,
                                        Span<std::uint32_t> query_indices,
                                        Span<std::uint32_t> object_indices,
                                        const Options& options,
                                        std::size_t skip);
HALFSPACE_API void SurvivorCounts(Scan&& scan, Span<std::size_t> counts,
                                  const Options& options);

}  // namespace detail
}  // namespace halfspace

#endif  // HALFSPACE_DETAIL_SCAN_H_
