#include "mesh_ops/deform/wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include "mesh_ops/error.h"

namespace rebake {

Cage wrap(const TriangleList& triangles, double coarseness) {
  if (!(coarseness >= 0.005 && coarseness <= 0.5)) throw FieldError("wrap", "must lie between 0.005 and 0.5");
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Box box;
  std::vector<std::vector<std::size_t>> faces;
  for (const Face& face : triangles.faces) {
    const Vec3 &a = triangles.points[face[0]], &b = triangles.points[face[1]], &c = triangles.points[face[2]];
    if (!a.allFinite() || !b.allFinite() || !c.allFinite()) continue;
    for (const Vec3* p : {&a, &b, &c}) box.extend(*p);
    faces.push_back({face[0], face[1], face[2]});
  }
  if (faces.empty()) throw Error("there is no triangle to put a cage around");
  const double diagonal = box.diagonal().stableNorm();
  if (!(diagonal > 0) || !std::isfinite(diagonal)) throw Error("the triangles have no extent to put a cage around");
  // In a box of diagonal 1: CGAL's constructions are not made for 1e±300.
  const Vec3 center = box.center();
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : triangles.points) {
    const Vec3 q = p.allFinite() ? Vec3((p - center) / diagonal) : Vec3(0, 0, 0);
    points.emplace_back(q.x(), q.y(), q.z());
  }
  Mesh mesh;
  CGAL::alpha_wrap_3(points, faces, coarseness, coarseness / 4, mesh);
  Cage cage;
  std::vector<std::uint32_t> number(mesh.num_vertices());
  for (const auto v : mesh.vertices()) {
    const Kernel::Point_3& p = mesh.point(v);
    number[v] = static_cast<std::uint32_t>(cage.vertices.size());
    cage.vertices.push_back(center + Vec3(p.x(), p.y(), p.z()) * diagonal);
  }
  for (const auto f : mesh.faces()) {
    Face face{};
    std::size_t k = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face[k++] = number[v];
    cage.faces.push_back(face);
  }
  return checked_cage(std::move(cage));
}

}  // namespace rebake
