#include "mesh_ops/deform/handles.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_deformation.h>

#include <algorithm>

#include "mesh_ops/base/error.h"

namespace rebake {

HandledCage as_rigid_as_possible(const Cage& cage, const std::vector<HandledVertex>& held, int iterations) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  if (held.empty()) throw Error("no cage point is held; fix some and move some");
  // In a box of diagonal 1, as the solver's tolerances expect.
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  const double size = box.diagonal().stableNorm();
  const auto in = [&](const Vec3& v) {
    const Vec3 p = (v - box.center()) / size;
    return Kernel::Point_3(p.x(), p.y(), p.z());
  };
  const std::vector<std::uint32_t> component = components(cage);
  std::vector<std::uint8_t> has_held(cage.vertices.size(), 0), used(cage.vertices.size(), 0);
  for (const HandledVertex& h : held) has_held[component[h.vertex]] = 1;
  HandledCage result{cage.vertices, 0};
  Mesh mesh;
  std::vector<Mesh::Vertex_index> number(cage.vertices.size());
  for (const Face& face : cage.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  if (std::none_of(held.begin(), held.end(), [&](const HandledVertex& h) { return used[h.vertex] != 0; }))
    throw Error("none of the held points belongs to a triangle of the cage; fix some that do");
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
    if (used[v] == 0) continue;
    if (component[v] == v && has_held[v] == 0) ++result.free_components;
    if (has_held[component[v]] != 0) number[v] = mesh.add_vertex(in(cage.vertices[v]));
  }
  for (const Face& face : cage.faces)
    if (has_held[component[face[0]]] != 0 &&
        mesh.add_face(number[face[0]], number[face[1]], number[face[2]]) == Mesh::null_face())
      throw Error("two parts of the cage meet in a single point: handles need a cage without such places");
  CGAL::Surface_mesh_deformation<Mesh> deformation(mesh);
  for (const auto v : mesh.vertices()) deformation.insert_roi_vertex(v);
  // A point of no face is held where it is asked to be, and moves nothing else.
  for (const HandledVertex& h : held)
    if (used[h.vertex] != 0) deformation.insert_control_vertex(number[h.vertex]);
  if (!deformation.preprocess()) throw Error("the handles do not determine the cage; fix some more points");
  for (const HandledVertex& h : held)
    if (used[h.vertex] != 0) deformation.set_target_position(number[h.vertex], in(h.place));
  deformation.deform(static_cast<unsigned>(iterations), 0);
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) {
    if (used[v] == 0 || has_held[component[v]] == 0) continue;
    const Kernel::Point_3& p = mesh.point(number[v]);
    result.vertices[v] = box.center() + Vec3(p.x(), p.y(), p.z()) * size;
  }
  // Held points are where they were asked to be, bit for bit.
  for (const HandledVertex& h : held) result.vertices[h.vertex] = h.place;
  return result;
}

}  // namespace rebake
