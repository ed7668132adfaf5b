// Exact tests of geometries, for halfspace.geo: by the GEOS that shapely has
// loaded, whose functions this module gets by their addresses.
#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// The types of geos_c.h, which need not be installed.
struct Handle;
struct Geometry;
struct Prepared;
struct Sequence;
using Test = char(Handle*, const Prepared*, const Geometry*);

// The minima and maxima of x and y.
using Box = std::span<const double, 4>;

bool IsInside(Box a, Box b) {
  return b[0] <= a[0] && b[1] <= a[1] && a[2] <= b[2] && a[3] <= b[3];
}
bool HasSize(Box box) { return box[0] != box[2] || box[1] != box[3]; }
// Not of a point on a side.
bool IsInsideOf(Box a, Box b) {
  if (HasSize(a) || !HasSize(b)) return IsInside(a, b);
  return b[0] < a[0] && b[1] < a[1] && a[2] < b[2] && a[3] < b[3];
}

// A test by a prepared geometry. Some tests of two points or rectangles are
// decided by their boxes.
struct PreparedTest {
  const char* name;
  // The box of the second has to be inside of the box of the first.
  bool needs_inside = false;
  bool (*of_boxes)(Box first, Box second) = nullptr;
  Test* test = nullptr;
};
PreparedTest intersects{"Intersects", false, [](Box, Box) { return true; }};
PreparedTest within{"Within"};
PreparedTest contains{"Contains", true,
                      [](Box a, Box b) { return IsInsideOf(b, a); }};
PreparedTest overlaps{"Overlaps"};
PreparedTest crosses{"Crosses"};
PreparedTest touches{"Touches"};
PreparedTest covers{"Covers", true, [](Box, Box) { return true; }};
PreparedTest covered_by{"CoveredBy"};
PreparedTest contains_properly{"ContainsProperly", true};

// The predicates that `query` knows, and those of the swapped pair, where
// prepared geometries decide them faster.
struct Predicate {
  const char* name;
  PreparedTest* test;
  PreparedTest* swapped = nullptr;
};
constexpr std::array kPredicates{
    Predicate{"intersects", &intersects, &intersects},
    Predicate{"within", &within, &contains},
    Predicate{"contains", &contains},
    Predicate{"overlaps", &overlaps},
    Predicate{"crosses", &crosses},
    Predicate{"touches", &touches},
    Predicate{"covers", &covers},
    Predicate{"covered_by", &covered_by, &covers},
    Predicate{"contains_properly", &contains_properly},
};

// What UseGeos() reads.
struct Geos {
  Handle* (*init)();
  void (*finish)(Handle*);
  void (*on_error)(Handle*, void (*)(const char*, void*), void*);
  char (*is_valid)(Handle*, const Geometry*);
  char (*equals)(Handle*, const Geometry*, const Geometry*);
  int (*distance)(Handle*, const Geometry*, const Geometry*, double*);
  std::array<int (*)(Handle*, const Geometry*, double*), 4> sides;
  int (*coordinates)(Handle*, const Geometry*);
  int (*dimension)(Handle*, const Geometry*);
  int (*type)(Handle*, const Geometry*);
  int (*parts)(Handle*, const Geometry*);
  const Geometry* (*part)(Handle*, const Geometry*, int);
  int (*holes)(Handle*, const Geometry*);
  const Geometry* (*hole)(Handle*, const Geometry*, int);
  const Geometry* (*ring)(Handle*, const Geometry*);
  const Sequence* (*sequence)(Handle*, const Geometry*);
  int (*x)(Handle*, const Sequence*, unsigned, double*);
  int (*y)(Handle*, const Sequence*, unsigned, double*);
  const Prepared* (*prepare)(Handle*, const Geometry*);
  void (*destroy)(Handle*, const Prepared*);
  // Of shapely 2: returns 0 if the object is not a geometry. None has null.
  char (*read)(PyObject*, const Geometry**);
  // Of shapely 1.8, whose geometries have the address as an attribute.
  PyObject* base_type;
  PyObject* error_type;
} geos;

