// The C API against the C++ library: the same calls on the same random input
// give the same values, in every form that columns can have. What the values
// should be, the tests of the C++ library know.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "halfspace/halfspace.h"

extern "C" {
#include "check.h"
}

namespace halfspace {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kAll = 0xFFFFFFFF;
constexpr std::size_t kObjects = 400;
// More than are converted at a time.
constexpr std::size_t kQueries = 300;

using Ids = std::vector<std::uint32_t>;

// How records are stored: one after another, with gaps, each column in memory
// of its own, and as doubles that are no floats.
enum Form { kRows, kWide, kApart, kDoubles };
constexpr std::array kFloats = {kRows, kWide, kApart};
constexpr std::array kForms = {kRows, kWide, kApart, kDoubles};

float Round(double value, float to) {
  const auto nearest = static_cast<float>(value);
  const bool is_outward = to < 0 ? nearest <= value : nearest >= value;
  return is_outward || std::isnan(value) ? nearest
                                         : std::nextafter(nearest, to);
}

// Records whose first values, `minima`, become floats that are not greater, and
// the others floats that are not less.
class Records {
 public:
  Records(std::size_t values, std::size_t minima, std::vector<double> doubles)
      : values_(values), doubles_(std::move(doubles)) {
    wide_.resize(count() * (values + 1), 99);
    apart_.resize(doubles_.size());
    for (std::size_t i = 0; i < doubles_.size(); ++i) {
      const std::size_t record = i / values;
      const std::size_t v = i % values;
      const float value =
          Round(doubles_[i], v < minima ? -kInfinity : kInfinity);
      rows_.push_back(value);
      wide_[record * (values + 1) + v] = value;
      apart_[(values - 1 - v) * count() + record] = value;
    }
  }

  std::size_t count() const { return doubles_.size() / values_; }
  const float* row(std::size_t i) const { return rows_.data() + i * values_; }
  const double* doubles(std::size_t i) const {
    return doubles_.data() + i * values_;
  }

  hs_columns In(Form form) const {
    if (form == kRows) return hs_float_rows(rows_.data(), count(), values_);
    if (form == kDoubles)
      return hs_double_rows(doubles_.data(), count(), values_);
    hs_columns columns = hs_float_rows(wide_.data(), count(), values_ + 1);
    if (form == kWide) return columns;
    columns.stride = 1;
    for (std::size_t v = 0; v < values_; ++v) {
      columns.column[v] = apart_.data() + (values_ - 1 - v) * count();
    }
    return columns;
  }

 private:
  std::size_t values_;
  std::vector<double> doubles_;
  std::vector<float> rows_;
  std::vector<float> wide_;
  std::vector<float> apart_;
};

std::uint32_t Below(std::size_t end, std::uint32_t* seed) {
  return static_cast<std::uint32_t>(random_float(seed) *
                                    static_cast<float>(end));
}
// From -0.05 to 1.05. Half of them are at few places, and half an ulp apart: it
// tells how doubles are rounded.
double Number(std::uint32_t* seed) {
  if (Below(2, seed) == 0) return random_float(seed) * 1.1 - 0.05;
  return 0.5 + Below(4, seed) / 8.0 + Below(4, seed) * 0x1p-25;
}

// With a `radius`, the last of each record is not negative.
Records RandomNumbers(std::size_t count, std::size_t values, std::uint32_t seed,
                      double radius = 0) {
  std::vector<double> numbers(count * values);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = Number(&seed);
    if (radius != 0 && i % values == values - 1) {
      numbers[i] = radius * std::abs(numbers[i]);
    }
  }
  return Records(values, values, std::move(numbers));
}

// Boxes in `dims` dimensions, or octahedra, some of which may be special.
Records RandomBounds(std::size_t count, std::size_t dims, std::size_t axes,
                     double side, std::uint32_t seed, bool has_special = true) {
  std::vector<double> all;
  for (std::size_t i = 0; i < count; ++i) {
    std::vector<double> min(axes);
    std::vector<double> max(axes);
    for (std::size_t k = 0; k < dims; ++k) {
      min[k] = max[k] = Number(&seed);
      const double size = side * std::abs(Number(&seed));
      if (Below(2, &seed) == 0) {
        min[k] -= size;
      } else {
        max[k] += size;
      }
      if (axes == dims) continue;
      min[dims] -= max[k];
      max[dims] -= min[k];
    }
    if (has_special && i == 3) min[0] = std::nan("");
    if (has_special && i == 5) {
      min.assign(axes, kInfinity);
      max.assign(axes, -kInfinity);
    }
    if (has_special && i == 7) std::swap(min[1], max[1]);
    all.insert(all.end(), min.begin(), min.end());
    all.insert(all.end(), max.begin(), max.end());
  }
  return Records(2 * axes, axes, std::move(all));
}

// Structs of the floats of each record, from value `first` on.
template <typename Struct>
std::vector<Struct> Structs(const Records& records, std::size_t first = 0) {
  std::vector<Struct> all(records.count());
  for (std::size_t i = 0; i < all.size(); ++i) {
    memcpy(&all[i], records.row(i) + first, sizeof(Struct));
  }
  return all;
}

// What the two APIs call the same.
template <typename ViewType>
struct Kind {
  using View = ViewType;
  using Bound = typename View::Bound;
  static constexpr std::size_t kDims = Bound::kDimensions;
  static constexpr std::size_t kAxes = Bound::kAxes;
  static constexpr std::size_t kValues = 2 * kAxes;
  static constexpr bool kIsBox = kAxes == kDims;
  static constexpr bool kIsSimplex = !detail::HasMax<Bound>;
  static constexpr auto kKind =
      static_cast<hs_kind>((kIsBox       ? HS_BOX2
                            : kIsSimplex ? HS_SIMPLEX2
                                         : HS_OCTAHEDRON2) +
                           kDims - 2);

  static Records Make(std::size_t count, double side, std::uint32_t seed) {
    return RandomBounds(count, kDims, kAxes, side, seed);
  }
  // Without the columns that are not read.
  static hs_columns Objects(const Records& records, Form form) {
    return Without(records.In(form), kAxes, kValues);
  }
  static hs_columns Queries(const Records& records, Form form) {
    return Without(records.In(form), 0, kAxes);
  }
  static auto BoundsOf(const Records& records) {
    return Structs<Bound>(records);
  }
  static auto QueriesOf(const Records& records) {
    return Structs<typename View::Query>(records, kIsSimplex ? kAxes : 0);
  }
  // The maxima of a simplex are infinite.
  static bool IsRecord(const float* record, const Bound& bound) {
    std::array<float, kValues> expected;
    expected.fill(kInfinity);
    memcpy(expected.data(), &bound, sizeof(bound));
    return memcmp(record, expected.data(), sizeof(expected)) == 0;
  }

 private:
  static hs_columns Without(hs_columns columns, std::size_t begin,
                            std::size_t end) {
    for (std::size_t v = begin; kIsSimplex && v < end; ++v)
      columns.column[v] = nullptr;
    return columns;
  }
};

template <typename List>
List Sorted(List list) {
  std::sort(list.begin(), list.end());
  return list;
}

template <typename Options>
Options DefaultsOf(hs_status (*fill)(Options*, std::size_t)) {
  Options options;
  CHECK_OK(fill(&options, sizeof(options)));
  return options;
}

// The result that a function writes last.
template <typename Result, typename... Parameters, typename... Arguments>
Result Get(hs_status (*function)(Parameters...), Arguments... arguments) {
  Result result{};
  CHECK_OK(function(arguments..., &result));
  return result;
}
template <typename... Parameters, typename... Arguments>
std::size_t SizeOf(hs_status (*function)(Parameters...),
                   Arguments... arguments) {
  return Get<std::size_t>(function, arguments...);
}

