// The broad phase.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "searches.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Of bodies of shape (n, 2): the category and what it collides with.
using Masks = ShortIds;
using Pairs = std::vector<hs_id_pair>;

// Writes the records of boxes.
void BoundBoxes(hs_kind kind, const hs_columns& boxes, float* records) {
  Check(hs_bound_boxes(kind, &boxes, nullptr, records, nullptr));
}

// The object of Python. It has the lock of the broad phase, and one for the
// pairs of the last update, which are the memory of the broad phase.
struct Bodies {
  std::unique_ptr<hs_broad_phase, Destroy<&hs_broad_phase_destroy>> bodies;
  std::size_t dims;
  hs_kind kind;
  std::size_t values;  // of a record
  std::mutex pairs;

  using Functions = BroadPhaseFunctions;
  struct Reading {
    explicit Reading(const Bodies& /*unused*/) {}
  };
  // A part whose ids do not fit runs twice.
  static constexpr std::size_t kPart = 64;
  static constexpr bool kCanBeExact = false;
  static constexpr bool is_exact = false;

  hs_broad_phase* get() const { return bodies.get(); }
  hs_columns QueryOf(const hs_columns& box, float* record) const {
    if (kind == HS_BOX2 || kind == HS_BOX3) return box;
    BoundBoxes(kind, box, record);
    return hs_float_rows(record, 1, values);
  }
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
template <auto kFunction>
void Update(const Bodies& bodies, std::size_t budget, std::size_t threads) {
  Work work(threads, py::none());
  Threads its_threads{work, 1, 0, 0};
  hs_update_options options = DefaultOf(&hs_update_options_default);
  options.budget = budget;
  options.run = &Threads::Run;
  options.run_context = &its_threads;
  const py::gil_scoped_release release;
  its_threads.Check(kFunction(bodies.get(), &options));
}

// The masks of `count` bodies.
const hs_body_masks* MasksIn(const Masks& masks, std::size_t count) {
  static_assert(sizeof(hs_body_masks) == 2 * sizeof(std::uint32_t));
  if (masks.ndim() != 2 || masks.shape(0) != Size(count) ||
      masks.shape(1) != 2) {
    ThrowNotPrepared();
  }
  return reinterpret_cast<const hs_body_masks*>(masks.data());
}

// Bounds for the bodies `ids`.
Columns BoundsOf(const ShortIds& ids, const py::tuple& arrays) {
  Columns bounds(arrays);
  if (Size(bounds.count) != ids.size()) ThrowNotPrepared();
  return bounds;
}

std::unique_ptr<Bodies> MakeBodies(std::size_t dims, bool is_aabo,
                                   bool moves_are_seen_at_once) {
  hs_broad_phase_config config = DefaultOf(&hs_broad_phase_config_default);
  config.kind = is_aabo ? (dims == 2 ? HS_OCTAHEDRON2 : HS_OCTAHEDRON3)
                        : (dims == 2 ? HS_BOX2 : HS_BOX3);
  config.moves_are_seen_at_once = moves_are_seen_at_once ? 1 : 0;
  hs_broad_phase* bodies = nullptr;
  Check(hs_broad_phase_create(&config, &bodies));
  return std::unique_ptr<Bodies>(new Bodies{
      {bodies, {}}, dims, config.kind, hs_bound_values(config.kind), {}});
}

std::unique_ptr<Bodies> Copy(const Bodies& bodies) {
  hs_broad_phase* copy = nullptr;
  Call(&hs_broad_phase_copy, bodies.get(), &copy);
  return std::unique_ptr<Bodies>(
      new Bodies{{copy, {}}, bodies.dims, bodies.kind, bodies.values, {}});
}

void Insert(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays,
            const Masks& masks) {
  const Columns bounds = BoundsOf(ids, arrays);
  Call(&hs_broad_phase_insert, bodies.get(), ids.data(), &bounds,
       MasksIn(masks, bounds.count));
}

void Move(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays) {
  const Columns bounds = BoundsOf(ids, arrays);
  Call(&hs_broad_phase_move, bodies.get(), ids.data(), &bounds);
}

void SetMasks(const Bodies& bodies, const ShortIds& ids, const Masks& masks) {
  Call(&hs_broad_phase_set_masks, bodies.get(), ids.data(),
       MasksIn(masks, Length(ids)), Length(ids));
}

// With the lock of the pairs.
template <auto kList>
Pairs ListOf(const Bodies& bodies) {
  const hs_id_pair* pairs = nullptr;
  std::size_t count = 0;
  Check(kList(bodies.get(), &pairs, &count));
  return {pairs, pairs + count};
}

py::tuple UpdatePairs(Bodies& bodies, std::size_t threads) {
  Pairs began;
  Pairs ended;
  {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(bodies.pairs);
    {
      const py::gil_scoped_acquire acquire;
      Update<&hs_broad_phase_update_pairs>(bodies, 0, threads);
    }
    began = ListOf<&hs_broad_phase_began>(bodies);
    ended = ListOf<&hs_broad_phase_ended>(bodies);
  }
  return py::make_tuple(ToArray(began), ToArray(ended));
}

Ids PairsNow(Bodies& bodies) {
  Pairs pairs;
  {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(bodies.pairs);
    pairs = ListOf<&hs_broad_phase_pairs>(bodies);
  }
  return ToArray(pairs);
}

// Saved bytes take less than all memory.
py::bytes Save(const Bodies& bodies) {
  std::string bytes;
  {
    const py::gil_scoped_release release;
    hs_body_statistics its;
    Check(hs_broad_phase_statistics(bodies.get(), &its, sizeof(its)));
    std::size_t size = its.bytes;
    do {
      bytes.resize(size);
      Check(
          hs_broad_phase_save(bodies.get(), bytes.data(), bytes.size(), &size));
    } while (size > bytes.size());
    bytes.resize(size);
  }
  return py::bytes(bytes);
}

void Load(Bodies& bodies, const py::array_t<std::uint8_t>& bytes) {
  const py::gil_scoped_release release;
  const std::scoped_lock lock(bodies.pairs);
  Check(hs_broad_phase_load(bodies.get(), bytes.data(), Length(bytes)));
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
  return py::dict("bodies"_a = its.bodies, "pairs"_a = its.pairs,
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
  py::class_<Bodies> of(module, "BroadPhase");
  Searches<Bodies>::Define(of);
  of.def(py::init(&MakeBodies))
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
      .def("update_pairs", &UpdatePairs)
      .def("pairs", &PairsNow)
      .def("copy", &Copy)
      .def("save", &Save)
      .def("load", &Load)
      .def("bounds", &BoundsOfAll)
      .def("get", &Get)
      .def("statistics", &Statistics)
      .def("validate", &Ask<int, &hs_broad_phase_validate>)
      .def("size", &Ask<std::size_t, &hs_broad_phase_size>)
      .def("id_limit", &Ask<std::size_t, &hs_broad_phase_id_limit>)
      .def("has", [](const Bodies& bodies, std::uint32_t id) {
        int has = 0;
        Call(&hs_broad_phase_has, bodies.get(), id, &has);
        return has != 0;
      });
}

}  // namespace halfspace::python
