#include "editor/edits/nodes/drop.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <stdexcept>
#include <unordered_map>
#include <vector>

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/transform.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/opacity.h"
#include "mesh_ops/index/traits.h"
#include "mesh_ops/rays/scene_rays.h"

namespace rebake {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Ids of the node and all its descendants.
std::set<NodeId> subtree(const Scene& scene, NodeId id) {
  std::set<NodeId> ids = {id};
  for (const PlacedNode& placed : placed_nodes(scene))
    if (ids.contains(placed.node->id))
      for (const NodePtr& child : placed.node->children) ids.insert(child->id);
  return ids;
}

// Placed objects in world space: the triangles that contain an opaque texel, and a ray tracer.
struct Body {
  std::vector<PlacedNode> nodes;
  SceneRays rays;
  std::vector<std::array<Vec3, 3>> triangles;
  Box box;  ///< bounds of the triangles in the ground's frame, with y along its normal

  Body(std::vector<PlacedNode> of, const Mat3& to_ground) : nodes(std::move(of)), rays(rays_through(nodes)) {
    for (const PlacedNode& placed : nodes)
      for (const TextureSet& set : placed.node->object->sets) {
        const std::vector<std::uint8_t> visible = faces_with_opaque_texels(set);
        for (std::size_t f = 0; f < visible.size(); ++f) {
          if (visible[f] == 0 || !shows_opaque(set, f)) continue;
          std::array<Vec3, 3> corners;
          for (std::size_t k = 0; k < 3; ++k)
            corners[k] = placed.to_world * set.soup.positions()[set.soup.faces()[f][k]];
          if (!corners[0].allFinite() || !corners[1].allFinite() || !corners[2].allFinite()) continue;
          triangles.push_back(corners);
          for (const Vec3& corner : corners) box.extend(Vec3(to_ground * corner));
        }
      }
  }
};

// Uniform grid over x and z of the ground's frame; each cell lists the triangle edges whose boxes overlap it.
class EdgeGrid {
 public:
  EdgeGrid(const std::vector<std::array<Vec3, 3>>& triangles, const Mat3& to_ground, const Box& room) : room_(room) {
    const double widest = std::max(room.sizes().x(), room.sizes().z());
    const double cells = std::clamp(std::sqrt(static_cast<double>(triangles.size())), 1.0, 512.0);
    cell_ = widest > 0 ? widest / cells : 1;
    for (const std::array<Vec3, 3>& triangle : triangles)
      for (std::size_t k = 0; k < 3; ++k) {
        const Edge edge{to_ground * triangle[k], to_ground * triangle[(k + 1) % 3]};
        each_cell(edge.from, edge.to, [&](std::int64_t cell) { cells_[cell].push_back(edge); });
      }
  }

  // Calls visit(height of the given edge, height of the other edge) for each crossing in the projection along y.
  template <class Visit>
  void each_crossing(const Vec3& from, const Vec3& to, Visit visit) const {
    each_cell(from, to, [&](std::int64_t cell) {
      const auto found = cells_.find(cell);
      if (found == cells_.end()) return;
      for (const Edge& other : found->second) {
        const Vec3 a = to - from, b = other.to - other.from, between = other.from - from;
        const double area = a.x() * b.z() - a.z() * b.x();
        const double s = (between.x() * b.z() - between.z() * b.x()) / area;
        const double t = (between.x() * a.z() - between.z() * a.x()) / area;
        // Parallel edges (area 0) are skipped: their contact is found by rays from their corners.
        if (s >= 0 && s <= 1 && t >= 0 && t <= 1) visit(from.y() + s * a.y(), other.from.y() + t * b.y());
      }
    });
  }

 private:
  struct Edge {
    Vec3 from, to;
  };

  // Visits the grid cells of the edge's bounding box inside `room_`.
  template <class Visit>
  void each_cell(const Vec3& from, const Vec3& to, Visit visit) const {
    const Vec3 low = from.cwiseMin(to).cwiseMax(room_.min()), high = from.cwiseMax(to).cwiseMin(room_.max());
    if (low.x() > high.x() || low.z() > high.z()) return;
    const auto at = [&](double value, double first) { return static_cast<std::int64_t>((value - first) / cell_); };
    for (std::int64_t x = at(low.x(), room_.min().x()); x <= at(high.x(), room_.min().x()); ++x)
      for (std::int64_t z = at(low.z(), room_.min().z()); z <= at(high.z(), room_.min().z()); ++z) visit(x * 4096 + z);
  }

  Box room_;
  double cell_;
  std::unordered_map<std::int64_t, std::vector<Edge>> cells_;
};

// The fall of a body along the ground's normal onto other objects or the ground plane.
class Fall {
 public:
  Fall(Body body, Body others, const Ground& ground, const Progress& progress)
      : body_(std::move(body)),
        others_(std::move(others)),
        ground_(ground),
        to_ground_(ground_frame(ground).transpose()),
        // Contact is found within the float precision of the rays.
        slack_(1e-5 * body_.box.diagonal().norm()),
        progress_(progress) {}

  // Signed distance along the normal by which the body must move to stand; negative if it falls.
  double run() {
    lift_ = std::max(0.0, ground_.height - body_.box.min().y());
    bool out = false, lifted = false;
    for (int round = 0; round < max_rounds && !out; ++round) {
      progress_.at("lifting out", static_cast<double>(round) / max_rounds);
      const double more = std::max(penetration(body_, others_, 1), penetration(others_, body_, -1));
      out = more == 0;
      lift_ += more;
      lifted = lifted || more > 0;
    }
    // Bodies count as separated if they overlap by less than the slack, so that the fall ends at contact.
    if (lifted) lift_ += slack_;
    // Fallback: lifts the body above everything.
    if (!out) lift_ = others_.box.max().y() - body_.box.min().y();
    progress_.at("falling", 0);
    return lift_ - free_fall();
  }