const char* LastTarget() { return hs_target_name(hs_target_count() - 1); }

// Builders.

// Compares the records that call(kind, columns, options, bounds, everything)
// writes with the planes that fit(rows, planes, options, status) writes.
template <int kDims, typename Call, typename Fit>
void CheckBuilder(const Records& records, std::size_t shapes, const Call& call,
                  const Fit& fit) {
  const auto check = [&]<typename World>(hs_kind kind, World world, Form form,
                                         const auto* rows) {
    using Its = Kind<typename World::View>;
    for (int is_empty : {0, 1}) {
      hs_bound_options of_c = DefaultsOf(&hs_bound_options_default);
      of_c.empty_if_inverted = is_empty;
      of_c.target = LastTarget();
      FitOptions of_cc;
      of_cc.inverted = is_empty != 0 ? Inverted::kEmpty : Inverted::kEverything;
      FitStatus status;
      world.Resize(shapes);
      fit(rows, world.planes(), of_cc, &status);
      std::vector<float> bounds(shapes * Its::kValues + 1, 7.0f);
      std::size_t everything = 99;
      const hs_columns columns = records.In(form);
      CHECK_OK(call(kind, &columns, &of_c, bounds.data(), &everything));
      CHECK(everything == status.everything && bounds.back() == 7);
      for (std::size_t i = 0; i < shapes; ++i) {
        CHECK(Its::IsRecord(bounds.data() + i * Its::kValues, world.Get(i)));
      }
    }
  };
  const auto check_all = [&]<typename World>(int of, World world) {
    const auto kind = static_cast<hs_kind>(of + kDims - 2);
    for (Form form : kFloats) check(kind, world, form, records.row(0));
    check(kind, world, kDoubles, records.doubles(0));
  };
  check_all(HS_OCTAHEDRON2, AaboWorld<kDims>());
  check_all(HS_SIMPLEX2, AaboWorld<kDims>());
  check_all(HS_BOX2, AabbWorld<kDims>());
}

template <int kDims>
void TestBuilders() {
  constexpr auto kD = static_cast<std::size_t>(kDims);
  const auto columns_of = []<typename T>(const T* rows, std::size_t stride,
                                         auto* to) {
    for (std::size_t k = 0; k < kD; ++k) (*to)[k] = rows + k;
    return stride;
  };
  CheckBuilder<kDims>(
      RandomBounds(kObjects, kD, kD, 1, 1), kObjects, &hs_bound_boxes,
      [&]<typename T>(const T* rows, auto... rest) {
        Boxes<kDims, T> boxes;
        columns_of(rows, 0, &boxes.min);
        boxes.stride = columns_of(rows + kD, 2 * kD, &boxes.max);
        boxes.count = kObjects;
        BoundBoxes(boxes, rest...);
      });
  // Some radii are negative.
  CheckBuilder<kDims>(
      RandomNumbers(kObjects, kD + 1, 2), kObjects, &hs_bound_spheres,
      [&]<typename T>(const T* rows, auto... rest) {
        Spheres<kDims, T> spheres;
        spheres.stride = columns_of(rows, kD + 1, &spheres.center);
        spheres.radius = rows + kD;
        spheres.count = kObjects;
        BoundSpheres(spheres, rest...);
      });
  CheckBuilder<kDims>(RandomNumbers(kObjects, kD, 3), kObjects,
                      &hs_bound_points,
                      [&]<typename T>(const T* rows, auto... rest) {
                        Boxes<kDims, T> boxes;
                        columns_of(rows, 0, &boxes.min);
                        boxes.stride = columns_of(rows, kD, &boxes.max);
                        boxes.count = kObjects;
                        BoundBoxes(boxes, rest...);
                      });
  Ids corners(3 * kObjects);
  std::iota(corners.begin(), corners.end(), 0u);
  CheckBuilder<kDims>(RandomNumbers(kObjects, 3 * kD, 4), kObjects,
                      &hs_bound_triangles,
                      [&]<typename T>(const T* rows, auto... rest) {
                        BoundTriangles(Points<kDims, T>{rows, corners.size()},
                                       corners, rest...);
                      });
  // Some vertices do not exist.
  std::uint32_t seed = 5;
  for (std::uint32_t& corner : corners) corner = Below(502, &seed);
  const Records points = RandomNumbers(500, kD, 6);
  CheckBuilder<kDims>(
      points, kObjects,
      [&](hs_kind kind, const hs_columns* columns, auto... rest) {
        return hs_bound_faces(kind, columns, corners.data(), kObjects, rest...);
      },
      [&]<typename T>(const T* rows, auto... rest) {
        BoundTriangles(Points<kDims, T>{rows, points.count()}, corners,
                       rest...);
      });
  // Sets of 0 to 2 points, and some that end too late or begin too late.
  std::vector<std::size_t> ends;
  for (std::size_t end = 0; ends.size() < 450;)
    ends.push_back(end += Below(3, &seed));
  const Records of_sets = RandomNumbers(ends.back(), kD, 7);
  for (std::size_t i = 20; i < 450; i += 40) ends[i] = Below(600, &seed);
  CheckBuilder<kDims>(
      of_sets, ends.size(),
      [&](hs_kind kind, const hs_columns* columns, auto... rest) {
        return hs_bound_point_sets(kind, columns, ends.data(), ends.size(),
                                   rest...);
      },
      [&]<typename T>(const T* rows, auto... rest) {
        BoundPointSets(Points<kDims, T>{rows, of_sets.count()}, ends, rest...);
      });
}

// A function of C with its first arguments.
template <typename Function, typename... First>
auto Of(const Function& function, First... first) {
  return [=](auto... rest) { return function(first..., rest...); };
}

// Counts, any of the ids, and lists of all and of some of them, by functions of
// C. Returns the list of all. `expected` are the ids of each query, in order.
template <typename Options, typename Count, typename Any, typename List>
Ids CheckLists(const std::vector<Ids>& expected, Options options,
               const Count& count, const Any& any, const List& list) {
  const std::size_t queries = expected.size();
  std::vector<std::size_t> counts(queries);
  std::vector<std::size_t> offsets(queries + 1);
  Ids some_of_each(queries);
  std::size_t total = 0;
  options.skip = 5;  // of `list` alone
  CHECK_OK(count(&options, counts.data()));
  CHECK_OK(any(&options, some_of_each.data()));
  options.skip = 0;
  CHECK_OK(list(&options, nullptr, 0, nullptr, &total));
  Ids ids(total);
  CHECK_OK(list(&options, ids.data(), total, offsets.data(), &total));
  CHECK(offsets[0] == 0 && offsets[queries] == total && total == ids.size());
  for (std::size_t q = 0; q < queries; ++q) {
    const Ids& its = expected[q];
    CHECK(counts[q] == its.size());
    CHECK(its.empty()
              ? some_of_each[q] == HS_NO_ID
              : std::binary_search(its.begin(), its.end(), some_of_each[q]));
    CHECK(Sorted(Ids(ids.begin() + offsets[q], ids.begin() + offsets[q + 1])) ==
          its);
  }
  for (options.skip = 0; options.skip < total; options.skip += total / 9 + 1) {
    std::array<std::uint32_t, 3> some{};
    const std::size_t room = std::min(some.size(), total - options.skip);
    std::size_t again = 0;
    CHECK_OK(list(&options, some.data(), room, offsets.data(), &again));
    CHECK(again == total && offsets[queries] == total);
    CHECK(std::equal(some.begin(), some.begin() + room,
                     ids.begin() + options.skip));
  }
  return ids;
}

// Scans.

