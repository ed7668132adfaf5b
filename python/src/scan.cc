#include "scan.h"

#include <halfspace/quantized.h>
#include <halfspace/reject.h>
#include <halfspace/world.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

using Ids = py::array_t<std::int64_t>;

// Never changes.
struct Scan {
  std::variant<AabbWorld2, AabbWorld3, QuantizedWorld<AabbView2>,
               QuantizedWorld<AabbView3>>
      world;
};

template <typename AnyWorld>
constexpr int kDimsOf = std::decay_t<AnyWorld>::Bound::kDimensions;

int DimsOf(const Scan& scan) {
  return std::visit([](const auto& world) { return kDimsOf<decltype(world)>; },
                    scan.world);
}

template <int kDims>
AabbWorld<kDims> MakeWorld(const Columns& boxes) {
  AabbWorld<kDims> world;
  world.Resize(boxes.count());
  const AabbPlanes<kDims> planes = world.planes();
  std::array<Aabb<kDims>, 256> some;
  for (std::size_t first = 0; first < boxes.count(); first += some.size()) {
    const std::size_t count = std::min(some.size(), boxes.count() - first);
    boxes.GetBoxes(first, count, some.data());
    for (std::size_t k = 0; k < kDims; ++k) {
      for (std::size_t i = 0; i < count; ++i) {
        planes.min[k][first + i] = some[i].min[k];
        planes.max[k][first + i] = some[i].max[k];
      }
    }
  }
  return world;
}

template <int kDims>
void Fill(Scan& scan, const Columns& boxes, bool is_quantized) {
  if (is_quantized) {
    scan.world =
        QuantizedWorld<AabbView<kDims>>(MakeWorld<kDims>(boxes).view());
  } else {
    scan.world = MakeWorld<kDims>(boxes);
  }
}

std::unique_ptr<Scan> MakeScan(const py::tuple& arrays, bool is_quantized) {
  const Columns boxes(arrays);
  auto scan = std::make_unique<Scan>();
  const py::gil_scoped_release release;
  if (boxes.columns() == 4) {
    Fill<2>(*scan, boxes, is_quantized);
  } else if (boxes.columns() == 6) {
    Fill<3>(*scan, boxes, is_quantized);
  } else {
    throw std::invalid_argument("_halfspace: boxes with other columns");
  }
  return scan;
}

// Calls one(world, query, i, thread) for each query i, without the
// interpreter's lock.
template <typename One>
void ForEachQuery(const Scan& scan, const Columns& boxes, Work& work,
                  const One& one) {
  if (boxes.columns() != 2 * static_cast<std::size_t>(DimsOf(scan))) {
    throw std::invalid_argument("_halfspace: columns of other dimensions");
  }
  work.SetStage(0, boxes.count(), boxes.count());
  const py::gil_scoped_release release;
  std::visit(
      [&](const auto& world) {
        work.Run(boxes.count(), [&](std::size_t i, std::size_t thread) {
          Aabb<kDimsOf<decltype(world)>> query;
          boxes.GetBoxes(i, 1, &query);
          one(world, query, i, thread);
        });
      },
      scan.world);
}

// Returns the rows and the ids, of shape (2, n), or only the ids, of shape (n).
Ids Query(const Scan& scan, const py::tuple& arrays, bool with_rows,
          std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  Results<std::uint32_t> results(boxes.count(), threads);
  ForEachQuery(scan, boxes, work,
               [&](const auto& world, const auto& query, std::size_t i,
                   std::size_t thread) {
                 results.Add(i, thread, [&](Span<std::uint32_t> ids) {
                   return Survivors(world, query, ids);
                 });
               });
  const std::vector<std::size_t> offsets = results.Offsets();
  const std::size_t found = offsets.back();
  Ids ids(with_rows ? std::vector<std::size_t>{2, found}
                    : std::vector<std::size_t>{found});
  std::int64_t* const rows = ids.mutable_data();
  std::int64_t* const objects = rows + (with_rows ? found : 0);
  const py::gil_scoped_release release;
  for (std::size_t i = 0; i < boxes.count(); ++i) {
    const Span<const std::uint32_t> list = results.List(i);
    std::copy(list.begin(), list.end(), objects + offsets[i]);
    if (with_rows) {
      std::fill(rows + offsets[i], rows + offsets[i + 1],
                static_cast<std::int64_t>(i));
    }
  }
  return ids;
}

Ids Count(const Scan& scan, const py::tuple& arrays, std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  Ids counts(Size(boxes.count()));
  std::int64_t* const to = counts.mutable_data();
  ForEachQuery(
      scan, boxes, work,
      [to](const auto& world, const auto& query, std::size_t i, std::size_t) {
        to[i] = static_cast<std::int64_t>(CountSurvivors(world, query));
      });
  return counts;
}

py::array_t<bool> Any(const Scan& scan, const py::tuple& arrays,
                      std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  py::array_t<bool> found(Size(boxes.count()));
  bool* const to = found.mutable_data();
  ForEachQuery(
      scan, boxes, work,
      [to](const auto& world, const auto& query, std::size_t i, std::size_t) {
        to[i] = AnySurvivor(world, query).has_value();
      });
  return found;
}

std::size_t SizeOf(const Scan& scan) {
  return std::visit([](const auto& world) { return world.size(); }, scan.world);
}

// Returns an array of shape (queries, objects).
py::array_t<bool> Mask(const Scan& scan, const py::tuple& arrays,
                       std::size_t threads) {
  const Columns boxes(arrays);
  const std::size_t size = SizeOf(scan);
  Work work(threads, py::none());
  py::array_t<bool> mask(std::vector<std::size_t>{boxes.count(), size});
  bool* const to = mask.mutable_data();
  std::vector<std::vector<std::uint64_t>> words(threads);
  ForEachQuery(scan, boxes, work,
               [&](const auto& world, const auto& query, std::size_t row,
                   std::size_t thread) {
                 words[thread].resize(MaskWords(size));
                 SurvivorMask(world, query, words[thread]);
                 for (std::size_t i = 0; i < size; ++i) {
                   to[row * size + i] =
                       (words[thread][i / 64] >> i % 64 & 1) != 0;
                 }
               });
  return mask;
}

}  // namespace

void DefineScan(py::module_& module) {
  py::class_<Scan>(module, "Scan")
      .def(py::init(&MakeScan))
      .def("query", &Query)
      .def("count", &Count)
      .def("any", &Any)
      .def("mask", &Mask)
      .def("size", &SizeOf)
      .def_property_readonly("dims", &DimsOf);
}

}  // namespace halfspace::python
