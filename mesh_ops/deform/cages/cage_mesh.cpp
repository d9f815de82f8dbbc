#include "mesh_ops/deform/cages/cage_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/union_find.h"

namespace rebake {

Cage lattice_cage(const Box& box, int n, int m, int k) {
  if (std::min({n, m, k}) < 1) throw Error("a lattice needs at least one cell along each axis");
  const std::array<std::int64_t, 3> cells{n, m, k};
  const double surface = 2.0 * ((n + 1.0) * (m + 1.0) + (m + 1.0) * (k + 1.0) + (n + 1.0) * (k + 1.0));
  if (surface > 100000) throw Error("the lattice is too fine: at most 100,000 points on its surface");
  Cage cage;
  std::map<std::array<std::int64_t, 3>, std::uint32_t> numbers;
  for (std::int64_t z = 0; z <= k; ++z)
    for (std::int64_t y = 0; y <= m; ++y) {
      const bool side = z == 0 || z == k || y == 0 || y == m;
      for (std::int64_t x = 0; x <= n; x += side ? 1 : n) {
        numbers[{x, y, z}] = static_cast<std::uint32_t>(cage.vertices.size());
        Vec3 p;
        const std::array<std::int64_t, 3> at{x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          const auto a = static_cast<std::size_t>(axis);
          const double share = static_cast<double>(at[a]) / static_cast<double>(cells[a]);
          p[axis] = (1 - share) * box.min()[axis] + share * box.max()[axis];
        }
        cage.vertices.push_back(p);
      }
    }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool high : {false, true})
      for (std::int64_t i = 0; i < cells[u]; ++i)
        for (std::int64_t j = 0; j < cells[v]; ++j) {
          const auto corner = [&](std::int64_t du, std::int64_t dv) {
            std::array<std::int64_t, 3> at{};
            at[axis] = high ? cells[axis] : 0;
            at[u] = i + du;
            at[v] = j + dv;
            return numbers.at(at);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (high) {
            cage.faces.push_back({a, b, c});
            cage.faces.push_back({a, c, d});
          } else {
            cage.faces.push_back({a, c, b});
            cage.faces.push_back({a, d, c});
          }
        }
  }
  return cage;
}

std::vector<std::uint8_t> used_vertices(const Cage& cage) {
  std::vector<std::uint8_t> used(cage.vertices.size(), 0);
  for (const Face& face : cage.faces)
    for (const std::uint32_t v : face) used[v] = 1;
  return used;
}

Box surface_box(const Cage& cage) {
  Box box;
  for (const Face& face : cage.faces)
    for (const std::uint32_t v : face) box.extend(cage.vertices[v]);
  return box;
}

double volume(const Cage& cage) {
  const Box box = surface_box(cage);
  if (box.isEmpty()) return 0;
  // 50 digits: for a rod that is 1e8 times as long as wide, the volume would be lost in the rounding of double.
  using Exact = boost::multiprecision::cpp_bin_float_50;
  using Wide3 = std::array<Exact, 3>;
  const Vec3 origin = box.center();
  const auto from_origin = [&](std::uint32_t v) {
    const Vec3& p = cage.vertices[v];
    return Wide3{Exact(p.x()) - origin.x(), Exact(p.y()) - origin.y(), Exact(p.z()) - origin.z()};
  };
  Exact sum = 0;
  for (const Face& face : cage.faces) {
    const Wide3 a = from_origin(face[0]), b = from_origin(face[1]), c = from_origin(face[2]);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      sum += a[i] * (b[j] * c[k] - b[k] * c[j]);
    }
  }
  return static_cast<double>(Exact(sum / 6));
}

std::vector<std::uint32_t> components(const Cage& cage) {
  UnionFind parts(cage.vertices.size());
  for (const Face& face : cage.faces)
    for (std::size_t k = 1; k < 3; ++k) parts.join(face[0], face[k]);
  std::vector<std::uint32_t> lowest;
  for (std::uint32_t v = 0; v < cage.vertices.size(); ++v) lowest.push_back(parts.root(v));
  return lowest;
}