template <typename View>
void TestScan(int bits, Form form, std::size_t count = kQueries) {
  using Its = Kind<View>;
  const Records objects = Its::Make(kObjects, 0.3, 11);
  const Records queries = Its::Make(count, 0.6, 12);
  const auto bounds = Its::BoundsOf(objects);
  const World<View> world{Span<const typename View::Bound>(bounds)};
  const auto asked = Its::QueriesOf(queries);
  const hs_columns of_objects = Its::Objects(objects, form);
  const hs_columns of_queries = Its::Queries(queries, form);
  const hs_scan_config config = scan_config_of(Its::kKind, bits);
  hs_scan* const scan = Get<hs_scan*>(&hs_scan_create, &config, &of_objects);
  CHECK(SizeOf(&hs_scan_size, scan) == kObjects);
  for (const auto& [begin, end] :
       {std::pair(std::size_t{0}, SIZE_MAX),
        std::pair(std::size_t{64}, std::size_t{200})}) {
    hs_scan_options options = DefaultsOf(&hs_scan_options_default);
    options.begin = begin;
    options.end = end;
    if (begin != 0) options.target = LastTarget();
    Options of_cc;
    of_cc.range = {begin, end};
    const std::size_t words = hs_mask_words(std::min(end, kObjects) - begin);
    std::vector<std::uint64_t> masks(words * count);
    CHECK_OK(
        hs_scan_masks(scan, &of_queries, &options, masks.data(), masks.size()));
    std::vector<Ids> expected;
    Ids all;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::size_t q = 0; q < count; ++q) {
      std::vector<std::uint64_t> mask(words);
      SurvivorMask(world, asked[q], mask, of_cc);
      CHECK(std::equal(mask.begin(), mask.end(), masks.begin() + q * words));
      Ids& found = expected.emplace_back(kObjects);
      found.resize(Survivors(world, asked[q], found, of_cc));
      for (std::uint32_t i : found) pairs.emplace_back(q, i);
      all.insert(all.end(), found.begin(), found.end());
    }
    CHECK(!all.empty());
    CHECK(CheckLists(expected, options, Of(&hs_scan_counts, scan, &of_queries),
                     Of(&hs_scan_any, scan, &of_queries),
                     Of(&hs_scan_indices, scan, &of_queries)) == all);
    Ids of_pairs[2] = {all, all};
    std::size_t total = 0;
    CHECK_OK(hs_scan_pairs(scan, &of_queries, &options, of_pairs[0].data(),
                           of_pairs[1].data(), all.size(), &total));
    CHECK(total == all.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> found;
    for (std::size_t i = 0; i < total; ++i) {
      found.emplace_back(of_pairs[0][i], of_pairs[1][i]);
    }
    CHECK(Sorted(found) == pairs);
    options.skip = total - 1;
    CHECK_OK(hs_scan_pairs(scan, &of_queries, &options, of_pairs[0].data(),
                           of_pairs[1].data(), 1, &total));
    CHECK(total == all.size());
    CHECK(std::pair(of_pairs[0][0], of_pairs[1][0]) == found.back());
  }
  hs_scan_destroy(scan);
}

// Searches, of BVHs and of broad phases.

struct BvhFunctions {
  using Handle = hs_bvh;
  static constexpr auto kQuery = &hs_bvh_query;
  static constexpr auto kCount = &hs_bvh_count;
  static constexpr auto kAny = &hs_bvh_any;
  static constexpr auto kProbe = &hs_bvh_query_each;
  static constexpr auto kNearestToPoints = &hs_bvh_nearest_to_points;
  static constexpr auto kNearestToBoxes = &hs_bvh_nearest_to_boxes;
  static constexpr auto kRayCast = &hs_bvh_raycast;
  static constexpr auto kBoxCast = &hs_bvh_boxcast;
  static constexpr auto kSphereCast = &hs_bvh_spherecast;
  static constexpr auto kRayCastEach = &hs_bvh_raycast_each;
  static constexpr auto kBoxCastEach = &hs_bvh_boxcast_each;
  static constexpr auto kSphereCastEach = &hs_bvh_spherecast_each;
  static constexpr auto kPairsOf = &hs_bvh_pairs_of;
  static constexpr auto kPairsOfEach = &hs_bvh_pairs_of_each;
};
struct BodyFunctions {
  using Handle = hs_broad_phase;
  static constexpr auto kQuery = &hs_broad_phase_query;
  static constexpr auto kCount = &hs_broad_phase_count;
  static constexpr auto kAny = &hs_broad_phase_any;
  static constexpr auto kProbe = &hs_broad_phase_query_each;
  static constexpr auto kNearestToPoints = &hs_broad_phase_nearest_to_points;
  static constexpr auto kNearestToBoxes = &hs_broad_phase_nearest_to_boxes;
  static constexpr auto kRayCast = &hs_broad_phase_raycast;
  static constexpr auto kBoxCast = &hs_broad_phase_boxcast;
  static constexpr auto kSphereCast = &hs_broad_phase_spherecast;
  static constexpr auto kRayCastEach = &hs_broad_phase_raycast_each;
  static constexpr auto kBoxCastEach = &hs_broad_phase_boxcast_each;
  static constexpr auto kSphereCastEach = &hs_broad_phase_spherecast_each;
  static constexpr auto kPairsOf = &hs_broad_phase_pairs_of;
  static constexpr auto kPairsOfEach = &hs_broad_phase_pairs_of_each;
};

// What a probe found, and after how many calls it stops.
struct Probed {
  std::vector<Ids> ids = std::vector<Ids>(kQueries);
  std::size_t last_query = 0;
  std::size_t calls = 0;
  std::size_t stop_after = 0;

  static hs_visit Add(void* context, std::size_t query,
                      const std::uint32_t* ids, std::size_t count) {
    auto& its = *static_cast<Probed*>(context);
    CHECK(query >= its.last_query && count > 0);
    its.last_query = query;
    its.ids[query].insert(its.ids[query].end(), ids, ids + count);
    return ++its.calls == its.stop_after ? HS_STOP : HS_CONTINUE;
  }
};

template <typename Functions, typename World, typename Query>
void CheckQueries(const World& world, const typename Functions::Handle* handle,
                  const hs_columns& columns, const std::vector<Query>& queries,
                  hs_shape shape, std::uint32_t mask) {
  const std::size_t count = shape == HS_SHAPE_HALF_SPACES ? 1 : columns.count;
  hs_query_options options = DefaultsOf(&hs_query_options_default);
  options.shape = shape;
  options.mask = mask;
  options.skip = 5;  // of kQuery alone
  if (mask != kAll) options.target = LastTarget();
  QueryOptions of_cc;
  of_cc.mask = mask;
  std::vector<Ids> expected;
  for (std::size_t q = 0; q < count; ++q) {
    Ids& found =
        expected.emplace_back(CountSurvivors(world, queries[q], of_cc));
    CHECK(Survivors(world, queries[q], found, of_cc) == found.size());
    std::sort(found.begin(), found.end());
  }
  Probed probed;
  probed.ids.resize(count);
  CHECK_OK(
      Functions::kProbe(handle, &columns, &options, &Probed::Add, &probed));
  CHECK(probed.calls > 0 || count == 1);
  for (auto& ids : probed.ids) std::sort(ids.begin(), ids.end());
  CHECK(probed.ids == expected);
  Probed stopped;
  stopped.stop_after = 1;
  CHECK_OK(
      Functions::kProbe(handle, &columns, &options, &Probed::Add, &stopped));
  CHECK(stopped.calls == std::min<std::size_t>(1, probed.calls));
  CheckLists(expected, options, Of(Functions::kCount, handle, &columns),
             Of(Functions::kAny, handle, &columns),
             Of(Functions::kQuery, handle, &columns));
}

