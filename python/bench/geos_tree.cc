// GEOS's STRtree, as a library that calls its C API would use it: with the
// reentrant functions, and with callbacks that only store their result.
// compare.py compiles this module, and calls it on one thread.
#include <geos_c.h>
#include <pybind11/numpy.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace py = pybind11;

namespace {

const GEOSContextHandle_t context = GEOS_init_r();

// Made before anything is timed: callers of GEOS have geometries.
struct Rectangles {
  // Rows of min x, min y, max x, max y.
  using Boxes = py::array_t<double, py::array::c_style>;

  explicit Rectangles(Boxes its_boxes) : boxes(std::move(its_boxes)) {
    for (py::ssize_t i = 0; i < boxes.shape(0); ++i) {
      geometries.push_back(Around(i, 0));
    }
  }
  Rectangles(const Rectangles&) = delete;
  ~Rectangles() {
    for (GEOSGeometry* geometry : geometries) {
      GEOSGeom_destroy_r(context, geometry);
    }
  }

  GEOSGeometry* Around(std::int64_t i, double margin) const {
    const double* const box = boxes.data(i);
    return GEOSGeom_createRectangle_r(context, box[0] - margin, box[1] - margin,
                                      box[2] + margin, box[3] + margin);
  }

  Boxes boxes;
  std::vector<GEOSGeometry*> geometries;
};

// Of a probe and an object.
using Pairs = std::vector<std::array<std::int64_t, 2>>;

// The rows and the ids, of shape (2, n).
py::array ToArray(Pairs pairs) {
  auto* const its = new Pairs(std::move(pairs));
  const py::capsule owner(its,
                          [](void* of) { delete static_cast<Pairs*>(of); });
  constexpr std::size_t kSize = sizeof(std::int64_t);
  return py::array_t<std::int64_t>({std::size_t{2}, its->size()},
                                   {kSize, 2 * kSize}, its->data()->data(),
                                   owner);
}

class Tree {
 public:
  explicit Tree(const Rectangles& objects) : objects_(objects) {
    std::intptr_t item = 0;
    for (GEOSGeometry* geometry : objects.geometries) {
      GEOSSTRtree_insert_r(context, tree_, geometry,
                           reinterpret_cast<void*>(++item));
    }
    // The first query builds the tree.
    ForEach(objects.geometries[0], [](std::int64_t) {});
  }
  Tree(const Tree&) = delete;
  ~Tree() { GEOSSTRtree_destroy_r(context, tree_); }

  // The pairs that overlap, or that are at most `within` apart if this is not
  // 0.
  py::array Join(const Rectangles& probes, double within) const {
    Pairs pairs;
    std::int64_t row = 0;
    for (const GEOSGeometry* probe : probes.geometries) {
      if (within == 0) {
        ForEach(probe, [&](std::int64_t id) { pairs.push_back({row, id}); });
      } else {
        GEOSGeometry* const around = probes.Around(row, within);
        const auto* const prepared = GEOSPrepare_r(context, probe);
        ForEach(around, [&](std::int64_t id) {
          if (GEOSPreparedDistanceWithin_r(
                  context, prepared, objects_.geometries[id], within) != 0) {
            pairs.push_back({row, id});
          }
        });
        GEOSPreparedGeom_destroy_r(context, prepared);
        GEOSGeom_destroy_r(context, around);
      }
      ++row;
    }
    return ToArray(std::move(pairs));
  }

  // The nearest object of each probe, or all that are as near.
  py::array Nearest(const Rectangles& probes, bool with_ties) const {
    Pairs pairs;
    std::int64_t row = 0;
    for (const GEOSGeometry* probe : probes.geometries) {
      const double* const a = probes.boxes.data(row);
      const std::size_t first = pairs.size();
      double least = std::numeric_limits<double>::infinity();
      auto distance_of = [&, boxes = objects_.boxes.data()](std::int64_t id) {
        const double* const b = boxes + 4 * id;
        const double x = std::max({0.0, a[0] - b[2], b[0] - a[2]});
        const double y = std::max({0.0, a[1] - b[3], b[1] - a[3]});
        const double distance = std::sqrt(x * x + y * y);
        if (!with_ties || distance > least) return distance;
        if (distance < least) pairs.resize(first);
        least = distance;
        pairs.push_back({row, id});
        // GEOS goes on to others that are as near, as in Shapely 2.
        return distance + 1e-6;
      };
      const auto call = [](const void* item, const void* /*the probe*/,
                           double* distance, void* its) {
        *distance = (*static_cast<decltype(distance_of)*>(its))(IdOf(item));
        return 1;
      };
      const void* const item = GEOSSTRtree_nearest_generic_r(
          context, tree_, probe, probe, call, &distance_of);
      if (!with_ties) pairs.push_back({row, IdOf(item)});
      ++row;
    }
    return ToArray(std::move(pairs));
  }

 private:
  // Items are ids plus 1, because nearest returns a null pointer for an error.
  static std::int64_t IdOf(const void* item) {
    return reinterpret_cast<std::intptr_t>(item) - 1;
  }
  template <typename Function>
  void ForEach(const GEOSGeometry* probe, Function function) const {
    const auto call = [](void* item, void* its) {
      (*static_cast<Function*>(its))(IdOf(item));
    };
    GEOSSTRtree_query_r(context, tree_, probe, call, &function);
  }

  const Rectangles& objects_;
  // Shapely's and GEOS's own capacity of a node.
  GEOSSTRtree* tree_ = GEOSSTRtree_create_r(context, 10);
};

}  // namespace

PYBIND11_MODULE(geos_tree, module) {
  using namespace py::literals;
  module.def("version", &GEOSversion);
  py::class_<Rectangles>(module, "Rectangles")
      .def(py::init<Rectangles::Boxes>());
  py::class_<Tree>(module, "Tree")
      .def(py::init<const Rectangles&>(), py::keep_alive<1, 2>())
      .def("join", &Tree::Join, "probes"_a, "within"_a = 0.0)
      .def("nearest", &Tree::Nearest, "probes"_a, "with_ties"_a = false);
}
