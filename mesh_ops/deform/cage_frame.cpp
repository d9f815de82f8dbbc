#include "mesh_ops/deform/cage_frame.h"

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <map>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Wide = boost::multiprecision::cpp_bin_float_50;
using Wide3 = std::array<Wide, 3>;

Wide3 wide(const Vec3& v) { return {Wide(v.x()), Wide(v.y()), Wide(v.z())}; }
Wide3 minus(const Wide3& a, const Wide3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Wide dot(const Wide3& a, const Wide3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Wide3 cross(const Wide3& a, const Wide3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Wide3 times(const Wide3& a, const Wide& s) { return {a[0] * s, a[1] * s, a[2] * s}; }
std::array<double, 3> rounded(const Wide3& a) {
  return {static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2])};
}

}  // namespace

CageFrame frame_of(const Cage& cage) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  if (box.isEmpty() || !box.sizes().allFinite() || box.sizes().maxCoeff() <= 0) throw Error("the cage has no extent");
  CageFrame frame;
  frame.center = box.center();
  // The diagonal's length without squaring what may be 1e±300.
  int exponent = 0;
  std::frexp(box.sizes().maxCoeff(), &exponent);
  const double diagonal = (box.sizes() * std::ldexp(1.0, -exponent)).norm();
  frame.scale = std::ldexp(1.0, -exponent - std::ilogb(diagonal));
  if (!std::isfinite(frame.scale)) throw Error("the cage is too small");
  std::vector<Wide3> points;
  for (const Vec3& v : cage.vertices) {
    frame.vertices.push_back(frame.to_local(v));
    points.push_back(times(minus(wide(v), wide(frame.center)), Wide(frame.scale)));
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
  const auto edge_of = [&](std::uint32_t a, std::uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [place, added] = edges.emplace(std::pair(a, b), static_cast<std::uint32_t>(frame.edges.size()));
    if (added) {
      const Wide3 along = minus(points[b], points[a]);
      const Wide length = sqrt(dot(along, along));
      frame.edges.push_back({a, b, rounded(times(along, 1 / length)), static_cast<double>(length)});
    }
    return place->second;
  };
  for (std::uint32_t f = 0; f < cage.faces.size(); ++f) {
    const Face& face = cage.faces[f];
    std::array<Wide, 3> squares;
    for (std::size_t k = 0; k < 3; ++k) {
      const Wide3 side = minus(points[face[(k + 2) % 3]], points[face[(k + 1) % 3]]);
      squares[k] = dot(side, side);
    }
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (squares[k] > squares[longest]) longest = k;
    FaceFrame local;
    for (std::size_t k = 0; k < 3; ++k) local.vertices[k] = face[(longest + k) % 3];
    const Wide3 &p0 = points[local.vertices[0]], &p1 = points[local.vertices[1]], &p2 = points[local.vertices[2]];
    const Wide3 along = minus(p2, p1);
    const Wide3 normal = cross(along, minus(p0, p1));
    const Wide area = sqrt(dot(normal, normal));
    if (area == 0) continue;
    const Wide length = sqrt(dot(along, along));
    const Wide3 t = times(along, 1 / length), n = times(normal, 1 / area), o = cross(t, n);
    local.normal = rounded(n);
    local.tangent = rounded(t);
    local.outward = rounded(o);
    local.length = static_cast<double>(length);
    local.height = static_cast<double>(area / length);
    local.apex = static_cast<double>(dot(minus(p0, p1), t));
    if (!(local.height > 0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Wide3 side = minus(points[local.vertices[(k + 2) % 3]], points[local.vertices[(k + 1) % 3]]);
      const Wide side_length = sqrt(dot(side, side));
      const Wide along_t = dot(side, t) / side_length, along_o = dot(side, o) / side_length;
      local.lengths[k] = static_cast<double>(side_length);
      local.edge_t[k] = static_cast<double>(along_t);
      local.edge_o[k] = static_cast<double>(along_o);
      // tangent × normal, with t × n = o and o × n = −t.
      local.normal_t[k] = static_cast<double>(-along_o);
      local.normal_o[k] = static_cast<double>(along_t);
      local.edges[k] = edge_of(local.vertices[(k + 1) % 3], local.vertices[(k + 2) % 3]);
    }
    frame.faces.push_back(local);
    frame.face_numbers.push_back(f);
  }
  return frame;
}

}  // namespace rebake