// `nearest(q, ids, distances, options)` is the C++ call.
template <typename Call, typename Nearest>
void CheckNearest(float max_distance, const Call& call, const Nearest& nearest,
                  bool is_exclusive = false) {
  constexpr std::size_t kNearest = 5;
  for (std::uint32_t mask : {kAll, 6u}) {
    hs_query_options options = DefaultsOf(&hs_query_options_default);
    options.mask = mask;
    options.skip = 1;  // of kQuery alone
    if (mask != kAll) options.target = LastTarget();
    SearchOptions of_cc;
    of_cc.mask = mask;
    options.exclusive = of_cc.exclusive = is_exclusive;
    Ids ids(kQueries * kNearest);
    Ids without_distances(ids.size());
    std::vector<float> distances(ids.size());
    CHECK_OK(
        call(kNearest, max_distance, &options, ids.data(), distances.data()));
    CHECK_OK(call(kNearest, max_distance, &options, without_distances.data(),
                  nullptr));
    CHECK(ids == without_distances &&
          *std::min_element(ids.begin(), ids.end()) != HS_NO_ID);
    for (std::size_t q = 0; q < kQueries; ++q) {
      Ids its_ids(kNearest);
      std::vector<float> its_distances(kNearest);
      const std::size_t found = nearest(q, its_ids, its_distances, of_cc);
      std::fill(its_ids.begin() + found, its_ids.end(), HS_NO_ID);
      std::fill(its_distances.begin() + found, its_distances.end(), kInfinity);
      CHECK(std::equal(its_ids.begin(), its_ids.end(),
                       ids.begin() + q * kNearest));
      CHECK(std::equal(its_distances.begin(), its_distances.end(),
                       distances.begin() + q * kNearest));
    }
  }
}

// Hits, in their order. Some casts go on, some end at the nearest, some at the
// first.
struct Hits {
  std::vector<std::tuple<std::size_t, std::uint32_t, float>> all;

  float Add(std::size_t cast, std::uint32_t id, float t) {
    all.emplace_back(cast, id, t);
    return cast % 3 == 0 ? kInfinity : cast % 3 == 1 ? t : -1.0f;
  }
  static float AddOne(void* hits, std::size_t cast, std::uint32_t id, float t) {
    return static_cast<Hits*>(hits)->Add(cast, id, t);
  }
};

// `each` and `first` are the C functions, and cast(i, function, options) the
// C++ call.
template <typename Each, typename First, typename Cast>
void CheckCasts(const Each& each, const First& first, const Cast& cast) {
  for (std::uint32_t mask : {kAll, 6u}) {
    hs_query_options options = DefaultsOf(&hs_query_options_default);
    options.mask = mask;
    if (mask != kAll) options.target = LastTarget();
    SearchOptions of_cc;
    of_cc.mask = mask;
    Hits hits;
    Hits expected;
    Ids ids(kQueries);
    Ids without_ts(kQueries);
    std::vector<float> ts(kQueries);
    CHECK_OK(each(&options, &Hits::AddOne, &hits));
    CHECK_OK(first(&options, ids.data(), ts.data()));
    CHECK_OK(first(&options, without_ts.data(), nullptr));
    CHECK(ids == without_ts);
    for (std::size_t i = 0; i < kQueries; ++i) {
      cast(
          i,
          [&](std::uint32_t id, float t) {
            return Limit{expected.Add(i, id, t)};
          },
          of_cc);
      auto closest = std::pair(kInfinity, HS_NO_ID);
      cast(
          i,
          [&](std::uint32_t id, float t) {
            closest = std::min(closest, std::pair(t, id));
            return Limit{kInfinity};
          },
          of_cc);
      CHECK(std::pair(ts[i], ids[i]) == closest);
    }
    CHECK(hits.all == expected.all && hits.all.size() > 10);
  }
}

// Pairs, in their order.
struct FoundPairs {
  std::vector<IdPair> pairs;
  bool stops = false;

  static hs_visit Add(void* context, const hs_id_pair* pairs,
                      std::size_t count) {
    auto& its = *static_cast<FoundPairs*>(context);
    CHECK(count > 0);
    for (std::size_t i = 0; i < count; ++i)
      its.pairs.push_back({pairs[i].a, pairs[i].b});
    return its.stops ? HS_STOP : HS_CONTINUE;
  }
};

// `list` and `each` are the C functions, and pairs(pairs, options) the C++
// call. `wanted` is for the objects of a set.
template <typename List, typename Each, typename Pairs>
void CheckPairs(const List& list, const Each& each, const Pairs& pairs,
                Span<const std::uint32_t> wanted = {}) {
  for (int choice = 0; choice < 4; ++choice) {
    hs_pair_options options = DefaultsOf(&hs_pair_options_default);
    PairOptions of_cc;
    if (choice % 2 == 1) {
      options.mask = of_cc.mask = 7;
      // The margin first, then the distance.
      if (choice == 1) options.margin = of_cc.margin = 0.01f;
      if (choice == 3) options.within = of_cc.within = 0.02f;
      options.target = LastTarget();
      options.wanted = wanted.data();
      of_cc.wanted = wanted;
    }
    if (choice / 2 == 1) {
      options.skip = of_cc.skip = 5;
      options.begin = of_cc.begin = wanted.empty() ? 1 : 0;
      options.end = of_cc.end = wanted.empty() ? 3 : SIZE_MAX;
    }
    std::vector<IdPair> expected(pairs(Span<IdPair>(), of_cc) - of_cc.skip);
    const std::size_t total = pairs(Span<IdPair>(expected), of_cc);
    CHECK(total > 20 && total == expected.size() + of_cc.skip);
    std::vector<hs_id_pair> listed(expected.size() + 1, hs_id_pair{99, 99});
    std::size_t found = 0;
    CHECK_OK(list(&options, listed.data(), expected.size(), &found));
    CHECK(found == total && listed.back().a == 99);
    CHECK(memcmp(listed.data(), expected.data(), expected.size() * 8) == 0);
    CHECK_OK(list(&options, listed.data(), 0, &found));
    CHECK(found == total);
    FoundPairs given;
    CHECK_OK(each(&options, &FoundPairs::Add, &given));
    CHECK(given.pairs == expected);
    FoundPairs stopped;
    stopped.stops = true;
    CHECK_OK(each(&options, &FoundPairs::Add, &stopped));
    CHECK(!stopped.pairs.empty() && stopped.pairs.size() <= 256);
  }
}

