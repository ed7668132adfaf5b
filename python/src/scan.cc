// The flat scan.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Never changes.
struct Scan {
  std::unique_ptr<hs_scan, Destroy<&hs_scan_destroy>> scan;
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
  hs_scan_config config = DefaultOf(&hs_scan_config_default);
  config.kind = boxes.size == 4 ? HS_BOX2 : HS_BOX3;
  config.bits = is_quantized ? 8 : 0;
  const py::gil_scoped_release release;
  hs_scan* scan = nullptr;
  Check(hs_scan_create(&config, &boxes, &scan));
  return std::unique_ptr<Scan>(
      new Scan{{scan, {}}, boxes.size / 2, boxes.count});
}

Ids Query(const Scan& scan, const py::tuple& arrays, std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  return FindAll(
      boxes, InPart(boxes, threads), work,
      [&](const hs_columns& queries, std::span<std::uint32_t> ids,
          std::size_t* offsets) {
        std::size_t total = 0;
        Check(hs_scan_indices(scan.scan.get(), &queries, nullptr, ids.data(),
                              ids.size(), offsets, &total));
        return total;
      });
}

// hs_scan_counts() or hs_scan_any().
template <auto kFunction, typename Value>
py::array Ask(const Scan& scan, const py::tuple& arrays, std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  return FindEach<Value>(
      boxes, InPart(boxes, threads), work,
      [&](const hs_columns& some, Value* values) {
        Check(kFunction(scan.scan.get(), &some, nullptr, values));
      });
}

// Returns an array of shape (queries, objects).
py::array_t<bool> Mask(const Scan& scan, const py::tuple& arrays,
                       std::size_t threads) {
  const Columns boxes(arrays);
  Work work(threads, py::none());
  py::array_t<bool> masks(std::vector<std::size_t>{boxes.count, scan.size});
  bool* const to = masks.mutable_data();
  ForEachPart(boxes, /*in_part=*/1, work, [&](const QueryPart& part) {
    std::vector<std::uint64_t> words(hs_mask_words(scan.size));
    Check(hs_scan_masks(scan.scan.get(), &part.queries, nullptr, words.data(),
                        words.size()));
    for (std::size_t i = 0; i < scan.size; ++i) {
      to[part.first * scan.size + i] = (words[i / 64] >> i % 64 & 1) != 0;
    }
  });
  return masks;
}

}  // namespace

void DefineScan(py::module_& module) {
  py::class_<Scan>(module, "Scan")
      .def(py::init(&MakeScan))
      .def("query", &Query)
      .def("count", &Ask<&hs_scan_counts, std::size_t>)
      .def("any", &Ask<&hs_scan_any, std::uint32_t>)
      .def("mask", &Mask)
      .def("size", [](const Scan& scan) { return scan.size; })
      .def_readonly("dims", &Scan::dims);
}

}  // namespace halfspace::python
