// The searches that trees and broad phases share, as methods of their classes.
#ifndef HALFSPACE_PYTHON_SEARCHES_H_
#define HALFSPACE_PYTHON_SEARCHES_H_

#include <halfspace/c/halfspace.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace halfspace::python {

// A World has these functions of C as World::Functions, and
// - get(), which is their object, and dims
// - Reading, which exists while a call reads the object
// - kPart, the number of queries in one part
// - QueryOf(box, record), which returns a box as a query, in `record` or not
// - is_exact and kCanBeExact. If the second is true, also
//   Keep(queries, ids, offsets) and KeepPairs(margin, pairs). They remove the
//   results that the doubles reject. Keep() returns how many are left.
struct BvhFunctions {
  static constexpr auto kSize = &hs_bvh_size;
  static constexpr auto kQuery = &hs_bvh_query;
  static constexpr auto kCount = &hs_bvh_count;
  static constexpr auto kAny = &hs_bvh_any;
  static constexpr auto kNearestToPoints = &hs_bvh_nearest_to_points;
  static constexpr auto kNearestToBoxes = &hs_bvh_nearest_to_boxes;
  static constexpr auto kRaycast = &hs_bvh_raycast;
  static constexpr auto kBoxcast = &hs_bvh_boxcast;
  static constexpr auto kSpherecast = &hs_bvh_spherecast;
  static constexpr auto kEachRaycast = &hs_bvh_raycast_each;
  static constexpr auto kEachBoxcast = &hs_bvh_boxcast_each;
  static constexpr auto kEachSpherecast = &hs_bvh_spherecast_each;
  static constexpr auto kPairsOf = &hs_bvh_pairs_of_each;
};
struct BroadPhaseFunctions {
  static constexpr auto kSize = &hs_broad_phase_size;
  static constexpr auto kQuery = &hs_broad_phase_query;
  static constexpr auto kCount = &hs_broad_phase_count;
  static constexpr auto kAny = &hs_broad_phase_any;
  static constexpr auto kNearestToPoints = &hs_broad_phase_nearest_to_points;
  static constexpr auto kNearestToBoxes = &hs_broad_phase_nearest_to_boxes;
  static constexpr auto kRaycast = &hs_broad_phase_raycast;
  static constexpr auto kBoxcast = &hs_broad_phase_boxcast;
  static constexpr auto kSpherecast = &hs_broad_phase_spherecast;
  static constexpr auto kEachRaycast = &hs_broad_phase_raycast_each;
  static constexpr auto kEachBoxcast = &hs_broad_phase_boxcast_each;
  static constexpr auto kEachSpherecast = &hs_broad_phase_spherecast_each;
  static constexpr auto kPairsOf = &hs_broad_phase_pairs_of_each;
};

template <typename World>
struct Searches {
  using Its = typename World::Functions;
  using Reading = typename World::Reading;

  static hs_query_options OptionsOf(std::uint32_t mask) {
    hs_query_options options = DefaultOf(&hs_query_options_default);
    options.mask = mask;
    return options;
  }

  // The queries, sorted if that makes them faster. The sort takes 30 ns a
  // query. 10^5 sorted queries then take 0.4 to 0.8 of the time in a tree that
  // is larger than the cache (10^5 to 5 * 10^6 objects, two builds in turns).
  static constexpr std::size_t kLargeTree = 200'000;
  static Columns QueriesIn(const World& world, const pybind11::tuple& arrays,
                           Work& work, std::size_t large = kLargeTree) {
    constexpr std::size_t kFewQueries = 8192;
    Columns queries(arrays);
    if (queries.count < kFewQueries || queries.count > HS_NO_ID) return queries;
    const pybind11::gil_scoped_release release;
    std::size_t size = 0;
    Check(Its::kSize(world.get(), &size));
    // A function of C says which columns are missing.
    if (size >= large && queries.size >= world.dims) {
      queries.SortByPlace(world.dims, work);
    }
    return queries;
  }
  // A query of boxes in 2 dimensions reads less, so the sort pays only in
  // larger trees.
  static Columns BoxesIn(const World& world, const pybind11::tuple& arrays,
                         Work& work) {
    return QueriesIn(world, arrays, work,
                     (world.dims == 2 ? 5 : 1) * kLargeTree);
  }