template <typename Functions, typename World>
void CheckSearches(const World& world, const typename Functions::Handle* handle,
                   const Ids& ids) {
  using View = typename World::View;
  using Its = Kind<View>;
  constexpr int kDims = Its::kDims;
  const Records bounds = Its::Make(kQueries, 0.3, 21);
  const Records points = RandomNumbers(kQueries, kDims, 22);
  const Records spheres = RandomNumbers(kQueries, kDims + 1, 23, 0.1);
  const Records boxes = RandomBounds(kQueries, kDims, kDims, 0.1, 24, false);
  const Records rounded = RandomNumbers(kQueries, 2 * kDims + 1, 25, 0.1);
  const auto check = [&](const hs_columns& columns, const auto& queries,
                         hs_shape shape, std::uint32_t mask) {
    CheckQueries<Functions>(world, handle, columns, queries, shape, mask);
  };
  const auto as_bounds = Its::QueriesOf(bounds);
  hs_columns one = Its::Queries(bounds, kRows);
  one.count = 1;
  check(one, as_bounds, HS_SHAPE_BOUND, kAll);
  for (std::uint32_t mask : {kAll, 6u}) {
    for (Form form : kForms) {
      check(Its::Queries(bounds, form), as_bounds, HS_SHAPE_BOUND, mask);
      if (form == kDoubles) continue;
      check(points.In(form), Structs<Point<kDims>>(points), HS_SHAPE_POINT,
            mask);
      check(spheres.In(form), Structs<Sphere<kDims>>(spheres), HS_SHAPE_SPHERE,
            mask);
      check(rounded.In(form), Structs<RoundedBox<kDims>>(rounded),
            HS_SHAPE_ROUNDED_BOX, mask);
    }
  }

  // The rows are one query.
  const Records sides = RandomNumbers(5, kDims + 1, 26, 0.5);
  for (std::uint32_t mask : {kAll, 6u}) {
    CheckQueries<Functions>(world, handle, sides.In(kRows),
                            std::vector<std::vector<HalfSpace<kDims>>>(
                                1, Structs<HalfSpace<kDims>>(sides)),
                            HS_SHAPE_HALF_SPACES, mask);
  }

  const auto as_boxes = Structs<Aabb<kDims>>(boxes);
  for (Form form : kForms) {
    const hs_columns of_boxes = boxes.In(form);
    CheckNearest(0.05f, Of(Functions::kNearestToBoxes, handle, &of_boxes),
                 [&](std::size_t q, auto& its_ids, auto& distances,
                     const auto& options) {
                   return KNearest(world, as_boxes[q], its_ids, distances,
                                   0.05f, options);
                 });
    // A point of doubles is the box of floats around it.
    const hs_columns of_points = points.In(form);
    CheckNearest(
        kInfinity, Of(Functions::kNearestToPoints, handle, &of_points),
        [&](std::size_t q, auto& its_ids, auto& distances,
            const auto& options) {
          Aabb<kDims> box;
          for (std::size_t k = 0; k < kDims; ++k) {
            const double value = points.doubles(q)[k];
            const float nearest = points.row(q)[k];
            box.min[k] = form == kDoubles ? Round(value, -kInfinity) : nearest;
            box.max[k] = form == kDoubles ? Round(value, kInfinity) : nearest;
          }
          return KNearest(world, box, its_ids, distances, kInfinity, options);
        });
  }

  // Those of objects, except their equals.
  if constexpr (Its::kIsBox) {
    std::vector<Aabb<kDims>> objects;
    // Of the first ones some are special.
    for (std::uint32_t id = 8; objects.size() < kQueries; ++id) {
      if (world.Has(id)) objects.push_back(world.Get(id));
    }
    const hs_columns of_objects =
        hs_float_rows(&objects[0].min[0], kQueries, Its::kValues);
    CheckNearest(
        0.05f, Of(Functions::kNearestToBoxes, handle, &of_objects),
        [&](std::size_t q, auto& its_ids, auto& distances,
            const auto& options) {
          return KNearest(world, objects[q], its_ids, distances, 0.05f,
                          options);
        },
        true);
  }

  // Rays have their motions behind their origins.
  std::uint32_t seed = 25;
  std::vector<double> numbers;
  std::vector<double> motion_numbers;
  for (std::size_t i = 0; i < kQueries; ++i) {
    for (int k = 0; k < kDims; ++k) numbers.push_back(Number(&seed));
    for (int k = 0; k < kDims; ++k)
      motion_numbers.push_back(Number(&seed) - 0.5);
    motion_numbers.push_back(i % 2 == 0 ? 1 : kInfinity);
    numbers.insert(numbers.end(), motion_numbers.end() - kDims - 1,
                   motion_numbers.end());
  }
  const Records rays(2 * kDims + 1, 2 * kDims + 1, std::move(numbers));
  const Records motions(kDims + 1, kDims + 1, std::move(motion_numbers));
  const auto as_rays = Structs<Ray<kDims>>(rays);
  const auto as_spheres = Structs<Sphere<kDims>>(spheres);
  struct Motion {
    Point<kDims> direction;
    float max_t;
  };
  const auto as_motions = Structs<Motion>(motions);
  for (Form form : kForms) {
    const hs_columns of_rays = rays.In(form);
    const hs_columns of_motions = motions.In(form == kDoubles ? kRows : form);
    const hs_columns of_boxes = boxes.In(form);
    const hs_columns of_spheres = spheres.In(form);
    CheckCasts(Of(Functions::kBoxCastEach, handle, &of_boxes, &of_motions),
               Of(Functions::kBoxCast, handle, &of_boxes, &of_motions),
               [&](std::size_t i, const auto& function, const auto& options) {
                 BoxCast(world, as_boxes[i], as_motions[i].direction,
                         as_motions[i].max_t, function, options);
               });
    if (form == kDoubles) continue;
    CheckCasts(Of(Functions::kRayCastEach, handle, &of_rays, 0.01f),
               Of(Functions::kRayCast, handle, &of_rays, 0.01f),
               [&](std::size_t i, const auto& function, const auto& options) {
                 RayCast(world, as_rays[i], 0.01f, function, options);
               });
    CheckCasts(Of(Functions::kSphereCastEach, handle, &of_spheres, &of_motions),
               Of(Functions::kSphereCast, handle, &of_spheres, &of_motions),
               [&](std::size_t i, const auto& function, const auto& options) {
                 SphereCast(world, as_spheres[i], as_motions[i].direction,
                            as_motions[i].max_t, function, options);
               });
  }

  if constexpr (!Its::kIsSimplex) {
    Ids wanted;
    for (std::uint32_t id : ids) wanted.push_back(1u << id % 4);
    CheckPairs(
        Of(Functions::kPairsOf, handle, ids.data(), ids.size()),
        Of(Functions::kPairsOfEach, handle, ids.data(), ids.size()),
        [&](Span<IdPair> pairs, const PairOptions& options) {
          return PairsOf(world, ids, pairs, options);
        },
        wanted);
  }
}

void TestFrustum() {
  const Records numbers = RandomNumbers(1, 16, 27);
  std::array<float, 16> matrix{};
  std::copy_n(numbers.row(0), 16, matrix.begin());
  for (int depth = 0; depth < 2; ++depth) {
    for (int order = 0; order < 2; ++order) {
      const Frustum3 expected =
          FrustumPlanes(matrix.data(), static_cast<ClipDepth>(depth),
                        static_cast<MatrixOrder>(order));
      std::array<float, 48> half_spaces{};
      CHECK_OK(hs_frustum_planes(
          matrix.data(), static_cast<hs_clip_depth>(depth),
          static_cast<hs_matrix_order>(order), half_spaces.data()));
      CHECK(memcmp(half_spaces.data(), expected.data(), sizeof(expected)) == 0);
    }
  }
}

// BVHs.

