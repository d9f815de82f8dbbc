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

bool folds(const DiskChart& chart) {
  return !std::all_of(chart.faces.begin(), chart.faces.end(),
                      [&](const Face& face) { return area_of(chart, face) > 0; });
}

template <class Parameterizer>
void lay_out(Mesh& mesh, DiskChart& chart) {
  const auto border = CGAL::Polygon_mesh_processing::longest_border(mesh).first;
  auto uvs = mesh.add_property_map<Mesh::Vertex_index, Kernel::Point_2>("v:uv").first;
  const layout::Error_code code = layout::parameterize(mesh, Parameterizer(), border, uvs);
  if (code != layout::OK)
    throw Error(fmt::format("the mesh cannot be parametrised over a square: {}", layout::get_error_message(code)));
  for (const auto v : mesh.vertices()) chart.uvs[v] = {uvs[v].x(), uvs[v].y()};
  // CGAL orders the border against the orientation of the triangles; mirroring restores the orientation.
  double area = 0;
  for (const Face& face : chart.faces) area += area_of(chart, face);
  if (area < 0)
    for (Vec2& uv : chart.uvs) uv.x() = 1 - uv.x();
}

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
  lay_out<layout::Discrete_conformal_map_parameterizer_3<Mesh, Border>>(disk, chart);
  if (folds(chart)) lay_out<layout::Mean_value_coordinates_parameterizer_3<Mesh, Border>>(disk, chart);
  return chart;
}

}  // namespace rebake