  // find() of FindAll() and FindOfOne().
  static auto FinderIn(const World& world, const hs_query_options& options) {
    return
        [&world, options](const hs_columns& queries,
                          std::span<std::uint32_t> ids, std::size_t* offsets) {
          std::size_t total = 0;
          Check(Its::kQuery(world.get(), &queries, &options, ids.data(),
                            ids.size(), offsets, &total));
          if constexpr (World::kCanBeExact) {
            if (world.is_exact && options.shape == HS_SHAPE_BOUND &&
                total <= ids.size()) {
              return world.Keep(queries, ids.first(total), offsets);
            }
          }
          return total;
        };
  }

  // Queries of bounds, of spheres, or of boxes with a distance.
  static Ids Query(World& world, const pybind11::tuple& arrays,
                   const pybind11::tuple& how) {
    Work work = WorkOf(how);
    const Reading reading(world);
    const Columns queries = BoxesIn(world, arrays, work);
    hs_query_options options = OptionsOf(MaskOf(how));
    if (queries.size == world.dims + 1) options.shape = HS_SHAPE_SPHERE;
    if (queries.size == 2 * world.dims + 1) {
      options.shape = HS_SHAPE_ROUNDED_BOX;
    }
    Ids ids = FindAll(queries, World::kPart, work, FinderIn(world, options));
    work.Finish();
    return ids;
  }

  static pybind11::object QueryOne(World& world, const pybind11::array& array,
                                   std::uint32_t mask) {
    const Reading reading(world);
    const auto find = FinderIn(world, OptionsOf(mask));
    return FindOfOne(array, world.dims,
                     [&](const hs_columns& box, std::span<std::uint32_t> ids,
                         std::size_t* offsets) {
                       std::array<float, HS_MAX_COLUMNS> record;
                       return find(world.QueryOf(box, record.data()), ids,
                                   offsets);
                     });
  }

  // The numbers of objects, or by floats an id or HS_NO_ID for each.
  template <auto kFunction>
  static pybind11::array Ask(World& world, const pybind11::tuple& arrays,
                             const pybind11::tuple& how) {
    const hs_query_options options = OptionsOf(MaskOf(how));
    Work work = WorkOf(how);
    const Reading reading(world);
    const Columns queries = BoxesIn(world, arrays, work);
    return AskEach(world.get(), kFunction, queries, kPartQueries, work,
                   &options);
  }
  static pybind11::array Count(World& world, const pybind11::tuple& arrays,
                               const pybind11::tuple& how) {
    if (!world.is_exact) return Ask<Its::kCount>(world, arrays, how);
    Work work = WorkOf(how);
    const Reading reading(world);
    const Columns queries = BoxesIn(world, arrays, work);
    const auto find = FinderIn(world, OptionsOf(MaskOf(how)));
    return FindEach<std::size_t>(
        queries, 1, kPartQueries, work,
        [&](const hs_columns& some, std::size_t, std::size_t* counts) {
          std::vector<std::uint32_t> ids(64 * some.count);
          std::array<std::size_t, kPartQueries + 1> offsets;
          for (std::size_t total = 0;
               (total = find(some, ids, offsets.data())) > ids.size();) {
            ids.resize(total);
          }
          for (std::size_t i = 0; i < some.count; ++i) {
            counts[i] = offsets[i + 1] - offsets[i];
          }
        });
  }

  // The same of the box of a plain array, as QueryOne().
  template <auto kFunction, typename Value>
  static pybind11::object AskOne(World& world, const pybind11::array& array,
                                 std::uint32_t mask) {
    const hs_columns box = BoxIn(array, world.dims);
    if (box.count == 0 || world.is_exact) return pybind11::none();
    const hs_query_options options = OptionsOf(mask);
    Value value = 0;
    const Reading reading(world);
    {
      const pybind11::gil_scoped_release release;
      std::array<float, HS_MAX_COLUMNS> record;
      const hs_columns query = world.QueryOf(box, record.data());
      Check(kFunction(world.get(), &query, &options, &value));
    }
    return pybind11::int_(value);
  }