template <typename View>
void CheckSame(const Bvh<View>& expected, const hs_bvh* bvh) {
  using Its = Kind<View>;
  const void* blob = nullptr;
  std::size_t size = 0;
  CHECK_OK(hs_bvh_blob(bvh, &blob, &size));
  const Span<const std::byte> its = expected.Blob();
  CHECK(size == its.size() && memcmp(blob, its.data(), size) == 0);
  CHECK(SizeOf(&hs_bvh_size, bvh) == expected.size());
  CHECK(SizeOf(&hs_bvh_bytes, bvh) == expected.bytes());
  CHECK(Get<double>(&hs_bvh_cost_ratio, bvh) == expected.CostRatio());
  constexpr std::array<float, 3> kExtents = {1, 0, INFINITY};
  double leaves = 0;
  if constexpr (detail::HasMax<typename View::Bound>) {
    std::array<float, View::Bound::kDimensions> extents;
    std::copy_n(kExtents.begin(), extents.size(), extents.begin());
    CHECK_OK(hs_bvh_expected_leaves(bvh, kExtents.data(), &leaves));
    CHECK(leaves == expected.ExpectedLeaves(extents));
  } else {
    CHECK(hs_bvh_expected_leaves(bvh, kExtents.data(), &leaves) ==
          HS_INVALID_ARGUMENT);
  }
  std::array<float, Its::kValues> around{};
  CHECK_OK(hs_bvh_bounds(bvh, around.data()));
  CHECK(Its::IsRecord(around.data(), expected.Bounds()));
  size = SizeOf(&hs_bvh_id_limit, bvh);
  CHECK(size == expected.id_limit());
  std::vector<float> records(size * Its::kValues + 1, 7);
  CHECK_OK(hs_bvh_get_all(bvh, records.data(), size + 9));
  CHECK(records.back() == 7);
  Ids ids;
  for (std::uint32_t id = 0; id < size; ++id) {
    const float* const record = records.data() + id * Its::kValues;
    if (expected.Has(id)) {
      CHECK(Its::IsRecord(record, expected.Get(id)));
      ids.push_back(id);
    } else {
      CHECK(record[0] == kInfinity && record[Its::kValues - 1] == -kInfinity);
    }
  }
  std::vector<float> some(ids.size() * Its::kValues);
  CHECK_OK(hs_bvh_get(bvh, ids.data(), ids.size(), some.data()));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    CHECK(memcmp(some.data() + i * Its::kValues,
                 records.data() + ids[i] * Its::kValues,
                 Its::kValues * sizeof(float)) == 0);
  }
}

template <typename View>
void TestBvh() {
  using Its = Kind<View>;
  using Bound = typename View::Bound;
  const Records objects = Its::Make(kObjects, 0.2, 31);
  const auto bounds = Its::BoundsOf(objects);
  for (hs_quality quality : {HS_QUALITY_HIGH, HS_QUALITY_FAST}) {
    hs_bvh_config config = bvh_config_of(Its::kKind);
    config.quality = quality;
    config.target = LastTarget();
    BuildOptions build;
    build.quality =
        quality == HS_QUALITY_HIGH ? BuildQuality::kHigh : BuildQuality::kFast;
    hs_builder* builder = nullptr;
    CHECK_OK(hs_builder_create(&config, &builder));
    std::vector<Bound> pushed;
    Bvh<View> expected{Span<const Bound>(bounds), build};
    hs_bvh* bvh = nullptr;
    for (Form form : kForms) {
      hs_bvh_destroy(bvh);
      const hs_columns columns = Its::Objects(objects, form);
      CHECK_OK(hs_bvh_create(&config, &columns, &bvh));
      CheckSame(expected, bvh);
      CHECK_OK(hs_builder_push(builder, &columns));
      pushed.insert(pushed.end(), bounds.begin(), bounds.end());
      hs_bvh* built = nullptr;
      CHECK_OK(hs_builder_finish(builder, &built));
      CheckSame(Bvh<View>(Span<const Bound>(pushed), build), built);
      hs_bvh_destroy(built);
    }
    hs_builder_destroy(builder);

    // Changes, each by records in another form.
    std::uint32_t seed = 40;
    for (Form form : kForms) {
      const Records some = Its::Make(100, 0.2, ++seed);
      const auto their_bounds = Its::BoundsOf(some);
      const Span<const Bound> span(their_bounds);
      const hs_columns columns = Its::Objects(some, form);
      Ids ids(100);
      Ids its_ids(100);
      CHECK_OK(hs_bvh_insert(bvh, &columns, ids.data()));
      expected.Insert(span, its_ids);
      CHECK(ids == its_ids);
      for (std::size_t i = 0; i < ids.size(); ++i) {
        ids[i] = static_cast<std::uint32_t>(expected.id_limit() + 5 + i);
      }
      CHECK_OK(hs_bvh_insert_as(bvh, ids.data(), &columns));
      expected.InsertAs(ids, span);
      CheckSame(expected, bvh);
      Ids masks;
      for (std::uint32_t& id : ids) {
        id -= 300;
        masks.push_back(1u << id % 4);
        expected.SetMasks(id, masks.back());
      }
      CHECK_OK(hs_bvh_set_masks(bvh, ids.data(), masks.data(), masks.size()));
      CHECK_OK(hs_bvh_set(bvh, ids.data(), &columns));
      expected.Set(ids, span);
      CheckSame(expected, bvh);
      CHECK_OK(hs_bvh_erase(bvh, ids.data(), 20));
      expected.Erase({ids.data(), 20});
      CheckSame(expected, bvh);
      const Records all = Its::Make(expected.id_limit(), 0.2, ++seed);
      const hs_columns of_all = Its::Objects(all, form);
      CHECK_OK(hs_bvh_refit(bvh, &of_all, nullptr, nullptr));
      const auto all_bounds = Its::BoundsOf(all);
      expected.Refit(Span<const Bound>(all_bounds));
      CheckSame(expected, bvh);
    }
    CHECK_OK(hs_bvh_reserve(bvh, 5000));
    expected.Reserve(5000);
    CheckSame(expected, bvh);
    CHECK_OK(hs_bvh_rebuild(bvh, &config));
    expected.Rebuild(build);
    CheckSame(expected, bvh);
    Ids masks;
    for (std::uint32_t id = 0; id < expected.id_limit(); ++id)
      masks.push_back(1u << id % 5);
    CHECK_OK(hs_bvh_set_all_masks(bvh, masks.data(), masks.size()));
    expected.SetMasks(masks);
    CheckSame(expected, bvh);
    if (quality == HS_QUALITY_HIGH) {
      hs_bvh_destroy(bvh);
      continue;
    }

    Ids set;
    for (std::uint32_t id = 0; id < 300; id += 2) {
      if (expected.Has(id)) set.push_back(id);
    }
    CheckSearches<BvhFunctions>(expected, bvh, set);
    if constexpr (!Its::kIsSimplex) {
      CHECK(SizeOf(&hs_bvh_pair_parts, bvh) == PairParts(expected));
      CheckPairs(Of(&hs_bvh_pairs, bvh), Of(&hs_bvh_pairs_each, bvh),
                 [&](Span<IdPair> pairs, const PairOptions& options) {
                   return Pairs(expected, pairs, options);
                 });
      const hs_columns columns = Its::Objects(objects, kRows);
      const Bvh<View> other{Span<const Bound>(bounds), build};
      hs_bvh* second = nullptr;
      CHECK_OK(hs_bvh_create(&config, &columns, &second));
      CheckPairs(Of(&hs_bvh_join, bvh, second),
                 Of(&hs_bvh_join_each, bvh, second),
                 [&](Span<IdPair> pairs, const PairOptions& options) {
                   return Pairs(expected, other, pairs, options);
                 });
      hs_bvh_destroy(second);
    }
    hs_bvh_destroy(bvh);
  }
}

template <typename Handle>
bool IsSame(Span<const IdPair> expected,
            hs_status (*list)(const Handle*, const hs_id_pair**, std::size_t*),
            const Handle* handle) {
  const hs_id_pair* pairs = nullptr;
  std::size_t count = 0;
  CHECK_OK(list(handle, &pairs, &count));
  return count == expected.size() &&
         std::equal(expected.begin(), expected.end(), pairs,
                    [](const IdPair& a, const hs_id_pair& b) {
                      return a.a == b.a && a.b == b.b;
                    });
}

