#include "mesh_ops/mesh/manifold_mesh.h"

#include <algorithm>
#include <iostream>

#include "mesh_ops/base/error.h"

namespace rebake {

OpenMeshMessages::OpenMeshMessages() {
  omerr().connect(text_);
  omerr().disconnect(std::cerr);
}

OpenMeshMessages::~OpenMeshMessages() {
  omerr().disconnect(text_);
  omerr().connect(std::cerr);
}

ManifoldMesh manifold_mesh(const std::vector<Vec3>& vertices, const std::vector<Face>& faces) {
  ManifoldMesh mesh;
  mesh.reserve(vertices.size(), faces.size() * 3 / 2, faces.size());
  std::vector<ManifoldMesh::VertexHandle> handles;
  for (const Vec3& v : vertices) handles.push_back(mesh.add_vertex({v.x(), v.y(), v.z()}));
  const auto is_taken = [&](std::uint32_t from, std::uint32_t to) {
    const auto halfedge = mesh.find_halfedge(handles[from], handles[to]);
    return halfedge.is_valid() && !mesh.is_boundary(halfedge);
  };
  const OpenMeshMessages messages;
  for (const Face& face : faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % 3];
      if (a == b || a >= vertices.size() || b >= vertices.size())
        throw Error("a triangle uses a vertex twice, or a vertex index out of range");
      if (!is_taken(a, b)) continue;
      throw Error(is_taken(b, a) ? "the mesh is not manifold: more than two triangles share an edge"
                                 : "the mesh is not consistently oriented: two adjacent triangles face opposite ways");
    }
    if (!mesh.add_face(handles[face[0]], handles[face[1]], handles[face[2]]).is_valid())
      throw Error("the mesh is not manifold: two fans of triangles share one vertex");
  }
  return mesh;
}

std::pair<std::uint32_t, std::uint32_t> vertices_of(const ManifoldMesh& mesh, ManifoldMesh::EdgeHandle edge) {
  const auto halfedge = mesh.halfedge_handle(edge, 0);
  const auto a = static_cast<std::uint32_t>(mesh.from_vertex_handle(halfedge).idx()),
             b = static_cast<std::uint32_t>(mesh.to_vertex_handle(halfedge).idx());
  return std::minmax(a, b);
}

}  // namespace rebake