 private:
  static constexpr int max_rounds = 64;

  // Height by which the moving body must rise so that the edges of `edges` that now cross `faces` no longer do; 0 if
  // none crosses. `sign`: 1 if the moving body has the edges, -1 if it has the faces.
  double penetration(const Body& edges, const Body& faces, double sign) const {
    const Vec3 offset = sign * (lift_ + slack_) * ground_.normal;
    double rise = 0;
    for (const std::array<Vec3, 3>& triangle : edges.triangles) {
      Box box;
      for (const Vec3& corner : triangle) box.extend(Vec3(to_ground_ * (corner + offset)));
      if (!faces.box.intersects(box)) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 from = triangle[k] + offset, way = triangle[(k + 1) % 3] - triangle[k];
        const auto hit = faces.rays.nearest(from, way, 0, 1);
        if (!hit) continue;
        const auto corners = corners_of(faces.nodes[hit->instance], hit->triangle);
        double low = infinite, high = -infinite;
        for (const Vec3& corner : corners) {
          low = std::min(low, ground_.above(corner));
          high = std::max(high, ground_.above(corner));
        }
        const double here = ground_.above(from), there = ground_.above(from + way);
        const double needed = sign > 0 ? high - std::min(here, there) : std::max(here, there) - low;
        rise = std::max(rise, std::max(needed, slack_));
      }
    }
    return rise;
  }

  static std::array<Vec3, 3> corners_of(const PlacedNode& placed, std::uint32_t triangle) {
    std::array<Vec3, 3> corners;
    for (const TextureSet& set : placed.node->object->sets) {
      const std::size_t count = set.soup.triangle_count();
      if (triangle < count) {
        for (std::size_t k = 0; k < 3; ++k)
          corners[k] = placed.to_world * set.soup.positions()[set.soup.faces()[triangle][k]];
        return corners;
      }
      triangle -= static_cast<std::uint32_t>(count);
    }
    throw std::logic_error("a ray hit a triangle that the object does not have");
  }

  // Distance that the lifted body falls until first contact, vertex–face or edge–edge.
  double free_fall() const {
    const Vec3 up = ground_.normal, offset = lift_ * up;
    double way = body_.box.min().y() + lift_ - ground_.height;
    const auto stop = [&](double distance) { way = std::min(way, std::max(0.0, distance)); };
    // Vertex–face contact: the body's vertices above surfaces, and vertices of others below the body.
    for (const std::array<Vec3, 3>& triangle : body_.triangles)
      for (const Vec3& corner : triangle)
        if (const auto hit = others_.rays.nearest(corner + offset, -up, -slack_, infinite)) stop(hit->t);
    for (const std::array<Vec3, 3>& triangle : others_.triangles)
      for (const Vec3& corner : triangle) {
        const Vec3 p = to_ground_ * corner;
        if (p.x() < body_.box.min().x() || p.x() > body_.box.max().x() || p.z() < body_.box.min().z() ||
            p.z() > body_.box.max().z() || p.y() > body_.box.max().y() + lift_)
          continue;
        if (const auto hit = body_.rays.nearest(corner - offset, up, -slack_, infinite)) stop(hit->t);
      }
    // Edge–edge contact: edges that cross in the projection along the normal.
    const EdgeGrid below(others_.triangles, to_ground_, body_.box);
    for (const std::array<Vec3, 3>& triangle : body_.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        below.each_crossing(to_ground_ * triangle[k], to_ground_ * triangle[(k + 1) % 3], [&](double mine, double its) {
          if (const double gap = mine + lift_ - its; gap >= -slack_) stop(gap);
        });
    return way;
  }

  Body body_, others_;
  Ground ground_;
  Mat3 to_ground_;
  double slack_;
  const Progress& progress_;
  double lift_ = 0;
};

}  // namespace

Outcome apply(const Scene& scene, const Drop& edit, const Progress& progress) {
  editable_with_children(scene, edit.node.id);
  const Ground ground = edit.ground ? Ground{Vec3::UnitY(), *edit.ground} : scene.ground;
  const std::set<NodeId> own = subtree(scene, edit.node.id);
  std::vector<PlacedNode> falling, others;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) (own.contains(placed.node->id) ? falling : others).push_back(placed);
  const Mat3 to_ground = ground_frame(ground).transpose();
  Body body(falling, to_ground);
  if (body.triangles.empty())
    throw EditError("the node contains no visible triangle, so it cannot fall; show it first");
  const double size = body.box.diagonal().norm();
  const double rise = Fall(std::move(body), Body(others, to_ground), ground, progress).run();
  const std::string name = find(scene, edit.node.id)->name;
  // Smaller motions are below the float precision of the rays.
  if (std::abs(rise) <= 1e-6 * size)
    return {scene, {{fmt::format("\"{}\" already stands on a surface or on the ground; it was not moved", name)}}};
  Transform move;
  move.node = edit.node;
  move.translate = rise * ground.normal;
  return {apply(scene, move),
          {{fmt::format("\"{}\" {} by {:.6g}", name, rise < 0 ? "fell" : "was lifted out", std::abs(rise))}}};
}

REBAKE_DESCRIBE_EDIT(
    Drop,
    "Lets a node fall onto the visible surface below it, or onto the scene's ground plane. A node that intersects "
    "something "
    "is lifted out of it first.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node that falls, with its children");
      visit("ground", edit.ground, Need::optional, "height of a level ground plane to use instead of the scene's",
            Unit::length);
    })

}  // namespace rebake
