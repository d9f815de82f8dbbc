#include "mesh_ops/deform/cage_coordinates/cage_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/cage_coordinates/plane_local.h"
#include "mesh_ops/deform/cage_coordinates/wide_frame.h"

namespace rebake {

namespace {

using Wide3 = std::array<Wide, 3>;

Wide3 wide(const Vec3& v) { return {Wide(v.x()), Wide(v.y()), Wide(v.z())}; }
Wide3 times(const Wide3& a, const Wide& s) { return {a[0] * s, a[1] * s, a[2] * s}; }
template <class R>
std::array<R, 3> rounded(const Wide3& a) {
  return {static_cast<R>(a[0]), static_cast<R>(a[1]), static_cast<R>(a[2])};
}

// The frame of a face, without edge numbers. Its height stays 0 if the face has no area.
template <class R>
FaceFrameOf<R> face_of(const Face& face, const std::array<Wide3, 3>& corners) {
  std::array<Wide, 3> squares;
  for (std::size_t k = 0; k < 3; ++k) {
    const Wide3 side = minus(corners[(k + 2) % 3], corners[(k + 1) % 3]);
    squares[k] = dot(side, side);
  }
  std::size_t longest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (squares[k] > squares[longest]) longest = k;
  FaceFrameOf<R> local;
  std::array<Wide3, 3> p;
  for (std::size_t k = 0; k < 3; ++k) {
    local.vertices[k] = face[(longest + k) % 3];
    p[k] = corners[(longest + k) % 3];
  }
  const Wide3 along = minus(p[2], p[1]);
  const Wide3 normal = cross(along, minus(p[0], p[1]));
  const Wide area = sqrt(dot(normal, normal));
  if (area == 0) return local;
  const Wide length = sqrt(dot(along, along));
  const Wide3 t = times(along, 1 / length), n = times(normal, 1 / area), o = cross(t, n);
  local.normal = rounded<R>(n);
  local.tangent = rounded<R>(t);
  local.outward = rounded<R>(o);
  local.length = static_cast<R>(length);
  local.height = static_cast<R>(Wide(area / length));
  local.apex = static_cast<R>(dot(minus(p[0], p[1]), t));
  for (std::size_t k = 0; k < 3; ++k) {
    const Wide3 side = minus(p[(k + 2) % 3], p[(k + 1) % 3]);
    const Wide side_length = sqrt(dot(side, side));
    const Wide along_t = dot(side, t) / side_length, along_o = dot(side, o) / side_length;
    local.lengths[k] = static_cast<R>(side_length);
    local.edge_t[k] = static_cast<R>(along_t);
    local.edge_o[k] = static_cast<R>(along_o);
    // Edge direction × face normal, with t × n = o and o × n = −t.
    local.normal_t[k] = static_cast<R>(Wide(-along_o));
    local.normal_o[k] = static_cast<R>(along_t);
  }
  return local;
}

Wide3 wide_local(const CageFrame& frame, const Vec3& point) {
  return times(minus(wide(point), wide(frame.center)), Wide(frame.scale));
}

}  // namespace

CageFrame frame_of(const Cage& cage) {
  const Box box = surface_box(cage);
  const std::vector<std::uint8_t> used = used_vertices(cage);
  if (box.isEmpty() || !box.sizes().allFinite() || box.sizes().maxCoeff() <= 0)
    throw Error("the cage has no extent, or coordinates out of range");
  CageFrame frame;
  frame.center = box.center();
  // Length of the diagonal; scaled first because squares of 1e±300 would overflow.
  int exponent = 0;
  std::frexp(box.sizes().maxCoeff(), &exponent);
  const double diagonal = (box.sizes() * std::ldexp(1.0, -exponent)).norm();
  frame.scale = std::ldexp(1.0, -exponent - std::ilogb(diagonal));
  frame.diagonal = std::ldexp(diagonal, -std::ilogb(diagonal));
  if (!std::isfinite(frame.scale)) throw Error("the cage is too small");
  const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff() * frame.scale;
  frame.surface_tolerance =
      std::max(plane_local::surface_tolerance<double>, 2 * std::numeric_limits<double>::epsilon() * farthest);
  std::vector<Wide3> points;
  frame.given = cage.vertices;
  for (std::size_t v = 0; v < cage.vertices.size(); ++v) {
    // Unused ones may lie anywhere, even where local coordinates overflow.
    const Vec3& place = used[v] != 0 ? cage.vertices[v] : frame.center;
    frame.vertices.push_back(frame.to_local(place));
    points.push_back(wide_local(frame, place));
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  const auto edge_of = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [place, added] = edges.emplace(std::pair(a, b), static_cast<std::uint32_t>(frame.edges.size()));
    if (added) {
      const Wide3 along = minus(points[b], points[a]);
      const Wide length = sqrt(dot(along, along));
      frame.edges.push_back({a, b, rounded<double>(times(along, 1 / length)), static_cast<double>(length)});
    }
    return place->second;
  };
  for (std::uint32_t f = 0; f < cage.faces.size(); ++f) {
    const Face& face = cage.faces[f];
    FaceFrame local = face_of<double>(face, {points[face[0]], points[face[1]], points[face[2]]});
    if (!(local.height > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k)
      local.edges[k] = edge_of(local.vertices[(k + 1) % 3], local.vertices[(k + 2) % 3]);
    frame.faces.push_back(local);
    frame.face_numbers.push_back(f);
  }
  return frame;
}

std::array<Wide, 3> wide_local_point(const CageFrame& cage, const Vec3& point) {
  return rounded<Wide>(wide_local(cage, point));
}

WideFace wide_face(const CageFrame& cage, const FaceFrame& face) {
  std::array<Wide3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = wide_local(cage, cage.given[face.vertices[k]]);
  WideFace wide{face_of<Wide>(face.vertices, corners), {}};
  for (std::size_t k = 0; k < 3; ++k) wide.corners[k] = rounded<Wide>(corners[k]);
  return wide;
}

}  // namespace rebake
