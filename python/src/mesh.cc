// The triangle mesh.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "columns.h"
#include "results.h"
#include "work.h"

namespace py = pybind11;

namespace halfspace::python {
namespace {

// Never changes.
struct Mesh {
  std::unique_ptr<hs_mesh, Destroy<&hs_mesh_destroy>> mesh;
  std::size_t size;

  const hs_mesh* get() const { return mesh.get(); }
};

std::unique_ptr<Mesh> MakeMesh(const py::tuple& vertices,
                               const ShortIds& faces) {
  const Columns points(vertices);
  if (points.size != 3 || faces.ndim() != 2 || faces.shape(1) != 3) {
    ThrowNotPrepared();
  }
  const auto count = static_cast<std::size_t>(faces.shape(0));
  const py::gil_scoped_release release;
  hs_mesh* mesh = nullptr;
  Check(hs_mesh_create(&points, faces.data(), count, nullptr, &mesh));
  return std::unique_ptr<Mesh>(new Mesh{{mesh, {}}, count});
}

// A call, and its queries, sorted if that makes them faster.
struct Search {
  Search(const Mesh& mesh, const py::tuple& arrays, std::size_t threads,
         py::object progress)
      : work(threads, std::move(progress)), queries(arrays) {
    if (!CanSort(queries) || mesh.size < kLargeTree || queries.size < 3) return;
    const py::gil_scoped_release release;
    queries.order = OrderByPlace(queries, 3, work);
  }

  Work work;
  Columns queries;
};

py::tuple Cast(const Mesh& mesh, const py::tuple& rays, bool finds_all,
               std::size_t threads, py::object progress) {
  constexpr std::pair kCast{&hs_mesh_raycast, &hs_mesh_raycast_each};
  Search its(mesh, rays, threads, std::move(progress));
  return FindHits(its.queries, finds_all, its.work,
                  [&](const QueryPart& part, auto to, auto of) {
                    Check(std::get<kFindsAll<decltype(of)>>(kCast)(
                        mesh.get(), &part.queries, nullptr, to, of));
                  });
}

py::array Occluded(const Mesh& mesh, const py::tuple& rays, std::size_t threads,
                   py::object progress) {
  Search its(mesh, rays, threads, std::move(progress));
  return FindEach<std::uint8_t>(
      its.queries, kPartQueries, its.work,
      [&](const hs_columns& some, std::uint8_t* are_hit) {
        Check(hs_mesh_occluded(mesh.get(), &some, nullptr, are_hit));
      });
}

// The closest triangles, their distances and the points on them, of shape
// (n, 3).
py::tuple ClosestPoints(const Mesh& mesh, const py::tuple& points,
                        float max_distance, std::size_t threads,
                        py::object progress) {
  Search its(mesh, points, threads, std::move(progress));
  const Output<float> closest(its.queries, 3);
  const py::tuple found = FindIdsAndFloats(
      its.queries, 1, kPartQueries, its.work,
      [&](const QueryPart& part, std::uint32_t* ids, float* distances) {
        std::vector<float> places(3 * part.queries.count);
        Check(hs_mesh_closest_points(mesh.get(), &part.queries, max_distance,
                                     nullptr, ids, places.data(), distances));
        closest.Store(part.first, places);
      });
  return py::make_tuple(found[0], found[1], closest.array());
}

}  // namespace

void DefineMesh(py::module_& module) {
  py::class_<Mesh>(module, "Mesh")
      .def(py::init(&MakeMesh))
      .def("cast", &Cast)
      .def("occluded", &Occluded)
      .def("closest_points", &ClosestPoints)
      .def_readonly("size", &Mesh::size);
}

}  // namespace halfspace::python