// `address_of` returns the address of a function of GEOS, and `api` is the
// capsule of shapely 2, or None. The two types stay referenced forever.
void UseGeos(const py::function& address_of, const py::object& api,
             py::object base_type, py::object error_type) {
  const auto load = [&](auto& function, const std::string& name) {
    const auto address = address_of("GEOS" + name + "_r").cast<std::size_t>();
    // NOLINTNEXTLINE(performance-no-int-to-ptr): ctypes has numbers.
    function = reinterpret_cast<std::decay_t<decltype(function)>>(address);
  };
  load(geos.init, "_init");
  load(geos.finish, "_finish");
  load(geos.on_error, "Context_setErrorMessageHandler");
  load(geos.is_valid, "isValid");
  load(geos.equals, "Equals");
  load(geos.distance, "Distance");
  for (std::size_t i = 0; i < 4; ++i) {
    constexpr std::array kSides{"XMin", "YMin", "XMax", "YMax"};
    load(geos.sides[i], std::string("Geom_get") + kSides[i]);
  }
  load(geos.coordinates, "GetNumCoordinates");
  load(geos.dimension, "Geom_getCoordinateDimension");
  load(geos.type, "GeomTypeId");
  load(geos.parts, "GetNumGeometries");
  load(geos.part, "GetGeometryN");
  load(geos.holes, "GetNumInteriorRings");
  load(geos.hole, "GetInteriorRingN");
  load(geos.ring, "GetExteriorRing");
  load(geos.sequence, "Geom_getCoordSeq");
  load(geos.x, "CoordSeq_getX");
  load(geos.y, "CoordSeq_getY");
  load(geos.prepare, "Prepare");
  load(geos.destroy, "PreparedGeom_destroy");
  for (const Predicate& its : kPredicates) {
    load(its.test->test, std::string("Prepared") + its.test->name);
  }
  if (!api.is_none()) {
    const auto functions = static_cast<void**>(
        PyCapsule_GetPointer(api.ptr(), "shapely.lib._C_API"));
    if (functions == nullptr) throw py::error_already_set();
    geos.read = reinterpret_cast<decltype(geos.read)>(functions[1]);
  }
  geos.base_type = base_type.release().ptr();
  geos.error_type = error_type.release().ptr();
}

// The pair about which GEOS cannot decide.
struct Undecided {
  std::size_t row;
  std::size_t id;
  std::string reason;
};

// A context of GEOS, of one thread.
class Context {
 public:
  Context() : handle_(geos.init()) {
    geos.on_error(
        handle_,
        [](const char* text, void* to) {
          *static_cast<std::string*>(to) = text;
        },
        &reason_);
  }
  Context(const Context&) = delete;
  ~Context() { geos.finish(handle_); }

  // NOLINTNEXTLINE(google-explicit-constructor): what calls of GEOS take.
  operator Handle*() const { return handle_; }
  const std::string& reason() const { return reason_; }

 private:
  Handle* handle_;
  std::string reason_;
};

// Types of GEOS.
constexpr int kPoint = 0;
constexpr int kPolygon = 3;
constexpr int kMultiPoint = 4;
constexpr int kCollection = 7;

// Reads the sides of the box. `box` can be null. Returns false if the geometry
// is empty. GEOS 3.11 computes boxes and numbers of dimensions on first use,
// and stores them in the geometry without a lock. This makes it store all of
// them, also those of holes and parts, so that threads only read the geometry.
// Call it with the interpreter's lock.
bool ReadBox(const Context& context, const Geometry* its, double* box) {
  // Also stores the dimensions of holes and of parts.
  geos.dimension(context, its);
  const int type = geos.type(context, its);
  const int holes = type == kPolygon ? geos.holes(context, its) : 0;
  double side = 0;
  for (int i = 0; i < holes; ++i) {
    geos.sides[0](context, geos.hole(context, its, i), &side);
  }
  const bool has_parts = type >= kMultiPoint && type <= kCollection;
  const int parts = has_parts ? geos.parts(context, its) : 0;
  for (int i = 0; i < parts; ++i) {
    ReadBox(context, geos.part(context, its, i), nullptr);
  }
  bool has_box = true;
  for (std::size_t k = 0; k < 4; ++k) {
    has_box &= geos.sides[k](context, its, box ? &box[k] : &side) != 0;
  }
  return has_box;
}