  static pybind11::tuple Nearest(World& world, const pybind11::tuple& arrays,
                                 std::size_t k, float max_distance,
                                 bool is_exclusive, bool with_ties,
                                 const pybind11::tuple& how) {
    hs_query_options options = OptionsOf(MaskOf(how));
    options.exclusive = is_exclusive ? 1 : 0;
    Work work = WorkOf(how);
    const Reading reading(world);
    const Columns queries = QueriesIn(world, arrays, work);
    const auto search = [&](const hs_columns& some, std::size_t room,
                            std::uint32_t* ids, float* distances) {
      const bool are_points = queries.size == world.dims;
      const auto function =
          are_points ? Its::kNearestToPoints : Its::kNearestToBoxes;
      Check(function(world.get(), &some, room, max_distance, &options, ids,
                     distances));
    };
    // As many queries in a part as have about this number of results.
    constexpr std::size_t kPartResults = 4096;
    const std::size_t in_part =
        std::clamp(kPartResults / k, std::size_t{1}, kPartQueries);
    if (!with_ties) {
      return FindIdsAndFloats(
          queries, k, in_part, work,
          [&](const hs_columns& some, std::size_t, std::uint32_t* ids,
              float* distances) { search(some, k, ids, distances); });
    }
    return FindLists(queries, in_part, work,
                     [&](const hs_columns& some, std::size_t first,
                         std::vector<Found>& list, std::size_t* ends) {
                       // One more object shows whether there are ties.
                       std::vector<std::uint32_t> ids(some.count * (k + 1));
                       std::vector<float> distances(ids.size());
                       search(some, k + 1, ids.data(), distances.data());
                       for (std::size_t i = 0; i < some.count; ++i) {
                         AddWithTies(k, &ids[i * (k + 1)],
                                     &distances[i * (k + 1)],
                                     queries.Rows(queries.RowAt(first + i), 1),
                                     search, list);
                         ends[i] = list.size();
                       }
                     });
  }

  // The first hits or, sorted by t, all hits of rays, or of spheres or boxes
  // that move. `ways` are the directions and the limits. Rays have them too.
  static pybind11::tuple Cast(World& world, const pybind11::tuple& its_starts,
                              const pybind11::tuple& its_ways, bool finds_all,
                              const pybind11::tuple& how) {
    Work work = WorkOf(how);
    const Reading reading(world);
    const Columns starts = QueriesIn(world, its_starts, work);
    Columns ways(its_ways);
    if (starts.count != ways.count) ThrowNotPrepared();
    const hs_query_options options = OptionsOf(MaskOf(how));
    const bool are_rays = starts.size == 2 * world.dims + 1;
    if (!are_rays) ways.order = starts.order;
    const bool are_boxes = starts.size == 2 * world.dims;
    // The function of C for the starts from `first` on.
    const auto cast = [&](const hs_columns& some, std::size_t first,
                          auto of_rays, auto of_boxes, auto of_spheres,
                          auto... outputs) {
      std::vector<std::byte> copy;
      const hs_columns some_ways = ways.Part(first, kPartQueries, copy);
      Check(are_rays
                ? of_rays(world.get(), &some, 0, &options, outputs...)
                : (are_boxes ? of_boxes : of_spheres)(
                      world.get(), &some, &some_ways, &options, outputs...));
    };
    if (!finds_all) {
      return FindIdsAndFloats(starts, 1, kPartQueries, work,
                              [&](const hs_columns& some, std::size_t first,
                                  std::uint32_t* ids, float* ts) {
                                cast(some, first, Its::kRaycast, Its::kBoxcast,
                                     Its::kSpherecast, ids, ts);
                              });
    }
    return FindHits(starts, work,
                    [&](const hs_columns& some, std::size_t first,
                        hs_hit_function function, void* context) {
                      cast(some, first, Its::kEachRaycast, Its::kEachBoxcast,
                           Its::kEachSpherecast, function, context);
                    });
  }

