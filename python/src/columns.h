// NumPy arrays as arguments of the functions of c/halfspace.h, and what these
// functions return.
#ifndef HALFSPACE_PYTHON_COLUMNS_H_
#define HALFSPACE_PYTHON_COLUMNS_H_

#include <halfspace/c/halfspace.h>
#include <pybind11/numpy.h>

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "work.h"

namespace halfspace::python {

// What the files add to the extension module.
void DefineBroadPhase(pybind11::module_& module);
void DefineGeos(pybind11::module_& module);
void DefineMesh(pybind11::module_& module);
void DefineScan(pybind11::module_& module);
void DefineTree(pybind11::module_& module);

using Ids = pybind11::array_t<std::int64_t>;
using ShortIds = pybind11::array_t<std::uint32_t, pybind11::array::c_style>;

// Destroys the handle of a std::unique_ptr by a function of C.
template <auto kDestroy>
using Destroy = std::integral_constant<decltype(kDestroy), kDestroy>;

// A size as pybind11 takes it.
inline pybind11::ssize_t Size(std::size_t size) {
  return static_cast<pybind11::ssize_t>(size);
}

inline std::size_t Length(const pybind11::array& array) {
  return static_cast<std::size_t>(array.size());
}

// Throws the message of this thread's last call, without the name of the C
// function, unless the call returned HS_OK.
void Check(hs_status status);

// The options that a hs_..._default() writes.
template <typename Options>
Options DefaultOf(hs_status (*write)(Options*, std::size_t)) {
  Options options;
  Check(write(&options, sizeof(options)));
  return options;
}

// Throws the error of a call whose arrays _arrays.py has not prepared.
[[noreturn]] void ThrowNotPrepared();

// The columns of the first array, then those of the next. _arrays.py has
// prepared the arrays: they have two dimensions, the same type, length and
// stride, and this machine's byte order. The arrays must outlive the columns.
// The functions of C find missing columns, which are null.
struct Columns : hs_columns {
  Columns() : hs_columns{} {}
  explicit Columns(const pybind11::tuple& arrays) : Columns() {
    if (!Read(arrays)) ThrowNotPrepared();
  }
  // Returns false if the arrays are not prepared. A call of the private module
  // by somebody else then fails, before it reads wrong memory.
  bool Read(const pybind11::tuple& arrays);

  // Records `first` ... `first` + `most` - 1, as far as there are any.
  hs_columns Rows(std::size_t first, std::size_t most) const;

  // Rows() in the order, if there is one. Then `copy` stores the records.
  hs_columns Part(std::size_t first, std::size_t most,
                  std::vector<std::byte>& copy) const;
  // The record that is at place i of the order.
  std::size_t RowAt(std::size_t i) const {
    return order.empty() ? i : order[i];
  }

  std::size_t size = 0;  // columns
  std::vector<std::uint32_t> order;
};

// The order of records in a tree, by their first `dims` columns: those that are
// near each other become neighbors. Queries in this order find in the cache
// what the ones before them read.
std::vector<std::uint32_t> OrderByPlace(const Columns& records,
                                        std::size_t dims, Work& work);
// Whether that can pay: with fewer queries it does not, nor in a tree of fewer
// objects, which is in the cache.
inline constexpr std::size_t kLargeTree = 200'000;
inline bool CanSort(const Columns& queries) {
  constexpr std::size_t kFewQueries = 8192;
  constexpr auto kMostObjects = std::size_t{1} << 31;
  return queries.count >= kFewQueries && queries.count < kMostObjects;
}

// The BVH of a Tree that nobody changes.
const hs_bvh* HandleOf(const pybind11::object& tree);

// The box that a plain array has. No record if the array needs a closer look.
hs_columns BoxIn(const pybind11::array& array, std::size_t dims);

// The first box with a NaN, or with a minimum above its maximum that is not
// empty, or -1. Points are boxes whose maxima are their minima, in column 0.
std::ptrdiff_t FirstBadBox(const hs_columns& boxes, std::size_t dims,
                           std::size_t first_maximum);

}  // namespace halfspace::python

#endif  // HALFSPACE_PYTHON_COLUMNS_H_