// The geometries of pairs.
using Pointers = std::vector<const Geometry*>;

// The geometries of an argument. Those of shapely 2 do not change. Those of
// shapely 1.8 can, so each call reads their addresses again: only those of its
// pairs, if it has few.
class Geometries {
 public:
  // A geometry, or an iterable of them. Some are None.
  Geometries(const py::object& from, const std::string& name) {
    const Geometry* its = nullptr;
    const bool is_one = from.is_none() || PyUnicode_Check(from.ptr()) != 0 ||
                        Read(from.ptr(), its);
    if (is_one) {
      items_ = py::list(1);
      items_[0] = from;
    } else {
      const py::object ndim = py::getattr(from, "ndim", py::int_(1));
      if (!ndim.equal(py::int_(1))) {
        throw py::type_error(name + ": expected one dimension, got " +
                             py::str(ndim).cast<std::string>());
      }
      items_ = py::list(from);
    }
    is_one_ = is_one;
    pointers_.resize(items_.size());
    for (std::size_t i = 0; i < pointers_.size(); ++i) {
      const py::handle item = PyList_GET_ITEM(items_.ptr(), Size(i));
      if (Read(item.ptr(), pointers_[i])) continue;
      throw py::type_error(name + "[" + std::to_string(i) +
                           "]: expected a geometry or None, got " +
                           py::repr(item).cast<std::string>());
    }
    boxes_ = py::array_t<double>(std::vector<std::size_t>{size(), 4});
    double* box = boxes_.mutable_data();
    const Context context;
    for (std::size_t i = 0; i < size(); ++i, box += 4) {
      its = pointers_[i];
      if (its == nullptr || !ReadBox(context, its, box)) {
        std::fill_n(box, 4, std::numeric_limits<double>::quiet_NaN());
      }
    }
  }

  // Null if it is not there.
  const Geometry* operator[](std::size_t i) const {
    if (geos.read != nullptr) return pointers_[i];
    const py::gil_scoped_acquire acquire;
    return Current(i);
  }

  // The geometries of pairs, which `threads` threads can read. Call it with the
  // interpreter's lock.
  Pointers Pick(const Ids& ids, std::size_t threads) const {
    Pointers picked(Length(ids));
    Pointers read;
    const bool can_change = geos.read == nullptr;
    if (can_change && (threads > 1 || size() <= picked.size())) {
      read = PickAll();
    }
    const Pointers& all = can_change ? read : pointers_;
    for (std::size_t i = 0; i < picked.size(); ++i) {
      const auto at = static_cast<std::size_t>(ids.data()[i]);
      picked[i] = all.empty() ? Current(at) : all[at];
    }
    return picked;
  }

  // All of them, of which some can have changed, before several threads use
  // them.
  Pointers PickAll() const {
    if (geos.read != nullptr) return pointers_;
    Pointers picked(size());
    const Context context;
    for (std::size_t i = 0; i < size(); ++i) {
      picked[i] = Current(i);
      if (picked[i] != nullptr) ReadBox(context, picked[i], nullptr);
    }
    return picked;
  }
  std::size_t size() const { return pointers_.size(); }
  bool is_one() const { return is_one_; }

  // An array of the objects.
  py::array array() const {
    py::array result(py::dtype("O"), std::vector<std::size_t>{size()});
    auto** const to = static_cast<PyObject**>(result.mutable_data());
    for (std::size_t i = 0; i < size(); ++i) {
      Py_XDECREF(to[i]);
      to[i] = py::object(items_[i]).release().ptr();
    }
    return result;
  }

  // The boxes, of shape (n, 4). NaN of None and of empty geometries.
  const py::array_t<double>& bounds() const { return boxes_; }
  Box box(std::size_t i) const { return Box(boxes_.data() + 4 * i, 4); }

 private:
  const Geometry* Current(std::size_t i) const {
    const Geometry* its = nullptr;
    Read(PyList_GET_ITEM(items_.ptr(), Size(i)), its);
    return its;
  }

