#include "broad_phase.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Of bodies of shape (n, 2): the category and what it collides with.
using Masks = py::array_t<std::uint64_t, py::array::c_style>;
using Pairs = std::vector<hs_id_pair>;

struct DestroyBodies {
  void operator()(hs_broad_phase* bodies) const {
    hs_broad_phase_destroy(bodies);
  }
};

// The object of Python. Needs no lock of its own: see c/halfspace.h.
struct Bodies {
  std::unique_ptr<hs_broad_phase, DestroyBodies> bodies;
  std::size_t dims;
  std::size_t values;  // of a record

  hs_broad_phase* get() const { return bodies.get(); }
};

// Runs a C function without the interpreter's lock.
template <typename Function>
void Call(const Function& function) {
  const py::gil_scoped_release release;
  Check(function());
}

// The same for a function of hs_update_options.
template <typename Function>
void CallWithThreads(std::size_t budget, std::size_t threads,
                     const Function& function) {
  Work work(threads, py::none());
  Threads its_threads(work, 1, 0, 0);
  hs_update_options options;
  Check(hs_update_options_default(&options, sizeof(options)));
  options.budget = budget;
  options.run = &Threads::Run;
  options.run_context = &its_threads;
  const py::gil_scoped_release release;
  its_threads.Check(function(&options));
}

std::size_t Length(const ShortIds& ids) {
  return static_cast<std::size_t>(ids.size());
}

// The masks of `count` bodies, or null if there are no masks.
const hs_body_masks* MasksIn(const Masks& masks, std::size_t count) {
  static_assert(sizeof(hs_body_masks) == 2 * sizeof(std::uint64_t));
  if (masks.ndim() != 2 || masks.shape(1) != 2) ThrowNotPrepared();
  if (masks.shape(0) == 0) return nullptr;
  if (masks.shape(0) != Size(count)) ThrowNotPrepared();
  return reinterpret_cast<const hs_body_masks*>(masks.data());
}

// Bounds for the bodies `ids`.
Columns BoundsIn(const Bodies& bodies, const ShortIds& ids,
                 const py::tuple& arrays) {
  const Columns bounds(arrays);
  bounds.CheckSize(bodies.values);
  if (Size(bounds.count) != ids.size()) ThrowNotPrepared();
  return bounds;
}

std::unique_ptr<Bodies> MakeBodies(std::size_t max_ids, std::size_t dims,
                                   bool is_aabo, float margin) {
  hs_broad_phase_config config;
  Check(hs_broad_phase_config_default(&config, sizeof(config)));
  config.kind = is_aabo ? (dims == 2 ? HS_OCTAHEDRON2 : HS_OCTAHEDRON3)
                        : (dims == 2 ? HS_BOX2 : HS_BOX3);
  config.margin = margin;
  config.max_ids = max_ids;
  hs_broad_phase* bodies = nullptr;
  Check(hs_broad_phase_create(&config, &bodies));
  return std::make_unique<Bodies>(
      Bodies{std::unique_ptr<hs_broad_phase, DestroyBodies>(bodies), dims,
             hs_bound_values(config.kind)});
}

void Insert(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays,
            const Masks& masks) {
  const Columns bounds = BoundsIn(bodies, ids, arrays);
  const hs_body_masks* const its_masks = MasksIn(masks, bounds.count);
  Call([&] {
    return hs_broad_phase_insert(bodies.get(), ids.data(), &bounds, its_masks);
  });
}

void Move(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays) {
  const Columns bounds = BoundsIn(bodies, ids, arrays);
  Call([&] { return hs_broad_phase_move(bodies.get(), ids.data(), &bounds); });
}

void SetMasks(const Bodies& bodies, const ShortIds& ids, const Masks& masks) {
  const hs_body_masks* const its_masks = MasksIn(masks, Length(ids));
  Call([&] {
    return hs_broad_phase_set_masks(bodies.get(), ids.data(), its_masks,
                                    its_masks == nullptr ? 0 : Length(ids));
  });
}

