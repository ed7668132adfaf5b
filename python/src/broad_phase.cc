// The broad phase.
#include <algorithm>
#include <array>
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

// Queries of one part. A part whose ids do not fit runs twice.
constexpr std::size_t kInPart = 64;

// The object of Python. Needs no lock of its own: see c/halfspace.h.
struct Bodies {
  std::unique_ptr<hs_broad_phase, Destroy<&hs_broad_phase_destroy>> bodies;
  std::size_t dims;
  hs_kind kind;
  std::size_t values;  // of a record

  hs_broad_phase* get() const { return bodies.get(); }
};

// Calls a C function without the interpreter's lock.
template <typename Function, typename... Arguments>
void Call(Function function, const Arguments&... arguments) {
  const py::gil_scoped_release release;
  Check(function(arguments...));
}

template <typename Value, hs_status (*kFunction)(const hs_broad_phase*, Value*)>
Value Ask(const Bodies& bodies) {
  Value value{};
  Call(kFunction, bodies.get(), &value);
  return value;
}

// The same for a function that runs its parts on threads.
template <auto kFunction, typename... Arguments>
void Update(const Bodies& bodies, std::size_t budget, std::size_t threads,
            Arguments... arguments) {
  Work work(threads, py::none());
  Threads its_threads{work, 1, 0, 0};
  hs_update_options options;
  Check(hs_update_options_default(&options, sizeof(options)));
  options.budget = budget;
  options.run = &Threads::Run;
  options.run_context = &its_threads;
  const py::gil_scoped_release release;
  its_threads.Check(kFunction(bodies.get(), &options, arguments...));
}