  // Returns false if the object is not a geometry or None.
  static bool Read(PyObject* object, const Geometry*& its) {
    if (geos.read != nullptr) return geos.read(object, &its) != 0;
    its = nullptr;
    if (object == Py_None) return true;
    if (PyObject_IsInstance(object, geos.base_type) != 1) return false;
    const py::object address = py::handle(object).attr("_geom");
    if (!address.is_none()) {
      // NOLINTNEXTLINE(performance-no-int-to-ptr): shapely 1.8 has a number.
      its = reinterpret_cast<const Geometry*>(address.cast<std::size_t>());
    }
    return true;
  }

  py::list items_;
  std::vector<const Geometry*> pointers_;
  py::array_t<double> boxes_;
  bool is_one_ = false;
};

// Calls run(work), which has no lock of the interpreter. An error of GEOS names
// the invalid geometries of its pair, or both.
template <typename Run>
void Decide(const Geometries& given, const Geometries& its,
            const py::tuple& names, std::size_t threads, const Run& run) {
  Work work(threads, py::none());
  try {
    const py::gil_scoped_release release;
    run(work);
  } catch (const Undecided& error) {
    const Context context;
    const std::array pair{given[error.row], its[error.id]};
    const std::array at{error.row, error.id};
    std::array<bool, 2> is_valid{};
    for (std::size_t i = 0; i < 2; ++i) {
      is_valid[i] = geos.is_valid(context, pair[i]) == 1;
    }
    std::string text;
    for (std::size_t i = 0; i < 2; ++i) {
      if (is_valid[i] && !is_valid[1 - i]) continue;
      text += (text.empty() ? "" : " and ") + names[i].cast<std::string>() +
              "[" + std::to_string(at[i]) + "]";
    }
    PyErr_SetString(geos.error_type, (text + ": " + error.reason).c_str());
    throw py::error_already_set();
  }
}

// Pairs of one part: few enough that Ctrl-C is seen soon.
constexpr std::size_t kPartPairs = 4096;

// Calls part(begin, end, of_thread) for all pairs. Each thread has an Of.
template <typename Of, typename Part>
void ForPairs(std::size_t count, Work& work, const Part& part) {
  // Before the threads start: a new context resets a flag that all tests read.
  std::vector<Of> of_threads(work.threads());
  work.Run(PartsOf(count, kPartPairs), [&](std::size_t i, std::size_t thread) {
    part(i * kPartPairs, std::min(count, (i + 1) * kPartPairs),
         of_threads[thread]);
  });
}

// The last prepared geometry of a thread. GEOS adds indices to it during tests.
struct Last {
  struct Destroy {
    void operator()(const Prepared* its) const { geos.destroy(context, its); }
    Handle* context;
  };

  Context context;
  const Geometry* geometry = nullptr;
  bool is_box = false;
  std::unique_ptr<const Prepared, Destroy> prepared{nullptr, Destroy{context}};
};

// Whether a geometry is a point, or a rectangle with sides along the axes.
bool IsBox(const Context& context, const Geometry* its, Box box) {
  for (const double value : box) {
    if (!std::isfinite(value)) return false;
  }
  const int type = geos.type(context, its);
  if (type != kPolygon) return type == kPoint;
  if (geos.coordinates(context, its) != 5 || geos.holes(context, its) != 0 ||
      box[0] == box[2] || box[1] == box[3]) {
    return false;
  }
  const Sequence* const corners =
      geos.sequence(context, geos.ring(context, its));
  std::array<double, 4> x{};
  std::array<double, 4> y{};
  for (unsigned i = 0; i < 4; ++i) {
    geos.x(context, corners, i, &x[i]);
    geos.y(context, corners, i, &y[i]);
  }
  // Sides along one axis and the other, in turns.
  const auto turns = [](const auto& a, const auto& b) {
    return a[0] == a[1] && b[1] == b[2] && a[2] == a[3] && b[3] == b[0];
  };
  return turns(x, y) || turns(y, x);
}