// Pair events of a BVH that changes, on every third update of all objects.
template <typename View>
void TestPairEvents() {
  using Its = Kind<View>;
  using Bound = typename View::Bound;
  const Records first = Its::Make(kObjects, 0.1, 80);
  const auto bounds = Its::BoundsOf(first);
  Bvh<View> world{Span<const Bound>(bounds)};
  PairEvents expected;
  const hs_columns columns = first.In(kRows);
  hs_bvh* const bvh = bvh_of(Its::kKind, &columns);
  auto* const events = Get<hs_pair_events*>(&hs_pair_events_create, nullptr);
  Ids changed(40);
  std::iota(changed.begin(), changed.end(), 8u);
  for (std::uint32_t frame = 0; frame < 12; ++frame) {
    const Records some = Its::Make(changed.size(), 0.1, 90 + frame);
    const auto its = Its::BoundsOf(some);
    const hs_columns moved = some.In(kRows);
    world.Set(changed, Span<const Bound>(its));
    CHECK_OK(hs_bvh_set(bvh, changed.data(), &moved));
    PairEventOptions options;
    auto of_c = DefaultsOf(&hs_pair_event_options_default);
    if (frame % 2 == 1) {
      options.margin = of_c.margin = 0.01f;
      options.mask = of_c.mask = 7;
      of_c.target = LastTarget();
    }
    if (frame % 3 == 0) {
      expected.Update(world, options);
      CHECK_OK(hs_pair_events_update(events, bvh, &of_c));
    } else {
      expected.Update(world, changed, options);
      CHECK_OK(hs_pair_events_update_of(events, bvh, changed.data(),
                                        changed.size(), &of_c));
    }
    CHECK(!expected.began().empty() &&
          (frame == 0 || !expected.ended().empty()));
    CHECK(IsSame(expected.pairs(), &hs_pair_events_pairs, events));
    CHECK(IsSame(expected.began(), &hs_pair_events_began, events));
    CHECK(IsSame(expected.ended(), &hs_pair_events_ended, events));
    if (frame == 7) {
      const Span<const IdPair> pairs = expected.pairs();
      const std::vector<IdPair> stored(pairs.begin(), pairs.end());
      expected.Load(stored);
      CHECK_OK(hs_pair_events_load(
          events, reinterpret_cast<const hs_id_pair*>(stored.data()),
          stored.size()));
      CHECK(IsSame({}, &hs_pair_events_began, events));
      CHECK(IsSame(expected.pairs(), &hs_pair_events_pairs, events));
    }
  }
  hs_pair_events_destroy(events);
  hs_pair_events_destroy(nullptr);
  hs_bvh_destroy(bvh);
}

// Broad phases.

bool KeepNoSevens(void* context, std::uint32_t a, std::uint32_t b,
                  bool masks_match) {
  CHECK(*static_cast<int*>(context) == 77);
  return a % 7 != 0 && b % 7 != 0 && masks_match;
}

template <typename View>
std::vector<std::byte> BytesOf(const BroadPhase<View>& bodies) {
  std::vector<std::byte> bytes;
  bodies.Save([&](Span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
  });
  return bytes;
}
// Nothing is written beyond the room.
std::vector<std::byte> BytesOf(const hs_broad_phase* bodies) {
  const std::size_t size = SizeOf(&hs_broad_phase_save, bodies, nullptr, 0);
  std::vector<std::byte> bytes(size + 1, std::byte{7});
  for (const std::size_t room : {size / 2, size}) {
    CHECK(SizeOf(&hs_broad_phase_save, bodies, bytes.data(), room) == size);
    CHECK(bytes[room] == std::byte{7});
  }
  bytes.pop_back();
  return bytes;
}

template <typename View>
void CheckSame(const BroadPhase<View>& expected, const hs_broad_phase* bodies) {
  using Its = Kind<View>;
  CHECK(BytesOf(bodies) == BytesOf(expected));
  CHECK(SizeOf(&hs_broad_phase_size, bodies) == expected.size());
  std::array<float, Its::kValues> around{};
  CHECK_OK(hs_broad_phase_bounds(bodies, around.data()));
  CHECK(Its::IsRecord(around.data(), expected.Bounds()));
  CHECK(Get<int>(&hs_broad_phase_validate, bodies) == 1);
  hs_body_statistics found;
  CHECK_OK(hs_broad_phase_statistics(bodies, &found, sizeof(found)));
  const BroadPhaseStatistics its = expected.Statistics();
  CHECK(found.bodies == its.bodies && found.pairs == its.pairs);
  CHECK(found.bytes == its.bytes && found.cost_ratio == its.cost_ratio);
  const std::size_t limit = SizeOf(&hs_broad_phase_id_limit, bodies);
  CHECK(limit == expected.id_limit());
  Ids ids;
  for (std::uint32_t id = 0; id < limit + 2; ++id) {
    const int has = Get<int>(&hs_broad_phase_has, bodies, id);
    CHECK(has == (expected.Has(id) ? 1 : 0));
    if (has == 1) ids.push_back(id);
  }
  std::vector<float> records(ids.size() * Its::kValues);
  std::vector<hs_body_masks> masks(ids.size());
  CHECK_OK(hs_broad_phase_get(bodies, ids.data(), ids.size(), records.data(),
                              masks.data()));
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const BodyMasks its_masks = expected.MasksOf(ids[i]);
    CHECK(
        Its::IsRecord(records.data() + i * Its::kValues, expected.Get(ids[i])));
    CHECK(masks[i].category == its_masks.category);
    CHECK(masks[i].collides_with == its_masks.collides_with);
  }
  CHECK(IsSame(expected.pairs(), &hs_broad_phase_pairs, bodies));
  CHECK(IsSame(expected.began(), &hs_broad_phase_began, bodies));
  CHECK(IsSame(expected.ended(), &hs_broad_phase_ended, bodies));
}

