// Functions on arrays: deformation by a cage, and wraps.
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <algorithm>

#include "editor/edits/deform/cage.h"
#include "editor/fields/codec.h"
#include "editor/python/json_python.h"
#include "editor/python/py_document.h"
#include "mesh_ops/base/counted.h"
#include "mesh_ops/deform/cage_coordinates/cage_deformation.h"
#include "mesh_ops/deform/cages/wrap.h"

using nlohmann::json;

namespace rebake {

namespace {

// Checks that an argument is an n × 3 array whose dtype kind is one of `kinds`. Throws FieldError for the argument
// `name`.
py::array checked_array(const py::object& given, const char* name, const char* kinds, const char* numbers) {
  const py::array array = py::array::ensure(given);
  if (!array) PyErr_Clear();
  if (!array || std::string_view(kinds).find(array.dtype().kind()) == std::string_view::npos || array.ndim() != 2 ||
      array.shape(1) != 3)
    throw FieldError(name, fmt::format("must be an array of n × 3 {}, not {}", numbers,
                                       array ? fmt::format("{} of shape {}", py::str(array.dtype()).cast<std::string>(),
                                                           py::str(array.attr("shape")).cast<std::string>())
                                             : py::str(py::type::of(given)).cast<std::string>()));
  return array;
}

std::vector<Vec3> points_from(const py::object& given, const char* name) {
  const py::array_t<double, py::array::c_style | py::array::forcecast> array =
      checked_array(given, name, "fiu", "numbers");
  std::vector<Vec3> points;
  const auto rows = array.unchecked<2>();
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) {
    points.emplace_back(rows(k, 0), rows(k, 1), rows(k, 2));
    if (!points.back().allFinite()) throw FieldError(name, fmt::format("row {} is not finite", k));
  }
  return points;
}
std::vector<Face> faces_from(const py::object& given, std::size_t points) {
  const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> array =
      checked_array(given, "faces", "iu", "whole numbers");
  std::vector<Face> faces;
  const auto rows = array.unchecked<2>();
  for (py::ssize_t k = 0; k < rows.shape(0); ++k) {
    Face& face = faces.emplace_back();
    for (py::ssize_t corner = 0; corner < 3; ++corner) {
      const std::int64_t number = rows(k, corner);
      if (number < 0 || static_cast<std::uint64_t>(number) >= points)
        throw FieldError("faces",
                         fmt::format("row {} contains vertex {}; there are {}, counted from 0", k, number, points));
      face[static_cast<std::size_t>(corner)] = static_cast<std::uint32_t>(number);
    }
  }
  return faces;
}
py::array_t<double> array_of(const std::vector<Vec3>& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  auto rows = array.mutable_unchecked<2>();
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int axis = 0; axis < 3; ++axis) rows(static_cast<py::ssize_t>(k), axis) = points[k][axis];
  return array;
}

py::array_t<double> move_by_cage(const py::object& points, const py::object& vertices, const py::object& faces,
                                 const py::object& moved, const std::string& kind, int resolution) {
  const std::vector<Vec3> places = points_from(points, "points"), targets = points_from(moved, "moved"),
                          corners = points_from(vertices, "vertices");
  const Cage cage = checked_cage({corners, faces_from(faces, corners.size())});
  if (targets.size() != cage.vertices.size()) throw FieldError("moved", "must have as many rows as vertices");
  const CageCoordinates coordinates = Codec<CageCoordinates>::read(json(kind), {});
  DeformedPoints deformed;
  run_without_gil(py::none(), [&](const Progress& progress) {
    const auto weights = coordinates_of(cage, coordinates, resolution, progress);
    deformed = deform_points(*weights, cage, targets, places, false, progress);
  });
  const std::vector<Vec3>& moved_places = deformed.points;
  if (const auto outside = std::count(deformed.outside.begin(), deformed.outside.end(), 1); outside > 0) {
    const auto first = std::find(deformed.outside.begin(), deformed.outside.end(), 1) - deformed.outside.begin();
    const std::string warning =
        fmt::format("{} outside the cage, where {} coordinates are undefined, and {} (first: row {})",
                    counted(static_cast<std::size_t>(outside), "point is", "points are"), kind,
                    outside == 1 ? "stays" : "stay", first);
    if (PyErr_WarnEx(PyExc_UserWarning, warning.c_str(), 1) != 0) throw py::error_already_set();
  }
  for (std::size_t k = 0; k < moved_places.size(); ++k)
    if (!moved_places[k].allFinite())
      throw FieldError("points", fmt::format("row {} is too far from the cage for coordinates", k));
  return array_of(moved_places);
}

py::tuple wrap_triangles(const py::object& points, const py::object& faces, double coarseness) {
  const std::vector<Vec3> places = points_from(points, "points");
  const TriangleList triangles{places, faces_from(faces, places.size())};
  Cage cage;
  run_without_gil(py::none(), [&](const Progress& progress) { cage = wrap(triangles, coarseness, progress); });
  py::array_t<std::uint32_t> numbers({static_cast<py::ssize_t>(cage.faces.size()), py::ssize_t{3}});
  if (!cage.faces.empty()) std::memcpy(numbers.mutable_data(), cage.faces.data(), cage.faces.size() * sizeof(Face));
  return py::make_tuple(array_of(cage.vertices), numbers);
}

}  // namespace

void add_geometry(py::module_& module) {
  module.def("move_by_cage", &move_by_cage, py::arg("points"), py::arg("vertices"), py::arg("faces"), py::arg("moved"),
             py::arg("coordinates") = "mean_value", py::arg("resolution") = 32,
             "Deforms points by a closed cage whose vertices move. Points outside the cage stay with Green's and "
             "harmonic coordinates, with a warning.");
  module.def("wrap", &wrap_triangles, py::arg("points"), py::arg("faces"), py::arg("coarseness") = 0.1,
             "Wraps triangles with a closed cage; returns its vertices and faces.");
}

}  // namespace rebake