// Whether the pairs intersect faster with the second of each prepared: to
// prepare a geometry reads its vertices, and a test those of the other one.
bool IsSwapFaster(const Pointers& a, const Pointers& b, std::size_t size_b) {
  const Context context;
  const std::size_t count = a.size();
  std::size_t rows = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0 && a[i] == a[i - 1]) continue;
    ++rows;
    // A prepared line misses some parts of it (GEOS 3.11).
    if (geos.type(context, a[i]) == kCollection) return false;
  }
  double of_a = 0;
  double of_b = 0;
  for (std::size_t i = 0; i < count; i += count / 1024 + 1) {
    of_a += geos.coordinates(context, a[i]);
    of_b += geos.coordinates(context, b[i]);
  }
  const auto tests = static_cast<double>(count);
  return of_b * std::min(tests, static_cast<double>(size_b)) + of_a * tests <
         of_a * static_cast<double>(rows) + of_b * tests;
}

// Returns for each pair whether the predicate holds. The rows ascend, and the
// boxes of a pair overlap.
py::array_t<bool> Holds(const Geometries& given, const std::string& name,
                        const Ids& rows, const Geometries& its, const Ids& ids,
                        const py::tuple& names, std::size_t threads) {
  const auto predicate =
      std::find_if(kPredicates.begin(), kPredicates.end(),
                   [&](const Predicate& each) { return name == each.name; });
  const std::size_t count = Length(ids);
  if (predicate == kPredicates.end() || Length(rows) != count) {
    ThrowNotPrepared();
  }
  threads = std::min(threads, PartsOf(count, kPartPairs));
  py::array_t<bool> holds(Size(count));
  bool* const to = holds.mutable_data();
  const std::int64_t* const row = rows.data();
  const std::int64_t* const id = ids.data();
  const Pointers of_rows = given.Pick(rows, threads);
  const Pointers of_ids = its.Pick(ids, threads);
  Decide(given, its, names, threads, [&](Work& work) {
    bool swaps =
        predicate->swapped == predicate->test
            ? given.size() > 1 && IsSwapFaster(of_rows, of_ids, its.size())
            : predicate->swapped != nullptr;
    swaps &= count <= 0xFFFFFFFF;  // for `order`
    const Geometries& first = swaps ? its : given;
    const Geometries& second = swaps ? given : its;
    const Pointers& firsts = swaps ? of_ids : of_rows;
    const Pointers& seconds = swaps ? of_rows : of_ids;
    const std::int64_t* const key = swaps ? id : row;
    const std::int64_t* const other = swaps ? row : id;
    const PreparedTest& test = swaps ? *predicate->swapped : *predicate->test;
    // The tests of a prepared geometry follow each other.
    std::vector<std::uint64_t> order(swaps ? count : 0);
    for (std::size_t i = 0; i < order.size(); ++i) {
      order[i] = static_cast<std::uint64_t>(key[i]) << 32 | i;
    }
    std::sort(order.begin(), order.end());
    const auto decide = [&](std::size_t begin, std::size_t end, Last& last) {
      const Context& context = last.context;
      for (std::size_t at = begin; at < end; ++at) {
        const std::size_t i = swaps ? order[at] & 0xffffffff : at;
        const Box box_a = first.box(static_cast<std::size_t>(key[i]));
        const Box box_b = second.box(static_cast<std::size_t>(other[i]));
        to[i] = false;
        if (test.needs_inside && !IsInside(box_b, box_a)) continue;
        const Geometry* const a = firsts[i];
        const Geometry* const b = seconds[i];
        if (a != last.geometry) {
          last.geometry = a;
          last.prepared.reset();
          last.is_box = test.of_boxes != nullptr && IsBox(context, a, box_a);
        }
        if (last.is_box && IsBox(context, b, box_b)) {
          to[i] = test.of_boxes(box_a, box_b);
          continue;
        }
        if (!last.prepared) last.prepared.reset(geos.prepare(context, a));
        const char result =
            last.prepared ? test.test(context, last.prepared.get(), b) : 2;
        if (result != 0 && result != 1) {
          throw Undecided{static_cast<std::size_t>(row[i]),
                          static_cast<std::size_t>(id[i]), context.reason()};
        }
        to[i] = result == 1;
      }
    };
    ForPairs<Last>(count, work, decide);
  });
  return holds;
}

double DistanceOf(const Context& context, const Geometry* a, const Geometry* b,
                  std::size_t row, std::size_t id) {
  double distance = 0;
  if (geos.distance(context, a, b, &distance) == 0) {
    throw Undecided{row, id, context.reason()};
  }
  return distance;
}

