#include "mesh_ops/fill/hole_patch.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/fair.h>
#include <CGAL/Polygon_mesh_processing/refine.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>

namespace rebake {

namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

struct Corners {
  int a, b, c;
  Corners(int first, int second, int third) : a(first), b(second), c(third) {}
};

// Shows the progress of long triangulations, and ends them on cancellation.
class Steps : public pmp::Hole_filling::Default_visitor {
 public:
  Steps(std::size_t points, const Progress& progress) : points_(points), progress_(progress) {}
  void cubic_step() {
    constexpr std::size_t between = 4096;
    if (++done_ % between != 0) return;
    const auto pairs = static_cast<double>(points_ * points_) / 2;
    progress_.at(fmt::format("filling a hole of {} points", points_),
                 std::min(1.0, static_cast<double>(done_) / pairs));
  }

 private:
  std::size_t points_, done_ = 0;
  const Progress& progress_;
};

}  // namespace

HolePatch hole_patch(const HoleLoop& loop, const Progress& progress) {
  const Vec3 origin = loop.points.front();
  double size = 0;
  for (const Vec3& p : loop.points) size = std::max(size, (p - origin).norm());
  if (!(size > 0)) return {};
  // In units of the hole, so that thresholds inside CGAL fit.
  const auto point = [&](const Vec3& p) {
    const Vec3 local = (p - origin) / size;
    return Point(local.x(), local.y(), local.z());
  };
  std::vector<Point> border, outer;
  for (const Vec3& p : loop.points) border.push_back(point(p));
  for (const Vec3& p : loop.outer_points) outer.push_back(point(p));
  std::vector<Corners> coarse;
  // The search among Delaunay triangles is faster, but decides ties, as regular borders have, by memory addresses.
  Steps steps(border.size(), progress);
  pmp::triangulate_hole_polyline(border, outer, std::back_inserter(coarse),
                                 CGAL::parameters::use_delaunay_triangulation(false).visitor(std::ref(steps)));
  if (coarse.empty()) return {};
  Mesh mesh;
  std::vector<Mesh::Vertex_index> vertices;
  for (const Point& p : border) vertices.push_back(mesh.add_vertex(p));
  std::vector<Mesh::Face_index> faces;
  for (const Corners& t : coarse) {
    const auto face = mesh.add_face(vertices[static_cast<std::size_t>(t.a)], vertices[static_cast<std::size_t>(t.b)],
                                    vertices[static_cast<std::size_t>(t.c)]);
    if (face == Mesh::null_face()) return {};
    faces.push_back(face);
  }
  // The kept triangles along the border give its tangents.
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const auto a = vertices[k], b = vertices[(k + 1) % vertices.size()];
    auto half = mesh.halfedge(a, b);
    if (half == Mesh::null_halfedge()) continue;
    const bool forwards = mesh.is_border(mesh.opposite(half));
    const auto third = mesh.add_vertex(outer[k]);
    if (forwards)
      mesh.add_face(b, a, third);
    else
      mesh.add_face(a, b, third);
  }
  std::vector<Mesh::Vertex_index> inner;
  pmp::refine(mesh, faces, std::back_inserter(faces), std::back_inserter(inner));
  if (!inner.empty() && !pmp::fair(mesh, inner, CGAL::parameters::fairing_continuity(1))) return {};
  HolePatch patch;
  patch.vertices = loop.points;
  std::map<Mesh::Vertex_index, std::uint32_t> number;
  for (std::uint32_t k = 0; k < vertices.size(); ++k) number[vertices[k]] = k;
  for (const auto face : faces) {
    Face made;
    std::size_t corner = 0;
    for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face))) {
      const auto [it, fresh] = number.try_emplace(vertex, static_cast<std::uint32_t>(patch.vertices.size()));
      const Point& p = mesh.point(vertex);
      if (fresh) patch.vertices.push_back(origin + size * Vec3(p.x(), p.y(), p.z()));
      made[corner++] = it->second;
    }
    patch.faces.push_back(made);
  }
  for (const Vec3& p : patch.vertices)
    if (!p.allFinite()) return {};
  return patch;
}

}  // namespace rebake