// Writes the records of boxes.
void BoundBoxes(hs_kind kind, const hs_columns& boxes, float* records) {
  hs_bound_options options;
  Check(hs_bound_options_default(&options, sizeof(options)));
  options.tightest = 1;
  Check(hs_bound_boxes(kind, &boxes, &options, records, nullptr));
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
Columns BoundsOf(const ShortIds& ids, const py::tuple& arrays) {
  const Columns bounds(arrays);
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
  return std::unique_ptr<Bodies>(new Bodies{
      {bodies, {}}, dims, config.kind, hs_bound_values(config.kind)});
}

void Insert(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays,
            const Masks& masks) {
  const Columns bounds = BoundsOf(ids, arrays);
  const hs_body_masks* const its_masks = MasksIn(masks, bounds.count);
  Call(&hs_broad_phase_insert, bodies.get(), ids.data(), &bounds, its_masks);
}

void Move(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays) {
  const Columns bounds = BoundsOf(ids, arrays);
  Call(&hs_broad_phase_move, bodies.get(), ids.data(), &bounds);
}

void SetMasks(const Bodies& bodies, const ShortIds& ids, const Masks& masks) {
  const hs_body_masks* const its_masks = MasksIn(masks, Length(ids));
  Call(&hs_broad_phase_set_masks, bodies.get(), ids.data(), its_masks,
       its_masks == nullptr ? 0 : Length(ids));
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

// Queries of spheres, or of bounds.
Ids Query(const Bodies& bodies, const py::tuple& arrays, std::uint64_t mask,
          std::size_t threads) {
  const Columns queries(arrays);
  const bool are_spheres = queries.size == bodies.dims + 1;
  Work work(threads, py::none());
  return FindAll(
      queries, kInPart, work,
      FinderOf(bodies, are_spheres ? HS_SHAPE_SPHERE : HS_SHAPE_BOUND, mask));
}

py::object QueryOne(const Bodies& bodies, const py::array& array,
                    std::uint64_t mask) {
  const auto find = FinderOf(bodies, HS_SHAPE_BOUND, mask);
  return FindOfOne(array, bodies.dims,
                   [&](const hs_columns& box, std::span<std::uint32_t> ids,
                       std::size_t* offsets) {
                     if (bodies.kind == HS_BOX2 || bodies.kind == HS_BOX3) {
                       return find(box, ids, offsets);
                     }
                     std::array<float, HS_MAX_COLUMNS> record;
                     BoundBoxes(bodies.kind, box, record.data());
                     return find(hs_float_rows(record.data(), 1, bodies.values),
                                 ids, offsets);
                   });
}

// The first body of each ray, or of each sphere or box that moves. `arrays`
// are the directions and the limits.
py::tuple Cast(const Bodies& bodies, const py::tuple& starts,
               const py::tuple& arrays, std::uint64_t mask,
               std::size_t threads) {
  const Columns from(starts);
  const Columns motions(arrays);
  if (from.count != motions.count) ThrowNotPrepared();
  const hs_shape shape = from.size == bodies.dims       ? HS_SHAPE_POINT
                         : from.size == bodies.dims + 1 ? HS_SHAPE_SPHERE
                                                        : HS_SHAPE_BOX;
  Work work(threads, py::none());
  return FindIdsAndFloats(
      from, 1, kPartQueries, work,
      [&](const hs_columns& some, std::size_t first, std::uint32_t* ids,
          float* ts) {
        const hs_columns its_motions = motions.Rows(first, kPartQueries);
        Check(hs_broad_phase_cast(bodies.get(), shape, &some, &its_motions,
                                  mask, ids, ts));
      });
}

// An array of shape (n, 2).
ShortIds ToArray(const Pairs& pairs) {
  ShortIds ids(std::vector<std::size_t>{pairs.size(), 2});
  std::copy_n(reinterpret_cast<const std::uint32_t*>(pairs.data()),
              2 * pairs.size(), ids.mutable_data());
  return ids;
}

// `masks` has an element for each id, or none.
ShortIds PairsOf(const Bodies& bodies, const ShortIds& ids, float margin,
                 const Masks& masks) {
  if (masks.size() != 0 && masks.size() != ids.size()) ThrowNotPrepared();
  const std::uint64_t* const its_masks =
      masks.size() == 0 ? nullptr : masks.data();
  Pairs pairs;
  const auto add = [](void* to, std::uint32_t a, std::uint32_t b) {
    static_cast<Pairs*>(to)->push_back({a, b});
    return HS_CONTINUE;
  };
  Call(&hs_broad_phase_for_each_pair_of, bodies.get(), ids.data(), its_masks,
       Length(ids), margin, add, &pairs);
  return ToArray(pairs);
}

// Appends to one of several lists.
template <std::size_t kList>
void Add(void* lists, std::uint32_t a, std::uint32_t b) {
  static_cast<Pairs*>(lists)[kList].push_back({a, b});
}

py::tuple UpdatePairs(const Bodies& bodies, std::size_t threads) {
  std::array<Pairs, 2> events;
  Update<&hs_broad_phase_update_pairs>(bodies, 0, threads, &Add<0>, &Add<1>,
                                       events.data());
  return py::make_tuple(ToArray(events[0]), ToArray(events[1]));
}

py::array_t<float> BoundsOfAll(const Bodies& bodies) {
  py::array_t<float> record(Size(bodies.values));
  float* const to = record.mutable_data();
  Call(&hs_broad_phase_bounds, bodies.get(), to);
  return record;
}

// The bounds or, in the second array, rows of a category and what it collides
// with.
py::tuple Get(const Bodies& bodies, const ShortIds& ids, bool with_masks) {
  const std::size_t count = Length(ids);
  py::array_t<float> records(
      std::vector<std::size_t>{with_masks ? 0 : count, bodies.values});
  Masks masks(std::vector<std::size_t>{with_masks ? count : 0, 2});
  auto* const to = reinterpret_cast<hs_body_masks*>(masks.mutable_data());
  Call(&hs_broad_phase_get, bodies.get(), ids.data(), count,
       with_masks ? nullptr : records.mutable_data(),
       with_masks ? to : nullptr);
  return py::make_tuple(records, masks);
}

py::dict Statistics(const Bodies& bodies) {
  hs_body_statistics its;
  Call(&hs_broad_phase_statistics, bodies.get(), &its, sizeof(its));
  using namespace py::literals;
  return py::dict("bodies"_a = its.bodies, "pending"_a = its.pending,
                  "pairs"_a = its.pairs, "trees"_a = its.trees,
                  "bytes"_a = its.bytes, "cost_ratio"_a = its.cost_ratio);
}

// Records of octahedra around boxes.
py::array_t<float> Octahedra(const Bodies& bodies, const py::tuple& arrays) {
  const Columns boxes(arrays);
  py::array_t<float> records(
      std::vector<std::size_t>{boxes.count, bodies.values});
  float* const to = records.mutable_data();
  const py::gil_scoped_release release;
  BoundBoxes(bodies.kind, boxes, to);
  return records;
}

}  // namespace

void DefineBroadPhase(py::module_& module) {
  py::class_<Bodies>(module, "BroadPhase")
      .def(py::init(&MakeBodies))
      .def("insert", &Insert)
      .def("erase",
           [](const Bodies& bodies, const ShortIds& ids) {
             Call(&hs_broad_phase_erase, bodies.get(), ids.data(), Length(ids));
           })
      .def("move", &Move)
      .def("octahedra", &Octahedra)
      .def("set_masks", &SetMasks)
      .def("update", &Update<&hs_broad_phase_update>)
      .def("rebuild", &Update<&hs_broad_phase_rebuild>)
      .def("query", &Query)
      .def("query_one", &QueryOne)
      .def("cast", &Cast)
      .def("pairs_of", &PairsOf)
      .def("update_pairs", &UpdatePairs)
      .def("bounds", &BoundsOfAll)
      .def("get", &Get)
      .def("statistics", &Statistics)
      .def("validate", &Ask<int, &hs_broad_phase_validate>)
      .def("size", &Ask<std::size_t, &hs_broad_phase_size>)
      .def("has", [](const Bodies& bodies, std::uint32_t id) {
        int has = 0;
        Call(&hs_broad_phase_has, bodies.get(), id, &has);
        return has != 0;
      });
}

}  // namespace halfspace::python
