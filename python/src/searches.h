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

// A World has these functions of C as World::Functions. Of two, the second
// calls a function for each hit. It also has
// - get(), which is their object, and dims
// - Reading, which exists while a call reads the object
// - kPart, the number of queries in one part
// - QueryOf(box, record), which returns a box as a query, in `record` or not
// - is_exact and kCanBeExact. If the second is true, also
//   Keep(queries, ids, offsets) and KeepPairs(margin, pairs). They remove the
//   results that the doubles reject. Keep() returns how many are left.
#define HALFSPACE_PYTHON_FUNCTIONS(Name, world)                            \
  struct Name {                                                            \
    static constexpr auto kSize = &hs_##world##_size;                      \
    static constexpr auto kQuery = &hs_##world##_query;                    \
    static constexpr auto kCount = &hs_##world##_count;                    \
    static constexpr auto kAny = &hs_##world##_any;                        \
    static constexpr auto kToPoints = &hs_##world##_nearest_to_points;     \
    static constexpr auto kToBoxes = &hs_##world##_nearest_to_boxes;       \
    static constexpr std::pair kRaycast{&hs_##world##_raycast,             \
                                        &hs_##world##_raycast_each};       \
    static constexpr std::pair kBoxcast{&hs_##world##_boxcast,             \
                                        &hs_##world##_boxcast_each};       \
    static constexpr std::pair kSpherecast{&hs_##world##_spherecast,       \
                                           &hs_##world##_spherecast_each}; \
    static constexpr auto kPairsOf = &hs_##world##_pairs_of_each;          \
  }
HALFSPACE_PYTHON_FUNCTIONS(BvhFunctions, bvh);
HALFSPACE_PYTHON_FUNCTIONS(BroadPhaseFunctions, broad_phase);
#undef HALFSPACE_PYTHON_FUNCTIONS

template <typename World>
struct Searches {
  using Its = typename World::Functions;
  using Reading = typename World::Reading;

  static hs_query_options OptionsOf(std::uint32_t mask) {
    hs_query_options options = DefaultOf(&hs_query_options_default);
    options.mask = mask;
    return options;
  }

  // A call, and its queries, sorted if that makes them faster: in a tree that
  // is larger than the cache. The sort takes 34 ns (floats in 2 dimensions) to
  // 56 ns (doubles in 3) a query. A query of boxes in 2 dimensions reads less,
  // so the sort pays only in larger trees.
  struct Search {
    Search(World& world, const pybind11::tuple& arrays,
           const pybind11::tuple& how, bool are_boxes = false)
        : options(OptionsOf(MaskOf(how))),
          work(WorkOf(how)),
          reading(world),
          queries(arrays) {
      if (!CanSort(queries)) return;
      const pybind11::gil_scoped_release release;
      std::size_t size = 0;
      Check(Its::kSize(world.get(), &size));
      const bool is_large =
          size >= (are_boxes && world.dims == 2 ? 5 : 1) * kLargeTree;
      // A function of C says which columns are missing.
      if (is_large && queries.size >= world.dims) {
        queries.order = OrderByPlace(queries, world.dims, work);
      }
    }

    hs_query_options options;
    Work work;
    Reading reading;
    Columns queries;
  };

  // find() of FindAll().
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
    Search its(world, arrays, how, /*are_boxes=*/true);
    if (its.queries.size == world.dims + 1) {
      its.options.shape = HS_SHAPE_SPHERE;
    }
    if (its.queries.size == 2 * world.dims + 1) {
      its.options.shape = HS_SHAPE_ROUNDED_BOX;
    }
    return FindAll(its.queries, World::kPart, its.work,
                   FinderIn(world, its.options));
  }

  // The same of the box of a plain array, in a third of the time: most of a
  // short query is the way through Python. None if the array is anything else.
  static pybind11::object QueryOne(World& world, const pybind11::array& array,
                                   std::uint32_t mask, bool is_sorted) {
    const hs_columns box = BoxIn(array, world.dims);
    if (box.count == 0) return pybind11::none();
    const Reading reading(world);
    const auto find = FinderIn(world, OptionsOf(mask));
    std::array<std::uint32_t, 256> few;
    std::vector<std::uint32_t> many;
    std::span<std::uint32_t> found = few;
    std::size_t count = 0;
    {
      const pybind11::gil_scoped_release release;
      std::array<float, HS_MAX_COLUMNS> record;
      const hs_columns query = world.QueryOf(box, record.data());
      while ((count = find(query, found, nullptr)) > found.size()) {
        many.resize(count);
        found = many;
      }
    }
    if (is_sorted) std::sort(found.begin(), found.begin() + Size(count));
    // Less work than a constructor of py::array.
    const auto& numpy = pybind11::detail::npy_api::get();
    auto size = static_cast<Py_intptr_t>(count);
    auto ids = pybind11::reinterpret_steal<Ids>(numpy.PyArray_NewFromDescr_(
        numpy.PyArray_Type_,
        pybind11::dtype::of<std::int64_t>().release().ptr(), 1, &size, nullptr,
        nullptr, 0, nullptr));
    if (!ids) throw pybind11::error_already_set();
    std::copy_n(found.data(), count, ids.mutable_data());
    return ids;
  }

  // The numbers of objects, or an id or -1 for each query.
  template <auto kFunction, typename Value>
  static pybind11::array Ask(World& world, const pybind11::tuple& arrays,
                             const pybind11::tuple& how) {
    Search its(world, arrays, how, /*are_boxes=*/true);
    return FindEach<Value>(
        its.queries, kPartQueries, its.work,
        [&](const hs_columns& some, Value* values) {
          Check(kFunction(world.get(), &some, &its.options, values));
        });
  }
  static pybind11::array Count(World& world, const pybind11::tuple& arrays,
                               const pybind11::tuple& how) {
    if (!world.is_exact) {
      return Ask<Its::kCount, std::size_t>(world, arrays, how);
    }
    Search its(world, arrays, how, /*are_boxes=*/true);
    const auto find = FinderIn(world, its.options);
    return FindEach<std::size_t>(
        its.queries, kPartQueries, its.work,
        [&](const hs_columns& some, std::size_t* counts) {
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
    return pybind11::int_(ResultOf(value));
  }

  static pybind11::tuple Nearest(World& world, const pybind11::tuple& arrays,
                                 std::size_t k, float max_distance,
                                 bool is_exclusive, bool with_ties,
                                 const pybind11::tuple& how) {
    Search its(world, arrays, how);
    its.options.exclusive = is_exclusive ? 1 : 0;
    {
      const pybind11::gil_scoped_release release;
      std::size_t size = 0;
      Check(Its::kSize(world.get(), &size));
      k = std::clamp(size, std::size_t{1}, k);
    }
    const auto function =
        its.queries.size == world.dims ? Its::kToPoints : Its::kToBoxes;
    const auto search = [&](const hs_columns& some, std::size_t room,
                            std::uint32_t* ids, float* distances) {
      Check(function(world.get(), &some, room, max_distance, &its.options, ids,
                     distances));
    };
    // As many queries in a part as have about this number of results.
    constexpr std::size_t kPartResults = 4096;
    const std::size_t in_part =
        std::clamp(kPartResults / k, std::size_t{1}, kPartQueries);
    if (!with_ties) {
      return FindIdsAndFloats(
          its.queries, k, in_part, its.work,
          [&](const QueryPart& part, std::uint32_t* ids, float* distances) {
            search(part.queries, k, ids, distances);
          });
    }
    return FindLists(
        its.queries, in_part, its.work,
        [&](const QueryPart& part, std::vector<Found>& list,
            std::size_t* ends) {
          // One more object shows whether there are ties.
          std::vector<std::uint32_t> ids(part.queries.count * (k + 1));
          std::vector<float> distances(ids.size());
          search(part.queries, k + 1, ids.data(), distances.data());
          for (std::size_t i = 0; i < part.queries.count; ++i) {
            AddWithTies(k, &ids[i * (k + 1)], &distances[i * (k + 1)],
                        its.queries.Rows(its.queries.RowAt(part.first + i), 1),
                        search, list);
            ends[i] = list.size();
          }
        });
  }

  // Rays, or spheres or boxes that move. `its_ways` are the directions and the
  // limits. Rays have them too.
  static pybind11::tuple Cast(World& world, const pybind11::tuple& starts,
                              const pybind11::tuple& its_ways, bool finds_all,
                              const pybind11::tuple& how) {
    Search its(world, starts, how);
    Columns ways(its_ways);
    if (its.queries.count != ways.count) ThrowNotPrepared();
    const bool are_rays = its.queries.size == 2 * world.dims + 1;
    if (!are_rays) ways.order = its.queries.order;
    const auto& functions =
        its.queries.size == 2 * world.dims ? Its::kBoxcast : Its::kSpherecast;
    return FindHits(
        its.queries, finds_all, its.work,
        [&](const QueryPart& part, auto to, auto of) {
          constexpr bool kAll = kFindsAll<decltype(of)>;
          std::vector<std::byte> copy;
          const hs_columns some = ways.Part(part.first, kPartQueries, copy);
          Check(are_rays
                    ? std::get<kAll>(Its::kRaycast)(world.get(), &part.queries,
                                                    0, &its.options, to, of)
                    : std::get<kAll>(functions)(world.get(), &part.queries,
                                                &some, &its.options, to, of));
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
      Check(Its::kPairsOf(world.get(), ids.data(), Length(ids), &options, add,
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
        .def("any", &Ask<Its::kAny, std::uint32_t>)
        .def("any_one", &AskOne<Its::kAny, std::uint32_t>)
        .def("nearest", &Nearest)
        .def("cast", &Cast)
        .def("pairs_of", &PairsOf)
        .def_property_readonly(
            "is_exact", [](const World& world) { return world.is_exact; })
        .def_readonly("dims", &World::dims);
  }

 private:
  // Appends the k objects of a row of k + 1, and those as far as the last of
  // them. Searches for more and more until one is farther.
  template <typename Find>
  static void AddWithTies(std::size_t k, const std::uint32_t* ids,
                          const float* distances, const hs_columns& query,
                          const Find& search, std::vector<Found>& list) {
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
      list.push_back({distances[i], ids[i]});
    }
  }
};

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_SEARCHES_H_