// The distances of pairs.
py::array_t<double> Distances(const Geometries& given, const Ids& rows,
                              const Geometries& its, const Ids& ids,
                              const py::tuple& names, std::size_t threads) {
  py::array_t<double> distances(ids.size());
  double* const to = distances.mutable_data();
  if (rows.size() != ids.size()) ThrowNotPrepared();
  threads = std::min(threads, PartsOf(Length(ids), kPartPairs));
  const Pointers a = given.Pick(rows, threads);
  const Pointers b = its.Pick(ids, threads);
  const auto measure = [&](std::size_t begin, std::size_t end,
                           const Context& context) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto row = static_cast<std::size_t>(rows.data()[i]);
      const auto id = static_cast<std::size_t>(ids.data()[i]);
      to[i] = DistanceOf(context, a[i], b[i], row, id);
    }
  };
  Decide(given, its, names, threads,
         [&](Work& work) { ForPairs<Context>(a.size(), work, measure); });
  return distances;
}

// A margin, and the error of distances as doubles.
double Reach(Box box, double margin) {
  double most = 0;
  for (const double value : box) most = std::max(most, std::abs(value));
  return margin + 0x1p-48 * (margin + most);
}

struct Near {
  auto operator<=>(const Near&) const = default;

  double distance;
  std::uint32_t id;
};

// The nearest geometries to one.
class NearestOf {
 public:
  // `rows` and `objects` are all given geometries and all of the tree, or
  // empty.
  NearestOf(const hs_bvh* tree, const Geometries& given, const Geometries& its,
            const Pointers& rows, const Pointers& objects, double limit,
            bool is_exclusive)
      : tree_(tree),
        given_(given),
        its_(its),
        rows_(rows),
        objects_(objects),
        limit_(limit),
        is_exclusive_(is_exclusive) {
    Check(hs_bvh_size(tree, &size_));
  }

  // Those that are equally near, by id.
  const std::vector<Near>& Find(std::size_t row, Box box) {
    for (std::size_t k = 4; Search(row, box, std::min(k, size_));) k *= 8;
    std::sort(found_.begin(), found_.end());
    const auto end =
        std::find_if(found_.begin(), found_.end(), [&](const Near& each) {
          return each.distance != found_.front().distance;
        });
    found_.erase(end, found_.end());
    return found_;
  }

 private:
  // Returns whether there can be others than those of the k boxes that are
  // nearest, of which all are excluded.
  bool Search(std::size_t row, Box box, std::size_t k) {
    found_.clear();
    if (k == 0) return false;
    best_ = limit_;
    ids_.resize(k);
    floats_.resize(k);
    const hs_columns query = Columns(box);
    const hs_query_options options = DefaultOf(&hs_query_options_default);
    constexpr float kInf = std::numeric_limits<float>::infinity();
    Check(hs_bvh_nearest_to_boxes(tree_, &query, k, kInf, &options, ids_.data(),
                                  floats_.data()));
    for (std::size_t i = 0; i < k; ++i) {
      // Boxes so far away that their distance is no float.
      if (ids_[i] == HS_NO_ID) return SearchAround(row, box);
      // The error of a float is 2^-20 of it.
      if (floats_[i] * (1 - 0x1p-18) > Reach(box, best_)) return false;
      Add(row, ids_[i]);
    }
    if (k == size_ || found_.empty()) return k < size_;
    return SearchAround(row, box);
  }

  // All whose boxes are as near as the best so far.
  bool SearchAround(std::size_t row, Box box) {
    const double reach = Reach(box, best_);
    std::array<double, 4> around;
    for (std::size_t k = 0; k < 4; ++k) {
      const double way = k < 2 ? -reach : reach;
      around[k] = std::isinf(reach) ? way : box[k] + way;
    }
    found_.clear();
    const hs_columns query = Columns(around);
    std::size_t total = 0;
    while (Check(hs_bvh_query(tree_, &query, nullptr, ids_.data(), ids_.size(),
                              nullptr, &total)),
           total > ids_.size()) {
      ids_.resize(total);
    }
    for (std::size_t i = 0; i < total; ++i) Add(row, ids_[i]);
    return false;
  }

