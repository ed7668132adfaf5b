#include "broad_phase.h"

#include <halfspace/broad_phase.h>
#include <halfspace/fit.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
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
using ShortIds = py::array_t<std::uint32_t, py::array::c_style>;
// Of bodies of shape (n, 2): the category and what it collides with.
using Masks = py::array_t<std::uint64_t, py::array::c_style>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

// Queries of one part: few enough that Ctrl-C is seen soon.
constexpr std::size_t kPartQueries = 256;

// The object of Python. Needs no lock of its own: see broad_phase.h.
struct Bodies {
  std::variant<
      std::unique_ptr<AabbBroadPhase2>, std::unique_ptr<AabbBroadPhase3>,
      std::unique_ptr<AaboBroadPhase2>, std::unique_ptr<AaboBroadPhase3>>
      any;

  int dims() const { return any.index() % 2 == 0 ? 2 : 3; }
};

template <typename AnyBodies>
using BoundIn = typename std::decay_t<AnyBodies>::Bound;

// Calls function(broad phase) without the interpreter's lock. A message of the
// library loses the name of the C++ call.
template <typename Function>
auto Call(const Bodies& bodies, const Function& function) {
  const py::gil_scoped_release release;
  try {
    return std::visit([&](const auto& its) { return function(*its); },
                      bodies.any);
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    const std::size_t prefix = text.find("halfspace: BroadPhase");
    if (prefix != 0) throw;
    throw std::invalid_argument(text.substr(text.find(": ", 11) + 2));
  }
}

Span<const std::uint32_t> List(const ShortIds& ids) {
  return {ids.data(), static_cast<std::size_t>(ids.size())};
}

Span<const BodyMasks> MasksIn(const Masks& masks) {
  static_assert(sizeof(BodyMasks) == 2 * sizeof(std::uint64_t));
  if (masks.ndim() != 2 || masks.shape(1) != 2) {
    throw std::invalid_argument("_halfspace: masks of another shape");
  }
  return {reinterpret_cast<const BodyMasks*>(masks.data()),
          static_cast<std::size_t>(masks.shape(0))};
}

template <typename Bound, typename Scalar>
Bound RecordAt(const Columns& columns, std::size_t row) {
  std::array<Scalar, 2 * Bound::kAxes> values;
  const std::size_t at = row * columns.stride();
  for (std::size_t p = 0; p < values.size(); ++p) {
    values[p] = columns.Column<Scalar>(p)[at];
  }
  detail::PlaneValues<Bound> floats;
  if constexpr (std::is_same_v<Scalar, double>) {
    detail::RoundOutward(values, Bound::kAxes, values.size(), floats.data());
  } else {
    floats = values;
  }
  return detail::BoundOf<Bound>(floats);
}

template <int kDims, typename Scalar>
Aabo<kDims> BoundOfBox(const Columns& columns, std::size_t row) {
  Box<kDims, Scalar> box;
  const std::size_t at = row * columns.stride();
  for (std::size_t k = 0; k < kDims; ++k) {
    box.min[k] = columns.Column<Scalar>(k)[at];
    box.max[k] = columns.Column<Scalar>(kDims + k)[at];
  }
  return BoundAabb(box);
}

// Of records of the bounds, or of boxes.
template <typename Bound>
Bound BoundAt(const Columns& columns, std::size_t row) {
  constexpr int kDims = Bound::kDimensions;
  if (columns.columns() == 2 * Bound::kAxes) {
    return columns.is_double() ? RecordAt<Bound, double>(columns, row)
                               : RecordAt<Bound, float>(columns, row);
  }
  if constexpr (Bound::kAxes > kDims) {
    if (columns.columns() == 2 * kDims) {
      return columns.is_double() ? BoundOfBox<kDims, double>(columns, row)
                                 : BoundOfBox<kDims, float>(columns, row);
    }
  }
  throw std::invalid_argument("_halfspace: columns of other dimensions");
}

template <typename Bound>
std::vector<Bound> AllBounds(const Columns& columns) {
  std::vector<Bound> bounds;
  bounds.reserve(columns.count());
  for (std::size_t i = 0; i < columns.count(); ++i) {
    bounds.push_back(BoundAt<Bound>(columns, i));
  }
  return bounds;
}

