#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include "mesh_ops/deform/cages/cage_mesh.h"

namespace rebake {

std::size_t self_intersections(const Cage& cage) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Vec3& v : cage.vertices) vertices.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
  for (const Face& face : cage.faces) {
    // Faces without area intersect nothing, and CGAL's predicates do not accept them.
    const auto point = [&](std::size_t k) { return mesh.point(vertices[face[k]]); };
    if (CGAL::collinear(point(0), point(1), point(2))) continue;
    mesh.add_face(vertices[face[0]], vertices[face[1]], vertices[face[2]]);
  }
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

}  // namespace rebake