template <typename View>
void TestBroadPhase(bool moves_wait) {
  using Its = Kind<View>;
  int context = 77;
  auto config = DefaultsOf(&hs_broad_phase_config_default);
  config.kind = Its::kKind;
  config.keep = &KeepNoSevens;
  config.keep_context = &context;
  config.moves_are_seen_at_once = moves_wait ? 0 : 1;
  config.caller_locks = moves_wait ? 0 : 1;
  BroadPhaseOptions options;
  options.filter = {&KeepNoSevens, &context};
  options.moves_are_seen_at_once = !moves_wait;
  options.caller_locks = !moves_wait;
  BroadPhase<View> expected(options);
  auto* bodies = Get<hs_broad_phase*>(&hs_broad_phase_create, &config);
  std::uint32_t seed = 50;
  for (Form form : kForms) {
    const std::uint32_t first = 400u * static_cast<std::uint32_t>(form);
    Ids ids;
    std::vector<BodyMasks> masks;
    std::vector<hs_body_masks> of_c;
    for (std::uint32_t i = 0; i < 200; ++i) {
      ids.push_back(first + 2 * i);
      masks.push_back({1u << i % 5, i % 4 == 0 ? 3 : kAll});
      of_c.push_back({masks.back().category, masks.back().collides_with});
    }
    const Records some = Its::Make(ids.size(), 0.15, ++seed);
    const auto bounds = Its::BoundsOf(some);
    const hs_columns columns = some.In(form);
    const bool has_masks = form != kWide;
    CHECK_OK(hs_broad_phase_insert(bodies, ids.data(), &columns,
                                   has_masks ? of_c.data() : nullptr));
    expected.Insert(
        ids, bounds,
        has_masks ? Span<const BodyMasks>(masks) : Span<const BodyMasks>());
    CheckSame(expected, bodies);
    CHECK_OK(
        hs_broad_phase_set_masks(bodies, ids.data(), of_c.data() + 50, 100));
    expected.SetMasks({ids.data(), 100}, {masks.data() + 50, 100});
    CHECK_OK(hs_broad_phase_update_pairs(bodies, nullptr));
    expected.UpdatePairs();
    CheckSame(expected, bodies);
    // A move that queries see, or do not see yet.
    std::rotate(ids.begin(), ids.begin() + 60, ids.end());
    const Records moved = Its::Make(ids.size(), 0.15, ++seed);
    const hs_columns of_moved = moved.In(form);
    CHECK_OK(hs_broad_phase_move(bodies, ids.data(), &of_moved));
    expected.Move(ids, Its::BoundsOf(moved));
    std::vector<std::size_t> counts(some.count());
    CHECK_OK(hs_broad_phase_count(bodies, &columns, nullptr, counts.data()));
    for (std::size_t q = 0; q < counts.size(); ++q) {
      CHECK(counts[q] == CountSurvivors(expected, bounds[q]));
    }
    auto update = DefaultsOf(&hs_update_options_default);
    if (form != kRows) update.budget = form == kWide ? 0 : 100;
    CHECK_OK(hs_broad_phase_update(bodies, &update));
    expected.Update({update.budget, {}});
    CHECK_OK(hs_broad_phase_erase(bodies, ids.data(), 30));
    expected.Erase({ids.data(), 30});
    CHECK_OK(hs_broad_phase_update_pairs(bodies, nullptr));
    expected.UpdatePairs();
    CheckSame(expected, bodies);
    CHECK(!expected.began().empty() && !expected.ended().empty());

    // A copy, and a loaded one in the next forms.
    auto* const other =
        form == kRows ? Get<hs_broad_phase*>(&hs_broad_phase_copy, bodies)
                      : Get<hs_broad_phase*>(&hs_broad_phase_create, &config);
    // Its memory can differ.
    BroadPhase<View> copy(options);
    if (form == kRows) {
      copy = expected;
    } else {
      const std::vector<std::byte> bytes = BytesOf(bodies);
      CHECK_OK(hs_broad_phase_load(other, bytes.data(), bytes.size()));
      copy.Load(bytes);
    }
    hs_broad_phase_destroy(bodies);
    bodies = other;
    expected = std::move(copy);
    CheckSame(expected, bodies);
  }
  Ids set;
  for (std::uint32_t id = 0; id < 600; id += 3) {
    if (expected.Has(id)) set.push_back(id);
  }
  CheckSearches<BodyFunctions>(expected, bodies, set);
  CHECK_OK(hs_broad_phase_rebuild(bodies, nullptr));
  expected.Rebuild();
  CheckSame(expected, bodies);
  hs_broad_phase_destroy(bodies);
}

// A mesh, each of whose triangles is there twice, against all of them.
void TestTriangles() {
  constexpr std::size_t kTriangles = 600;
  const Records some = RandomNumbers(kTriangles / 2, 9, 90);
  std::vector<double> twice(some.doubles(0), some.doubles(kTriangles / 2));
  twice.insert(twice.end(), some.doubles(0), some.doubles(kTriangles / 2));
  const Records triangles(9, 9, std::move(twice));
  const Records rays = RandomNumbers(kQueries, 7, 91, 1);
  const auto all = Structs<Triangle<3>>(triangles);
  const auto as_rays = Structs<Ray<3>>(rays);
  std::vector<std::pair<std::size_t, std::uint32_t>> hits;
  std::vector<std::pair<float, std::uint32_t>> first;
  std::vector<std::pair<float, std::uint32_t>> closest;
  std::size_t rays_that_hit = 0;
  constexpr float kNear = 0.02f;
  for (std::size_t i = 0; i < kQueries; ++i) {
    first.emplace_back(kInfinity, HS_NO_ID);
    closest.emplace_back(kInfinity, HS_NO_ID);
    for (std::uint32_t id = 0; id < kTriangles; ++id) {
      const float t = HitTriangle(as_rays[i], all[id]);
      if (t < kInfinity) hits.emplace_back(i, id);
      if (t < kInfinity) first[i] = std::min(first[i], std::pair(t, id));
      const float away = ClosestPoint(as_rays[i].origin, all[id]).distance;
      if (away <= kNear) closest[i] = std::min(closest[i], std::pair(away, id));
    }
    if (first[i].second != HS_NO_ID) ++rays_that_hit;
  }
  CHECK(hits.size() > kQueries);
  for (Form form : kFloats) {
    // Their corners, one after another or by indices.
    const Records corners(3, 3,
                          std::vector<double>(triangles.doubles(0),
                                              triangles.doubles(kTriangles)));
    const hs_columns columns = corners.In(form);
    const hs_columns of_rays = rays.In(form);
    Ids indices(3 * kTriangles);
    std::iota(indices.begin(), indices.end(), 0u);
    hs_mesh* mesh = nullptr;
    CHECK_OK(hs_mesh_create(&columns, form == kRows ? nullptr : indices.data(),
                            kTriangles, nullptr, &mesh));
    Ids ids(kQueries);
    std::vector<float> values(kQueries);
    const auto are = [&](const auto& expected) {
      for (std::size_t i = 0; i < kQueries; ++i) {
        if (expected[i] != std::pair(values[i], ids[i])) return false;
      }
      return true;
    };
    CHECK_OK(
        hs_mesh_raycast(mesh, &of_rays, nullptr, ids.data(), values.data()));
    CHECK(are(first));
    std::vector<std::uint8_t> is_hit(kQueries);
    CHECK_OK(hs_mesh_occluded(mesh, &of_rays, nullptr, is_hit.data()));
    for (std::size_t i = 0; i < kQueries; ++i) {
      CHECK((is_hit[i] == 1) == (first[i].second != HS_NO_ID));
    }
    const auto casts = [&](float limit) {
      std::pair<float, decltype(hits)> found(limit, {});
      CHECK_OK(hs_mesh_raycast_each(
          mesh, &of_rays, nullptr,
          [](void* context, std::size_t ray, std::uint32_t id, float) {
            auto& its = *static_cast<decltype(found)*>(context);
            its.second.emplace_back(ray, id);
            return its.first;
          },
          &found));
      return Sorted(found.second);
    };
    CHECK(casts(kInfinity) == hits);
    // A negative limit ends the cast of one ray, and not of the others.
    CHECK(casts(-1).size() == rays_that_hit);
    std::vector<float> on_triangles(3 * kQueries);
    CHECK_OK(hs_mesh_closest_points(mesh, &of_rays, kNear, nullptr, ids.data(),
                                    on_triangles.data(), values.data()));
    CHECK(are(closest));
    for (std::size_t i = 0; i < kQueries; ++i) {
      const bool is_none = closest[i].second == HS_NO_ID;
      CHECK(is_none
                ? std::isnan(on_triangles[3 * i])
                : memcmp(
                      &on_triangles[3 * i],
                      ClosestPoint(as_rays[i].origin, all[ids[i]]).point.data(),
                      3 * sizeof(float)) == 0);
    }
    hs_mesh_destroy(mesh);
  }
}

template <typename View>
void TestKind() {
  for (Form form : kForms) TestScan<View>(0, form);
  TestScan<View>(0, kRows, 1);
  TestScan<View>(8, kRows);
  TestScan<View>(16, kDoubles);
  TestBvh<View>();
  if constexpr (!Kind<View>::kIsSimplex) {
    TestPairEvents<View>();
    TestBroadPhase<View>(false);
    TestBroadPhase<View>(true);
  }
}

}  // namespace
}  // namespace halfspace

extern "C" void test_parity(void) {
  using namespace halfspace;
  TestBuilders<2>();
  TestBuilders<3>();
  TestKind<AabbView2>();
  TestKind<AabbView3>();
  TestKind<AaboView2>();
  TestKind<AaboView3>();
  TestKind<SimplexView2>();
  TestKind<SimplexView3>();
  TestTriangles();
  TestFrustum();
}