std::unique_ptr<Bodies> MakeBodies(std::size_t max_ids, int dims, bool is_aabo,
                                   double margin) {
  BroadPhaseOptions options;
  options.margin = RoundUp(margin);
  auto bodies = std::make_unique<Bodies>();
  const auto make = [&]<typename Of>(std::unique_ptr<Of>) {
    bodies->any = std::make_unique<Of>(max_ids, options);
  };
  if (is_aabo) {
    dims == 2 ? make(std::unique_ptr<AaboBroadPhase2>())
              : make(std::unique_ptr<AaboBroadPhase3>());
  } else {
    dims == 2 ? make(std::unique_ptr<AabbBroadPhase2>())
              : make(std::unique_ptr<AabbBroadPhase3>());
  }
  return bodies;
}

void Insert(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays,
            const Masks& masks) {
  const Columns columns(arrays);
  const Span<const BodyMasks> its_masks = MasksIn(masks);
  Call(bodies, [&](auto& its) {
    its.Insert(List(ids), AllBounds<BoundIn<decltype(its)>>(columns),
               its_masks);
  });
}

void Move(const Bodies& bodies, const ShortIds& ids, const py::tuple& arrays) {
  const Columns columns(arrays);
  Call(bodies, [&](auto& its) {
    its.Move(List(ids), AllBounds<BoundIn<decltype(its)>>(columns));
  });
}

// Calls function(broad phase, runner) with the threads of `work`.
template <typename Function>
void CallWithThreads(const Bodies& bodies, std::size_t threads,
                     const Function& function) {
  Work work(threads, py::none());
  const auto run = [&](std::size_t count, const Runner::Part& part) {
    work.Run(count, [&](std::size_t i, std::size_t) { part(i); });
  };
  Call(bodies, [&](auto& its) { function(its, run); });
}

// Runs find(broad phase, i, list) for each query i on threads, where `list`
// receives its ids. Returns the rows and the ids, of shape (2, n), or only the
// ids.
template <typename Find>
Ids FindAll(const Bodies& bodies, std::size_t queries, bool with_rows,
            std::size_t threads, const Find& find) {
  struct Part {
    std::vector<std::uint32_t> ids;
    std::vector<std::size_t> ends;
  };
  Work work(threads, py::none());
  std::vector<Part> parts((queries + kPartQueries - 1) / kPartQueries);
  Call(bodies, [&](const auto& its) {
    work.Run(parts.size(), [&](std::size_t p, std::size_t) {
      const std::size_t end = std::min(queries, (p + 1) * kPartQueries);
      for (std::size_t i = p * kPartQueries; i < end; ++i) {
        find(its, i, parts[p].ids);
        parts[p].ends.push_back(parts[p].ids.size());
      }
    });
  });
  std::size_t found = 0;
  for (const Part& part : parts) found += part.ids.size();
  Ids ids(with_rows ? std::vector<std::size_t>{2, found}
                    : std::vector<std::size_t>{found});
  std::int64_t* row = ids.mutable_data();
  std::int64_t* id = row + (with_rows ? found : 0);
  std::int64_t query = 0;
  for (const Part& part : parts) {
    id = std::copy(part.ids.begin(), part.ids.end(), id);
    std::size_t begin = 0;
    for (const std::size_t end : part.ends) {
      if (with_rows) row = std::fill_n(row, end - begin, query);
      begin = end;
      ++query;
    }
  }
  return ids;
}

// A sphere has a column for the radius. A point has none, and a radius of 0.
template <int kDims>
Sphere<kDims> SphereAt(const Columns& columns, std::size_t row) {
  return {columns.GetPoint<kDims>(row),
          columns.columns() > kDims ? columns.Get(row, kDims) : 0.0f};
}

// Queries of spheres, or of bounds.
Ids Query(const Bodies& bodies, const py::tuple& arrays, std::uint64_t mask,
          bool with_rows, std::size_t threads) {
  const Columns columns(arrays);
  return FindAll(bodies, columns.count(), with_rows, threads,
                 [&](const auto& its, std::size_t i, auto& ids) {
                   using Bound = BoundIn<decltype(its)>;
                   constexpr int kDims = Bound::kDimensions;
                   const auto add = [&ids](std::uint32_t id, const Bound&) {
                     ids.push_back(id);
                   };
                   if (columns.columns() == kDims + 1) {
                     its.ForEach(SphereAt<kDims>(columns, i), mask, add);
                   } else {
                     its.ForEach(BoundAt<Bound>(columns, i), mask, add);
                   }
                 });
}