  // All hits of each cast, sorted by t. each(some, first, function, context)
  // calls a function for those of the casts from `first` on.
  template <typename Each>
  static pybind11::tuple FindHits(const Columns& starts, Work& work,
                                  const Each& each) {
    return FindLists(starts, kPartQueries, work,
                     [&](const hs_columns& some, std::size_t first,
                         std::vector<Found>& list, std::size_t* ends) {
                       Hits hits{&list, ends};
                       each(some, first, &Hits::Add, &hits);
                       for (std::size_t i = 0, begin = 0; i < some.count; ++i) {
                         ends[i] = std::max(begin, ends[i]);
                         std::sort(list.data() + begin, list.data() + ends[i],
                                   [](const Found& a, const Found& b) {
                                     return std::pair(a.value, a.id) <
                                            std::pair(b.value, b.id);
                                   });
                         begin = ends[i];
                       }
                     });
  }

  // `wanted` has an element for each id, or none. The pairs are rows.
  static Ids PairsOf(World& world, const ShortIds& ids, float margin,
                     std::uint32_t mask, const ShortIds& wanted) {
    if (wanted.size() != 0 && wanted.size() != ids.size()) ThrowNotPrepared();
    hs_pair_options options = DefaultOf(&hs_pair_options_default);
    options.margin = margin;
    options.mask = mask;
    if (wanted.size() != 0) options.wanted = wanted.data();
    std::vector<hs_id_pair> pairs;
    const auto add = [](void* to, const hs_id_pair* some, std::size_t count) {
      auto& its = *static_cast<std::vector<hs_id_pair>*>(to);
      its.insert(its.end(), some, some + count);
      return HS_CONTINUE;
    };
    const Reading reading(world);
    {
      const pybind11::gil_scoped_release release;
      Check(Its::kPairsOf(world.get(), ids.data(),
                          static_cast<std::size_t>(ids.size()), &options, add,
                          &pairs));
      if constexpr (World::kCanBeExact) world.KeepPairs(margin, pairs);
    }
    return ToArray(pairs);
  }

  static void Define(pybind11::class_<World>& of) {
    of.def("query", &Query)
        .def("query_one", &QueryOne)
        .def("count", &Count)
        .def("count_one", &AskOne<Its::kCount, std::size_t>)
        .def("any", &Ask<Its::kAny>)
        .def("any_one", &AskOne<Its::kAny, std::uint32_t>)
        .def("nearest", &Nearest)
        .def("cast", &Cast)
        .def("pairs_of", &PairsOf)
        .def_property_readonly(
            "is_exact", [](const World& world) { return world.is_exact; })
        .def_readonly("dims", &World::dims);
  }

 private:
  struct Hits {
    std::vector<Found>* list;
    std::size_t* ends;

    static float Add(void* hits, std::size_t cast, std::uint32_t id, float t) {
      const auto& its = *static_cast<Hits*>(hits);
      its.list->push_back({id, t});
      its.ends[cast] = its.list->size();
      return INFINITY;
    }
  };

  // Appends the k objects of a row of k + 1, and those as far as the last of
  // them. Searches for more and more until one is farther.
  template <typename Search>
  static void AddWithTies(std::size_t k, const std::uint32_t* ids,
                          const float* distances, const hs_columns& query,
                          const Search& search, std::vector<Found>& list) {
    std::vector<std::uint32_t> more_ids;
    std::vector<float> more_distances;
    std::size_t room = k + 1;
    while (ids[room - 1] != HS_NO_ID &&
           distances[room - 1] == distances[k - 1]) {
      room *= 8;
      more_ids.resize(room);
      more_distances.resize(room);
      search(query, room, more_ids.data(), more_distances.data());
      ids = more_ids.data();
      distances = more_distances.data();
    }
    for (std::size_t i = 0;
         i < room && ids[i] != HS_NO_ID && distances[i] <= distances[k - 1];
         ++i) {
      list.push_back({ids[i], distances[i]});
    }
  }
};

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_SEARCHES_H_
