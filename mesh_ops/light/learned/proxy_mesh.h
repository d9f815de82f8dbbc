#pragma once

#include <memory>
#include <vector>

#include "mesh_ops/light/transport/light_sites.h"

namespace rebake {

/// A smooth mesh that represents an object's visible surface; models learn the transfer at its vertices.
struct ProxyMesh {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

Box bounds(const ProxyMesh& mesh);

/// Rotation of the surface around each vertex between two poses with the same faces: the rotation part of the
/// area-weighted mean motion of its triangles.
std::vector<Mat3> vertex_rotations(const ProxyMesh& rest, const ProxyMesh& posed);

/// Sites at the vertices, with smooth normals; tangents rotate with the surface. Rays start one mesh cell above the
/// mesh, because it only approximates the surface.
std::vector<LightSite> vertex_sites(const ProxyMesh& rest, const ProxyMesh& posed, const std::vector<Mat3>& turns);

/// The mesh as an opaque object.
std::shared_ptr<const BakedObject> solid_object(const ProxyMesh& mesh);

}  // namespace rebake
