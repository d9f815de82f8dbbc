#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <sstream>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

struct ManifoldTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
/// A halfedge mesh of oriented triangles, for meshes that are manifold: cages, wraps and proxy bodies. Soups are not.
using ManifoldMesh = OpenMesh::TriMesh_ArrayKernelT<ManifoldTraits>;

/// Builds a halfedge mesh with the same numbers of vertices and faces. Throws Error for a vertex index out of range, a
/// face that uses a vertex twice, an edge of more than two faces, adjacent faces of opposite orientation, and a closed
/// fan of faces that shares its vertex with another face.
ManifoldMesh manifold_mesh(const std::vector<Vec3>& vertices, const std::vector<Face>& faces);

/// The vertices of an edge, lower index first.
std::pair<std::uint32_t, std::uint32_t> vertices_of(const ManifoldMesh& mesh, ManifoldMesh::EdgeHandle edge);

/// While it exists, messages of OpenMesh are collected instead of printed; it reports some errors in no other way. The
/// redirection is global: objects must not be nested, nor exist on two threads.
class OpenMeshMessages {
 public:
  OpenMeshMessages();
  ~OpenMeshMessages();
  OpenMeshMessages(const OpenMeshMessages&) = delete;
  OpenMeshMessages& operator=(const OpenMeshMessages&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
};

}  // namespace rebake