namespace {

// Winding number of a closed surface around a point that is not on it (Van Oosterom, Strackee 1983).
double winding_around(const Vec3& point, const Cage& part) {
  double angle = 0;
  for (const Face& face : part.faces) {
    const Vec3 a = part.vertices[face[0]] - point, b = part.vertices[face[1]] - point,
               c = part.vertices[face[2]] - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * elementary::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

// The parts of a cage by their lowest vertex, each with all vertices.
std::map<std::uint32_t, Cage> parts_of(const Cage& cage, const std::vector<std::uint32_t>& of_vertex) {
  std::map<std::uint32_t, Cage> parts;
  for (const Face& face : cage.faces) parts[of_vertex[face[0]]].faces.push_back(face);
  for (auto& [first, part] : parts) part.vertices = cage.vertices;
  return parts;
}

// A point on the other surface has a winding number of about ½.
constexpr double clearly_inside = 0.75;

// Per face, 1 if it must be flipped. Components that lie inside no other one must face outwards; components inside
// those are flipped along with them, so a cavity stays a cavity.
std::vector<std::uint8_t> faces_to_flip(const Cage& cage) {
  const std::vector<std::uint32_t> of_vertex = components(cage);
  const std::map<std::uint32_t, Cage> parts = parts_of(cage, of_vertex);
  const auto lies_in = [&](std::uint32_t inner, const Cage& outer) {
    return std::abs(winding_around(cage.vertices[inner], outer)) > clearly_inside;
  };
  std::map<std::uint32_t, std::uint32_t> outermost;
  for (const auto& [first, part] : parts) {
    outermost[first] = first;
    if (parts.size() == 1) continue;
    for (const auto& [other, around] : parts) {
      if (other == first || !lies_in(first, around)) continue;
      const bool is_free = std::none_of(parts.begin(), parts.end(), [&](const auto& third) {
        return third.first != other && lies_in(other, third.second);
      });
      if (is_free) outermost[first] = other;
    }
  }
  std::map<std::uint32_t, bool> inwards;
  for (const auto& [first, part] : parts) inwards[first] = volume(part) < 0;
  std::vector<std::uint8_t> turn;
  for (const Face& face : cage.faces) turn.push_back(inwards[outermost[of_vertex[face[0]]]] ? 1 : 0);
  return turn;
}

}  // namespace

std::size_t nested_components(const Cage& cage) {
  const std::map<std::uint32_t, Cage> parts = parts_of(cage, components(cage));
  std::size_t nested = 0;
  for (const auto& [first, part] : parts) {
    if (parts.size() == 1 || volume(part) < 0) continue;
    double winding = 0;
    for (const auto& [other, around] : parts)
      if (other != first) winding += winding_around(cage.vertices[first], around);
    nested += winding > clearly_inside ? 1 : 0;
  }
  return nested;
}

Cage checked_cage(Cage cage) {
  if (cage.faces.size() < 4) throw Error("the cage has fewer than four triangles: it cannot be closed");
  for (std::size_t v = 0; v < cage.vertices.size(); ++v)
    if (!cage.vertices[v].allFinite()) throw Error(fmt::format("cage point {} is not finite", v));
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed;
  for (std::size_t f = 0; f < cage.faces.size(); ++f) {
    const Face& face = cage.faces[f];
    for (std::size_t k = 0; k < 3; ++k) {
      if (face[k] >= cage.vertices.size())
        throw Error(fmt::format("cage triangle {} uses point {}, which does not exist", f, face[k]));
      if (face[k] == face[(k + 1) % 3]) throw Error(fmt::format("cage triangle {} uses point {} twice", f, face[k]));
      ++directed[{face[k], face[(k + 1) % 3]}];
    }
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : directed) {
    if (count > 1)
      throw Error(fmt::format(
          "the cage edge from point {} to point {} belongs to several triangles in the same direction: the surface is "
          "non-manifold or inconsistently oriented there",
          edge.first, edge.second));
    if (!directed.contains({edge.second, edge.first})) ++open;
  }
  if (open > 0)
    throw Error(fmt::format("the cage is open: {} of its edges belong to one triangle only; close the holes", open));
  // The longest side of the box decides, since a cage may be thin.
  const Box box = surface_box(cage);
  const double extent = box.sizes().maxCoeff();
  if (!(extent > 0) || !std::isfinite(extent) || extent < 1e-150)
    throw Error("the cage has no extent, or coordinates out of range");
  Cage scaled = cage;
  for (Vec3& v : scaled.vertices) v = (v - box.center()) / extent;
  const std::vector<std::uint8_t> turn = faces_to_flip(scaled);
  for (std::size_t f = 0; f < turn.size(); ++f)
    if (turn[f] != 0) {
      std::swap(cage.faces[f][1], cage.faces[f][2]);
      std::swap(scaled.faces[f][1], scaled.faces[f][2]);
    }
  const double inside = volume(scaled);
  // Relative to the area: a cage of any shape with a volume has a mean thickness above rounding.
  double surface = 0;
  for (const Face& face : scaled.faces)
    surface += (scaled.vertices[face[1]] - scaled.vertices[face[0]])
                   .cross(scaled.vertices[face[2]] - scaled.vertices[face[0]])
                   .norm() /
               2;
  if (!(inside > 1e-15 * surface)) throw Error("the cage encloses nothing: its volume is zero");
  return cage;
}

}  // namespace rebake