// query() of one box in a plain array, in a third of the time. None if the
// array or the bodies need a closer look.
py::object QueryOne(const Bodies& bodies, const py::array& array,
                    std::uint64_t mask) {
  const auto find = [&](const auto& its) -> py::object {
    using Bound = BoundIn<decltype(*its)>;
    constexpr int kDims = Bound::kDimensions;
    if constexpr (std::is_same_v<Bound, Aabb<kDims>>) {
      if (const auto box = BoxIn<kDims>(array)) {
        std::vector<std::uint32_t> found;
        {
          const py::gil_scoped_release release;
          its->ForEach(*box, mask, [&found](std::uint32_t id, const Bound&) {
            found.push_back(id);
          });
        }
        Ids ids(Size(found.size()));
        std::copy(found.begin(), found.end(), ids.mutable_data());
        return ids;
      }
    }
    return py::none();
  };
  return std::visit(find, bodies.any);
}

// The first body of each ray, or of each sphere or box that moves.
py::tuple Cast(const Bodies& bodies, const py::tuple& start_arrays,
               const py::tuple& direction_arrays, const py::tuple& limit_arrays,
               std::uint64_t mask, std::size_t threads) {
  const Columns starts(start_arrays);
  const Columns directions(direction_arrays);
  const Columns limits(limit_arrays);
  const std::size_t n = starts.count();
  const auto dims = static_cast<std::size_t>(bodies.dims());
  const bool are_boxes = starts.columns() == 2 * dims;
  if ((starts.columns() != dims && starts.columns() != dims + 1 &&
       !are_boxes) ||
      directions.columns() != dims || directions.count() != n ||
      limits.columns() != 1 || limits.count() != n) {
    throw std::invalid_argument("_halfspace: columns of other dimensions");
  }
  Ids ids(Size(n));
  py::array_t<float> ts(Size(n));
  std::int64_t* const to = ids.mutable_data();
  float* const its_ts = ts.mutable_data();
  Work work(threads, py::none());
  Call(bodies, [&](const auto& its) {
    constexpr int kDims = BoundIn<decltype(its)>::kDimensions;
    const auto cast = [&](std::size_t i) {
      const auto direction = directions.GetPoint<kDims>(i);
      const float max_t = limits.Get(i, 0);
      FindFirst(to[i], its_ts[i], [&](const auto& function) {
        if (are_boxes) {
          Aabb<kDims> box;
          starts.GetBoxes(i, 1, &box);
          its.ForEachCast(box, direction, max_t, mask, function);
        } else {
          its.ForEachCast(SphereAt<kDims>(starts, i), direction, max_t, mask,
                          function);
        }
      });
    };
    work.Run((n + kPartQueries - 1) / kPartQueries,
             [&](std::size_t part, std::size_t) {
               const std::size_t end = std::min(n, (part + 1) * kPartQueries);
               for (std::size_t i = part * kPartQueries; i < end; ++i) cast(i);
             });
  });
  return py::make_tuple(ids, ts);
}

// An array of shape (n, 2).
Ids ToArray(const std::vector<Pair>& pairs) {
  Ids ids(std::vector<std::size_t>{pairs.size(), 2});
  std::int64_t* to = ids.mutable_data();
  for (const Pair& pair : pairs) {
    *to++ = pair.first;
    *to++ = pair.second;
  }
  return ids;
}

// `masks` has an element for each id, or none.
Ids PairsOf(const Bodies& bodies, const ShortIds& ids, double margin,
            const Masks& masks) {
  const float its_margin = RoundUp(margin);
  std::vector<Pair> pairs;
  const auto add = [&pairs](std::uint32_t a, std::uint32_t b) {
    pairs.emplace_back(a, b);
  };
  const Span<const std::uint64_t> its_masks = {
      masks.data(), static_cast<std::size_t>(masks.size())};
  Call(bodies, [&](const auto& its) {
    if (its_masks.empty()) {
      its.ForEachPairOf(List(ids), its_margin, add);
    } else {
      its.ForEachPairOf(List(ids), its_masks, its_margin, add);
    }
  });
  return ToArray(pairs);
}

py::tuple UpdatePairs(const Bodies& bodies, std::size_t threads) {
  std::vector<Pair> began;
  std::vector<Pair> ended;
  CallWithThreads(bodies, threads, [&](auto& its, const auto& run) {
    its.UpdatePairs(
        [&](std::uint32_t a, std::uint32_t b) { began.emplace_back(a, b); },
        [&](std::uint32_t a, std::uint32_t b) { ended.emplace_back(a, b); },
        run);
  });
  return py::make_tuple(ToArray(began), ToArray(ended));
}