// The function of FindAll() and FindOfOne().
auto FinderOf(const Bodies& bodies, hs_shape shape, std::uint64_t mask) {
  return [&bodies, shape, mask](const hs_columns& queries,
                                std::span<std::uint32_t> ids,
                                std::size_t* offsets) {
    std::size_t total = 0;
    Check(hs_broad_phase_query(bodies.get(), shape, &queries, mask, ids.data(),
                               ids.size(), offsets, &total));
    return total;
  };
}

// Queries of spheres, or of bounds. Returns the rows and the ids, of shape
// (2, n), or only the ids.
Ids Query(const Bodies& bodies, const py::tuple& arrays, std::uint64_t mask,
          bool with_rows, std::size_t threads) {
  const Columns queries(arrays);
  const bool are_spheres = queries.size == bodies.dims + 1;
  if (!are_spheres) queries.CheckSize(bodies.values);
  Work work(threads, py::none());
  return FindAll(
      queries, kPartQueries, with_rows, work,
      FinderOf(bodies, are_spheres ? HS_SHAPE_SPHERE : HS_SHAPE_BOUND, mask));
}

py::object QueryOne(const Bodies& bodies, const py::array& array,
                    std::uint64_t mask) {
  if (bodies.values != 2 * bodies.dims) return py::none();
  return FindOfOne(array, bodies.dims, FinderOf(bodies, HS_SHAPE_BOUND, mask));
}

// The first body of each ray, or of each sphere or box that moves.
py::tuple Cast(const Bodies& bodies, const py::tuple& start_arrays,
               const py::array& motion_array, std::uint64_t mask,
               std::size_t threads) {
  const Columns starts(start_arrays);
  const Columns motions(py::make_tuple(motion_array));
  const std::size_t dims = bodies.dims;
  motions.CheckSize(dims + 1);
  if (starts.count != motions.count) ThrowNotPrepared();
  const hs_shape shape = starts.size == dims       ? HS_SHAPE_POINT
                         : starts.size == dims + 1 ? HS_SHAPE_SPHERE
                                                   : HS_SHAPE_BOX;
  if (shape == HS_SHAPE_BOX) starts.CheckSize(2 * dims);
  Work work(threads, py::none());
  return CastAll(starts.count, work,
                 [&](std::size_t first, std::uint32_t* ids, float* ts) {
                   const hs_columns from = starts.Rows(first, kPartQueries);
                   const hs_columns by = motions.Rows(first, kPartQueries);
                   Check(hs_broad_phase_cast(bodies.get(), shape, &from, &by,
                                             mask, ids, ts));
                 });
}

// An array of shape (n, 2).
Ids ToArray(const Pairs& pairs) {
  Ids ids(std::vector<std::size_t>{pairs.size(), 2});
  std::int64_t* to = ids.mutable_data();
  for (const hs_id_pair& pair : pairs) {
    *to++ = pair.a;
    *to++ = pair.b;
  }
  return ids;
}

// `masks` has an element for each id, or none.
Ids PairsOf(const Bodies& bodies, const ShortIds& ids, float margin,
            const Masks& masks) {
  if (masks.size() != 0 && masks.size() != ids.size()) ThrowNotPrepared();
  const std::uint64_t* const its_masks =
      masks.size() == 0 ? nullptr : masks.data();
  Pairs pairs;
  const auto add = [](void* to, std::uint32_t a, std::uint32_t b) {
    static_cast<Pairs*>(to)->push_back({a, b});
    return HS_CONTINUE;
  };
  Call([&] {
    return hs_broad_phase_for_each_pair_of(bodies.get(), ids.data(), its_masks,
                                           Length(ids), margin, add, &pairs);
  });
  return ToArray(pairs);
}

py::tuple UpdatePairs(const Bodies& bodies, std::size_t threads) {
  std::array<Pairs, 2> events;
  CallWithThreads(0, threads, [&](const hs_update_options* options) {
    return hs_broad_phase_update_pairs(
        bodies.get(), options,
        [](void* to, std::uint32_t a, std::uint32_t b) {
          static_cast<Pairs*>(to)[0].push_back({a, b});
        },
        [](void* to, std::uint32_t a, std::uint32_t b) {
          static_cast<Pairs*>(to)[1].push_back({a, b});
        },
        events.data());
  });
  return py::make_tuple(ToArray(events[0]), ToArray(events[1]));
}