  void Add(std::size_t row, std::uint32_t id) {
    const Geometry* const a = rows_.empty() ? given_[row] : rows_[row];
    const Geometry* const b = rows_.empty() ? its_[id] : objects_[id];
    const double distance = DistanceOf(context_, a, b, row, id);
    if (!(distance <= best_) || distance == HUGE_VAL) return;
    // GEOS compares the boxes first. Those that it cannot compare are equal.
    if (is_exclusive_ && distance == 0 && geos.equals(context_, a, b) != 0) {
      return;
    }
    best_ = distance;
    found_.push_back({distance, id});
  }

  static hs_columns Columns(Box box) {
    hs_columns columns{};
    columns.type = HS_FLOAT64;
    columns.count = 1;
    columns.stride = 4;
    for (std::size_t k = 0; k < 4; ++k) columns.column[k] = &box[k];
    return columns;
  }

  Context context_;
  const hs_bvh* tree_;
  const Geometries& given_;
  const Geometries& its_;
  const Pointers& rows_;
  const Pointers& objects_;
  double limit_;
  bool is_exclusive_;
  std::size_t size_ = 0;
  double best_ = 0;
  std::vector<Near> found_;
  std::vector<std::uint32_t> ids_;
  std::vector<float> floats_;
};

// Returns the rows and the ids of the geometries that are nearest to each given
// one, of shape (2, n), and their distances, up to the limit. Without
// `all_matches` only the first of each row.
py::tuple Nearest(const Geometries& given, const py::object& tree,
                  const Geometries& its, double limit, bool is_exclusive,
                  bool all_matches, const py::tuple& names,
                  std::size_t threads) {
  const hs_bvh* const bvh = HandleOf(tree);
  constexpr std::size_t kInPart = 256;
  const std::size_t parts = PartsOf(given.size(), kInPart);
  threads = std::min(threads, parts);
  std::vector<std::vector<std::pair<std::size_t, Near>>> lists(parts);
  // Most rows read the boxes of 4 objects at least.
  Pointers a;
  Pointers b;
  if (threads > 1 || its.size() <= 4 * given.size()) {
    a = given.PickAll();
    b = its.PickAll();
  }
  Decide(given, its, names, threads, [&](Work& work) {
    // Each has a context: see ForPairs().
    std::deque<NearestOf> of_threads;
    while (of_threads.size() < threads) {
      of_threads.emplace_back(bvh, given, its, a, b, limit, is_exclusive);
    }
    work.Run(parts, [&](std::size_t part, std::size_t thread) {
      const std::size_t end = std::min(given.size(), (part + 1) * kInPart);
      for (std::size_t row = part * kInPart; row < end; ++row) {
        const Box box = given.box(row);
        const auto is_nan = [](double value) { return std::isnan(value); };
        if (std::any_of(box.begin(), box.end(), is_nan)) continue;
        for (const Near& each : of_threads[thread].Find(row, box)) {
          lists[part].emplace_back(row, each);
          if (!all_matches) break;
        }
      }
    });
  });
  std::size_t total = 0;
  for (const auto& list : lists) total += list.size();
  Ids ids(std::vector<std::size_t>{2, total});
  py::array_t<double> distances(Size(total));
  std::int64_t* to = ids.mutable_data();
  double* distance = distances.mutable_data();
  for (const auto& list : lists) {
    for (const auto& [row, near] : list) {
      to[0] = static_cast<std::int64_t>(row);
      to[total] = near.id;
      *distance++ = near.distance;
      ++to;
    }
  }
  return py::make_tuple(ids, distances);
}

}  // namespace

void DefineGeos(py::module_& module) {
  module.def("use_geos", &UseGeos);
  py::class_<Geometries>(module, "Geometries")
      .def(py::init<const py::object&, const std::string&>())
      .def("__len__", &Geometries::size)
      .def_property_readonly("is_one", &Geometries::is_one)
      .def("array", &Geometries::array)
      .def_property_readonly("bounds", &Geometries::bounds)
      .def("hold", &Holds)
      .def("distances", &Distances)
      .def("nearest", &Nearest);
}

}  // namespace halfspace::python