template <typename Bound>
void WriteRecord(const Bound& bound, float* to) {
  to = std::copy(bound.min.begin(), bound.min.end(), to);
  std::copy(bound.max.begin(), bound.max.end(), to);
}

std::size_t ValuesOf(const Bodies& bodies) {
  return 2 * static_cast<std::size_t>(bodies.dims() +
                                      (bodies.any.index() < 2 ? 0 : 1));
}

py::array_t<float> BoundsOf(const Bodies& bodies) {
  py::array_t<float> values(Size(ValuesOf(bodies)));
  float* const to = values.mutable_data();
  Call(bodies, [to](const auto& its) { WriteRecord(its.Bounds(), to); });
  return values;
}

// Calls write(broad phase, id, i) for each id.
template <typename Write>
void ForEachId(const Bodies& bodies, const ShortIds& ids, const Write& write) {
  const Span<const std::uint32_t> list = List(ids);
  Call(bodies, [&](const auto& its) {
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (!its.Has(list[i])) {
        throw std::invalid_argument("ids[" + std::to_string(i) +
                                    "]: expected the id of a body, got " +
                                    std::to_string(list[i]));
      }
      write(its, list[i], i);
    }
  });
}

py::array_t<float> Get(const Bodies& bodies, const ShortIds& ids) {
  const std::size_t values = ValuesOf(bodies);
  py::array_t<float> records(
      std::vector<std::size_t>{static_cast<std::size_t>(ids.size()), values});
  float* const to = records.mutable_data();
  ForEachId(bodies, ids, [&](const auto& its, std::uint32_t id, std::size_t i) {
    WriteRecord(its.Get(id), to + i * values);
  });
  return records;
}

Masks MasksOf(const Bodies& bodies, const ShortIds& ids) {
  Masks masks(
      std::vector<std::size_t>{static_cast<std::size_t>(ids.size()), 2});
  std::uint64_t* const to = masks.mutable_data();
  ForEachId(bodies, ids, [&](const auto& its, std::uint32_t id, std::size_t i) {
    const BodyMasks its_masks = its.MasksOf(id);
    to[2 * i] = its_masks.category;
    to[2 * i + 1] = its_masks.collides_with;
  });
  return masks;
}

py::dict Statistics(const Bodies& bodies) {
  const BroadPhaseStatistics its =
      Call(bodies, [](const auto& any) { return any.Statistics(); });
  py::dict statistics;
  statistics["bodies"] = its.bodies;
  statistics["pending"] = its.pending;
  statistics["pairs"] = its.pairs;
  statistics["trees"] = its.trees;
  statistics["bytes"] = its.bytes;
  statistics["cost_ratio"] = its.cost_ratio;
  return statistics;
}

}  // namespace

void DefineBroadPhase(py::module_& module) {
  py::class_<Bodies>(module, "BroadPhase")
      .def(py::init(&MakeBodies))
      .def("insert", &Insert)
      .def("erase",
           [](const Bodies& bodies, const ShortIds& ids) {
             Call(bodies, [&](auto& its) { its.Erase(List(ids)); });
           })
      .def("move", &Move)
      .def("set_masks",
           [](const Bodies& bodies, const ShortIds& ids, const Masks& masks) {
             const Span<const BodyMasks> its_masks = MasksIn(masks);
             Call(bodies,
                  [&](auto& its) { its.SetMasks(List(ids), its_masks); });
           })
      .def("update",
           [](const Bodies& bodies, std::size_t budget, std::size_t threads) {
             CallWithThreads(bodies, threads, [&](auto& its, const auto& run) {
               its.Update({budget, run});
             });
           })
      .def("rebuild",
           [](const Bodies& bodies, std::size_t threads) {
             CallWithThreads(bodies, threads, [](auto& its, const auto& run) {
               its.Rebuild(run);
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
             return Call(bodies,
                         [](const auto& its) { return its.Validate(); });
           })
      .def("size",
           [](const Bodies& bodies) {
             return Call(bodies, [](const auto& its) { return its.size(); });
           })
      .def("has", [](const Bodies& bodies, std::uint32_t id) {
        return Call(bodies, [id](const auto& its) { return its.Has(id); });
      });
}

}  // namespace halfspace::python
