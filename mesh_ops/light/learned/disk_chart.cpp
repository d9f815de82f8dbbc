#include "mesh_ops/light/learned/disk_chart.h"

#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_parameterization/Discrete_conformal_map_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Mean_value_coordinates_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/Square_border_parameterizer_3.h>
#include <CGAL/Surface_mesh_parameterization/parameterize.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

namespace layout = CGAL::Surface_mesh_parameterization;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Border = layout::Square_border_arc_length_parameterizer_3<Mesh>;

// Signed area of a face on the unit square; negative if the face is flipped.
double area_of(const DiskChart& chart, const Face& face) {
  const Vec2 e = chart.uvs[face[1]] - chart.uvs[face[0]], f = chart.uvs[face[2]] - chart.uvs[face[0]];
  return (e.x() * f.y() - e.y() * f.x()) / 2;
}

// Whether a face has no area or is flipped. Faces with all corners on one side of the square have none, however they
// are laid out.
bool folds(const DiskChart& chart) {
  return !std::all_of(chart.faces.begin(), chart.faces.end(), [&](const Face& face) {
    const Vec2 &a = chart.uvs[face[0]], &b = chart.uvs[face[1]], &c = chart.uvs[face[2]];
    for (Eigen::Index axis = 0; axis < 2; ++axis)
      for (const double side : {0.0, 1.0})
        if (a[axis] == side && b[axis] == side && c[axis] == side) return true;
    return area_of(chart, face) > 0;
  });
}

using Halfedge = Mesh::Halfedge_index;
using Vertex = Mesh::Vertex_index;

double distance(const Mesh& mesh, Vertex a, Vertex b) {
  return std::sqrt(CGAL::squared_distance(mesh.point(a), mesh.point(b)));
}

// Four vertices of the border for the corners of the square: the one with the sharpest angle, and those nearest to a
// quarter, half and three quarters of the border's length from it.
std::array<Vertex, 4> sharp_corners(const Mesh& mesh, Halfedge border) {
  std::vector<Vertex> loop;
  std::vector<double> from_start{0};
  for (const Halfedge h : CGAL::halfedges_around_face(border, mesh)) {
    loop.push_back(mesh.target(h));
    if (loop.size() > 1) from_start.push_back(from_start.back() + distance(mesh, loop.back(), loop[loop.size() - 2]));
  }
  const std::size_t count = loop.size();
  const double length = from_start.back() + distance(mesh, loop.back(), loop[0]);
  std::size_t sharpest = 0;
  double least = 2;
  for (std::size_t k = 0; k < count; ++k) {
    const auto before = mesh.point(loop[(k + count - 1) % count]) - mesh.point(loop[k]),
               after = mesh.point(loop[(k + 1) % count]) - mesh.point(loop[k]);
    const double straightness = -(before * after) / std::sqrt(before.squared_length() * after.squared_length());
    if (straightness < least) {
      least = straightness;
      sharpest = k;
    }
  }
  std::array<Vertex, 4> corners{loop[sharpest]};
  for (std::size_t k = 1; k < 4; ++k) {
    const double wanted = std::fmod(from_start[sharpest] + static_cast<double>(k) * length / 4, length);
    const auto off = [&](std::size_t at) {
      const double d = std::abs(from_start[at] - wanted);
      return std::min(d, length - d);
    };
    std::size_t best = 0;
    for (std::size_t v = 1; v < count; ++v)
      if (off(v) < off(best)) best = v;
    corners[k] = loop[best];
  }
  return corners;
}

template <class Parameterizer>
void lay_out(Mesh& mesh, DiskChart& chart, const Parameterizer& parameterizer) {
  const Halfedge border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
  auto uvs = mesh.add_property_map<Vertex, Kernel::Point_2>("v:uv").first;
  const layout::Error_code code = layout::parameterize(mesh, parameterizer, border, uvs);
  if (code != layout::OK)
    throw Error(fmt::format("the mesh cannot be parametrised over a square: {}", layout::get_error_message(code)));
  for (const auto v : mesh.vertices()) chart.uvs[v] = {uvs[v].x(), uvs[v].y()};
  // CGAL orders the border against the orientation of the triangles; mirroring restores the orientation.
  double area = 0;
  for (const Face& face : chart.faces) area += area_of(chart, face);
  if (area < 0)
    for (Vec2& uv : chart.uvs) uv.x() = 1 - uv.x();
}

using Harmonic = layout::Discrete_conformal_map_parameterizer_3<Mesh, Border>;
using MeanValue = layout::Mean_value_coordinates_parameterizer_3<Mesh, Border>;

}  // namespace

DiskChart disk_chart(const ProxyMesh& mesh, int tips) {
  DiskChart chart = cut_along(mesh, seams_of(mesh, tips));
  Mesh disk;
  for (const std::uint32_t v : chart.source) {
    const Vec3& p = mesh.vertices[v];
    disk.add_vertex(Kernel::Point_3(p.x(), p.y(), p.z()));
  }
  for (const Face& face : chart.faces)
    if (disk.add_face(Mesh::Vertex_index(face[0]), Mesh::Vertex_index(face[1]), Mesh::Vertex_index(face[2])) ==
        Mesh::null_face())
      throw Error("the mesh is not manifold: two fans of triangles share one vertex");
  chart.uvs.resize(chart.source.size());
  const Halfedge border = CGAL::Polygon_mesh_processing::longest_border(disk).first;
  // Corners of an open mesh belong on corners of the square; a cut has none.
  const bool open = chart.source.size() == mesh.vertices.size();
  const auto [a, b, c, d] = sharp_corners(disk, border);
  // Few, uneven edges may put two corners on one vertex.
  const bool distinct = std::set<Vertex>{a, b, c, d}.size() == 4;
  const Border square = open && distinct ? Border(a, b, c, d) : Border();
  lay_out(disk, chart, Harmonic(square));
  chart.mean_value = folds(chart);
  if (chart.mean_value) lay_out(disk, chart, MeanValue(square));
  return chart;
}

}  // namespace rebake
