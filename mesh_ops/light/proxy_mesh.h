#pragma once

#include <memory>
#include <vector>

#include "mesh_ops/light/light_sites.h"

namespace rebake {

/// A smooth mesh that stands for what an object's triangles show, its vertices the points whose transfer is learnt.
struct ProxyMesh {
  std::vector<Vec3> vertices;
  std::vector<Face> faces;
};

Box bounds(const ProxyMesh& mesh);

/// How the surface around each vertex turned from one pose to another of the same faces: the rotation in the mean of
/// its triangles' motions, weighted by area.
std::vector<Mat3> vertex_turns(const ProxyMesh& rest, const ProxyMesh& posed);

/// The vertices as points that light falls on, with smooth normals; tangents turn with the surface. Rays start one mesh
/// cell above it, as that is where a mesh stands for a smooth surface.
std::vector<LightSite> vertex_sites(const ProxyMesh& rest, const ProxyMesh& posed, const std::vector<Mat3>& turns);

/// The mesh as an object that lets no ray through.
std::shared_ptr<const BakedObject> solid_object(const ProxyMesh& mesh);

}  // namespace rebake