py::array_t<float> BoundsOf(const Bodies& bodies) {
  py::array_t<float> record(Size(bodies.values));
  float* const to = record.mutable_data();
  Call([&] { return hs_broad_phase_bounds(bodies.get(), to); });
  return record;
}

py::array_t<float> Get(const Bodies& bodies, const ShortIds& ids) {
  py::array_t<float> records(
      std::vector<std::size_t>{Length(ids), bodies.values});
  float* const to = records.mutable_data();
  Call([&] {
    return hs_broad_phase_get(bodies.get(), ids.data(), Length(ids), to,
                              nullptr);
  });
  return records;
}

Masks MasksOf(const Bodies& bodies, const ShortIds& ids) {
  Masks masks(std::vector<std::size_t>{Length(ids), 2});
  auto* const to = reinterpret_cast<hs_body_masks*>(masks.mutable_data());
  Call([&] {
    return hs_broad_phase_get(bodies.get(), ids.data(), Length(ids), nullptr,
                              to);
  });
  return masks;
}

py::dict Statistics(const Bodies& bodies) {
  hs_body_statistics its;
  Call([&] {
    return hs_broad_phase_statistics(bodies.get(), &its, sizeof(its));
  });
  py::dict statistics;
  statistics["bodies"] = its.bodies;
  statistics["pending"] = its.pending;
  statistics["pairs"] = its.pairs;
  statistics["trees"] = its.trees;
  statistics["bytes"] = its.bytes;
  statistics["cost_ratio"] = its.cost_ratio;
  return statistics;
}

// Records of octahedra around boxes.
py::array_t<float> OctahedraOf(const py::tuple& arrays) {
  const Columns boxes(arrays);
  if (boxes.size != 4 && boxes.size != 6) ThrowNotPrepared();
  const hs_kind kind = boxes.size == 4 ? HS_OCTAHEDRON2 : HS_OCTAHEDRON3;
  hs_bound_options options;
  Check(hs_bound_options_default(&options, sizeof(options)));
  options.tightest = 1;
  py::array_t<float> records(
      std::vector<std::size_t>{boxes.count, hs_bound_values(kind)});
  float* const to = records.mutable_data();
  Call([&] { return hs_bound_boxes(kind, &boxes, &options, to, nullptr); });
  return records;
}

}  // namespace

void DefineBroadPhase(py::module_& module) {
  module.def("octahedra", &OctahedraOf);
  py::class_<Bodies>(module, "BroadPhase")
      .def(py::init(&MakeBodies))
      .def("insert", &Insert)
      .def("erase",
           [](const Bodies& bodies, const ShortIds& ids) {
             Call([&] {
               return hs_broad_phase_erase(bodies.get(), ids.data(),
                                           Length(ids));
             });
           })
      .def("move", &Move)
      .def("set_masks", &SetMasks)
      .def("update",
           [](const Bodies& bodies, std::size_t budget, std::size_t threads) {
             CallWithThreads(budget, threads, [&](const auto* options) {
               return hs_broad_phase_update(bodies.get(), options);
             });
           })
      .def("rebuild",
           [](const Bodies& bodies, std::size_t threads) {
             CallWithThreads(0, threads, [&](const auto* options) {
               return hs_broad_phase_rebuild(bodies.get(), options);
             });
           })
      .def("query", &Query)
      .def("query_one", &QueryOne)
      .def("cast", &Cast)
      .def("pairs_of", &PairsOf)
      .def("update_pairs", &UpdatePairs)
      .def("bounds", &BoundsOf)
      .def("get", &Get)
      .def("masks", &MasksOf)
      .def("statistics", &Statistics)
      .def("validate",
           [](const Bodies& bodies) {
             int is_valid = 0;
             Call([&] {
               return hs_broad_phase_validate(bodies.get(), &is_valid);
             });
             return is_valid != 0;
           })
      .def("size",
           [](const Bodies& bodies) {
             std::size_t size = 0;
             Call([&] { return hs_broad_phase_size(bodies.get(), &size); });
             return size;
           })
      .def("has", [](const Bodies& bodies, std::uint32_t id) {
        int has = 0;
        Call([&] { return hs_broad_phase_has(bodies.get(), id, &has); });
        return has != 0;
      });
}

}  // namespace halfspace::python
