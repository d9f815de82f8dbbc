#include "mesh_ops/light/learned/proxy_mesh.h"

#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <cmath>

#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

// Columns: two edges and the normal, which is scaled to the size of the edges.
Mat3 frame_of(const ProxyMesh& mesh, const Face& face) {
  const Vec3 e = mesh.vertices[face[1]] - mesh.vertices[face[0]], f = mesh.vertices[face[2]] - mesh.vertices[face[0]];
  const Vec3 normal = e.cross(f);
  const double length = normal.stableNorm();
  Mat3 frame;
  frame << e, f, (length > 0 ? Vec3(normal / std::sqrt(length)) : Vec3(0, 0, 0));
  return frame;
}

std::vector<Vec3> vertex_normals(const ProxyMesh& mesh) {
  std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
  for (const Face& face : mesh.faces) {
    const Vec3& a = mesh.vertices[face[0]];
    const Vec3 normal = (mesh.vertices[face[1]] - a).cross(mesh.vertices[face[2]] - a);
    for (const std::uint32_t v : face) normals[v] += normal;
  }
  for (Vec3& normal : normals) normal = normal.stableNorm() > 0 ? normal.stableNormalized() : Vec3(0, 0, 0);
  return normals;
}

}  // namespace

Box bounds(const ProxyMesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.vertices) box.extend(p);
  return box;
}

std::vector<Mat3> vertex_rotations(const ProxyMesh& rest, const ProxyMesh& posed) {
  std::vector<Mat3> sums(rest.vertices.size(), Mat3::Zero());
  for (const Face& face : rest.faces) {
    const Mat3 before = frame_of(rest, face);
    const double area = before.col(0).cross(before.col(1)).stableNorm();
    if (!(area > 0)) continue;
    const Mat3 motion = frame_of(posed, face) * before.inverse();
    if (!motion.allFinite()) continue;
    for (const std::uint32_t v : face) sums[v] += area * motion;
  }
  tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t v) {
    sums[v] = sums[v].isZero(0) ? Mat3(Mat3::Identity()) : local_rotation(sums[v]).rotation;
  });
  return sums;
}

std::vector<LightSite> vertex_sites(const ProxyMesh& rest, const ProxyMesh& posed, const std::vector<Mat3>& turns) {
  const std::vector<Vec3> normals = vertex_normals(posed), before = vertex_normals(rest);
  // Width of a mesh cell: the longest posed edge at the vertex.
  std::vector<double> cells(posed.vertices.size(), 0);
  for (const Face& face : posed.faces)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % 3];
      const double length = (posed.vertices[a] - posed.vertices[b]).norm();
      cells[a] = std::max(cells[a], length);
      cells[b] = std::max(cells[b], length);
    }
  std::vector<LightSite> sites;
  for (std::size_t v = 0; v < posed.vertices.size(); ++v) {
    LightSite site{posed.vertices[v], normals[v], Vec3::Zero(), {cells[v], cells[v]}};
    if (!before[v].isZero(0) && !normals[v].isZero(0)) {
      const Vec3 tangent = turns[v] * before[v].unitOrthogonal();
      site.tangent = (tangent - tangent.dot(site.normal) * site.normal).stableNormalized();
    }
    sites.push_back(site);
  }
  return sites;
}

std::shared_ptr<const BakedObject> solid_object(const ProxyMesh& mesh) {
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back(
      {Soup(mesh.vertices, std::vector<Vec2>(mesh.vertices.size(), Vec2(0.5, 0.5)), mesh.faces),
       std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(1, 1, AlphaCode::plain, [](int, Texel* row) {
         row->feat0 = {255, 128, 128, 128};
       }))});
  object->decoder = std::make_shared<const Decoder>();
  return object;
}

}  // namespace rebake
