// The flat scan.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "columns.h"
#include "module.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

struct DestroyScan {
  void operator()(hs_scan* scan) const { hs_scan_destroy(scan); }
};

// Never changes.
struct Scan {
  std::unique_ptr<hs_scan, DestroyScan> scan;
  std::size_t dims;
  std::size_t size;
};

// Each query tests all objects, so it can be a part by itself. Some together
// take less time.
std::size_t InPart(const Columns& queries, std::size_t threads) {
  return std::clamp(queries.count / (8 * threads), std::size_t{1},
                    std::size_t{32});
}

std::unique_ptr<Scan> MakeScan(const py::tuple& arrays, bool is_quantized) {
  const Columns boxes(arrays);
  hs_scan_config config;
  Check(hs_scan_config_default(&config, sizeof(config)));
  config.kind = boxes.size == 4 ? HS_BOX2 : HS_BOX3;
  config.bits = is_quantized ? 8 : 0;
  const py::gil_scoped_release release;
  hs_scan* scan = nullptr;
  Check(hs_scan_create(&config, &boxes, &scan));
  return std::make_unique<Scan>(
      Scan{std::unique_ptr<hs_scan, DestroyScan>(scan), boxes.size / 2,
           boxes.count});
}

// Returns the rows and the ids, of shape (2, n), or only the ids, of shape (n).
Ids Query(const Scan& scan, const py::tuple& arrays, bool with_rows,
          std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  return FindAll(boxes, InPart(boxes, threads), with_rows, work,
                 FinderOf(scan.scan.get(), &hs_scan_indices));
}

Ids Count(const Scan& scan, const py::tuple& arrays, std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  return CountAll(scan.scan.get(), &hs_scan_counts, boxes,
                  InPart(boxes, threads), work);
}

py::array_t<bool> Any(const Scan& scan, const py::tuple& arrays,
                      std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  return AnyOfAll(scan.scan.get(), &hs_scan_any, boxes, InPart(boxes, threads),
                  work);
}

// Returns an array of shape (queries, objects).
py::array_t<bool> Mask(const Scan& scan, const py::tuple& arrays,
                       std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  py::array_t<bool> mask(std::vector<std::size_t>{boxes.count, scan.size});
  bool* const to = mask.mutable_data();
  std::vector<std::vector<std::uint64_t>> words(
      threads, std::vector<std::uint64_t>(hs_mask_words(scan.size)));
  ForEachPart(boxes.count, /*in_part=*/1, work,
              [&](std::size_t row, std::size_t thread) {
                const hs_columns query = boxes.Rows(row, 1);
                std::vector<std::uint64_t>& its = words[thread];
                Check(hs_scan_masks(scan.scan.get(), &query, nullptr,
                                    its.data(), its.size()));
                for (std::size_t i = 0; i < scan.size; ++i) {
                  to[row * scan.size + i] = (its[i / 64] >> i % 64 & 1) != 0;
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
      .def("size", [](const Scan& scan) { return scan.size; })
      .def_readonly("dims", &Scan::dims);
}

}  // namespace halfspace::python
