#include "editor/edits/nodes/drop.h"

#include <fmt/format.h>

#include <limits>
#include <set>

#include "editor/edits/describe.h"
#include "editor/edits/nodes/transform.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/opacity.h"
#include "mesh_ops/rays/scene_rays.h"

namespace rebake {

namespace {

// The node and all below it.
std::set<NodeId> subtree(const Scene& scene, NodeId id) {
  std::set<NodeId> ids = {id};
  for (const PlacedNode& placed : placed_nodes(scene))
    if (ids.contains(placed.node->id))
      for (const NodePtr& child : placed.node->children) ids.insert(child->id);
  return ids;
}

// World corners of triangles that show something.
std::vector<Vec3> shown_corners(const PlacedNode& placed) {
  std::vector<Vec3> corners;
  for (const TextureSet& set : placed.node->object->sets) {
    const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
    std::vector<std::uint8_t> taken(set.soup.positions().size(), 0);
    for (std::size_t f = 0; f < shows.size(); ++f) {
      if (shows[f] == 0) continue;
      for (const std::uint32_t vertex : set.soup.faces()[f]) {
        if (std::exchange(taken[vertex], std::uint8_t{1}) != 0) continue;
        const Vec3 corner = placed.to_world * set.soup.positions()[vertex];
        if (corner.allFinite()) corners.push_back(corner);
      }
    }
  }
  return corners;
}

}  // namespace

Outcome apply(const Scene& scene, const Drop& edit) {
  editable_with_children(scene, edit.node.id);
  const std::set<NodeId> own = subtree(scene, edit.node.id);
  std::vector<PlacedNode> falling, others;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) (own.contains(placed.node->id) ? falling : others).push_back(placed);
  if (falling.empty()) throw EditError("the node holds nothing that is visible, so nothing can fall");
  const double far = std::numeric_limits<double>::infinity();
  double way = far;
  const auto stop = [&](double distance) { way = std::min(way, std::max(0.0, distance)); };
  // What stands on something already touches it within rounding, of the rays' floats too.
  Box whole;
  for (const PlacedNode& placed : falling) whole.extend(transformed(placed.node->object->bounds(), placed.to_world));
  const double slack = 1e-5 * whole.diagonal().norm();
  // Corners of what falls meet surfaces below them; corners below meet surfaces that fall.
  const SceneRays below = rays_through(others);
  Box box;
  for (const PlacedNode& placed : falling)
    for (const Vec3& corner : shown_corners(placed)) {
      box.extend(corner);
      if (const auto hit = below.nearest(corner, Vec3(0, -1, 0), -slack, far)) stop(hit->t);
    }
  // What is in the ground already stays there; what is below it falls on.
  if (!box.isEmpty() && box.max().y() >= edit.ground) stop(box.min().y() - edit.ground);
  if (box.isEmpty()) throw EditError("the node shows nothing, so nothing can fall");
  const SceneRays body = rays_through(falling);
  for (const PlacedNode& placed : others)
    for (const Vec3& corner : shown_corners(placed))
      if (corner.x() >= box.min().x() && corner.x() <= box.max().x() && corner.z() >= box.min().z() &&
          corner.z() <= box.max().z() && corner.y() <= box.max().y())
        if (const auto hit = body.nearest(corner, Vec3(0, 1, 0), -slack, far)) stop(hit->t);
  if (way == far) throw EditError("it lies below the ground, and nothing is below it");
  Transform move;
  move.node = edit.node;
  move.translate = Vec3(0, -way, 0);
  const std::string name = find(scene, edit.node.id)->name;
  return {way == 0 ? scene : apply(scene, move), {{fmt::format("\"{}\" fell by {:.6g}", name, way)}}};
}

REBAKE_DESCRIBE_EDIT(
    Drop, "Lets a node fall along the world's -y until it stands on what is visible below it, or on the ground.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node that falls, with those inside it");
      visit("ground", edit.ground, Need::optional, "height of the ground", Unit::length);
    })

}  // namespace rebake
