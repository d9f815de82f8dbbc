#include "editor/edits/support.h"

#include "mesh_ops/base/error.h"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <set>

#include "mesh_ops/base/polar.h"

namespace rebake {

PlacedNode present(const Scene& scene, NodeId id) {
  auto placed = find_placed(scene, id);
  if (!placed) throw EditError("the node no longer exists");
  return std::move(*placed);
}

PlacedNode editable(const Scene& scene, NodeId id) {
  PlacedNode placed = present(scene, id);
  if (placed.locked) throw EditError(fmt::format("node \"{}\" is locked; unlock it first", placed.node->name));
  return placed;
}

namespace {

// The locked nodes below a node.
std::vector<NodePtr> locked_below(const Node& node) {
  std::vector<NodePtr> locked, open = node.children;
  while (!open.empty()) {
    const NodePtr below = open.back();
    open.pop_back();
    if (below->locked) locked.push_back(below);
    open.insert(open.end(), below->children.begin(), below->children.end());
  }
  return locked;
}

}  // namespace

PlacedNode editable_with_children(const Scene& scene, NodeId id) {
  PlacedNode placed = editable(scene, id);
  for (const NodePtr& locked : locked_below(*placed.node))
    throw EditError(
        fmt::format("\"{}\" contains the locked node \"{}\"; unlock it first", placed.node->name, locked->name));
  return placed;
}

std::vector<std::string> locked_inside(const Scene& scene, NodeId group) {
  std::vector<std::string> notes;
  for (const NodePtr& locked : locked_below(*present(scene, group).node))
    notes.push_back(fmt::format("note: this moves \"{}\" too, which is locked", locked->name));
  return notes;
}

std::vector<PlacedNode> objects_with_selection(const Scene& scene, const std::optional<NodeRef>& node) {
  const bool of_group = node && !present(scene, node->id).node->object;
  std::set<NodeId> inside;
  if (of_group) inside.insert(editable(scene, node->id).node->id);
  std::vector<PlacedNode> result;
  for (PlacedNode& placed : placed_nodes(scene)) {
    if (of_group) {
      if (!inside.contains(placed.node->id)) continue;
      for (const NodePtr& child : placed.node->children) inside.insert(child->id);
    } else if (node && placed.node->id != node->id) {
      continue;
    }
    if (!placed.node->object || !placed.node->selection || count(*placed.node->selection) == 0) continue;
    // Hidden and locked objects are skipped unless they are named; a named locked object is refused.
    if ((!node || of_group) && (placed.locked || !placed.visible)) continue;
    editable(scene, placed.node->id);
    result.push_back(std::move(placed));
  }
  if (result.empty())
    throw EditError(
        node ? fmt::format("no triangle of \"{}\" is selected; select some first", present(scene, node->id).node->name)
             : "no triangle is selected; select some first");
  return result;
}

PlacedNode object_with_selection(const Scene& scene, const NodeRef& node) {
  const PlacedNode placed = present(scene, node.id);
  if (!placed.node->object)
    throw EditError(fmt::format("\"{}\" is a group; name an object inside it", placed.node->name));
  return objects_with_selection(scene, node).front();
}

std::vector<PlacedNode> objects_of_each(const Scene& scene, const std::vector<NodeRef>& nodes,
                                        std::vector<PlacedNode> (*find)(const Scene&, const std::optional<NodeRef>&)) {
  std::vector<PlacedNode> objects;
  std::set<NodeId> found;
  for (const NodeRef& node : nodes)
    for (PlacedNode& placed : find(scene, node))
      if (found.insert(placed.node->id).second) objects.push_back(std::move(placed));
  return objects;
}

std::shared_ptr<const BakedObject> with_sets(const BakedObject& object, std::vector<TextureSet> sets) {
  std::erase_if(sets, [](const TextureSet& set) { return set.soup.triangle_count() == 0; });
  if (sets.empty()) return nullptr;
  auto result = std::make_shared<BakedObject>(object);
  result->sets = std::move(sets);
  record_bodies(*result, object);
  return result;
}

std::shared_ptr<const BakedObject> triangles_of(const BakedObject& object, const TriangleSet& flags, bool wanted) {
  std::vector<TextureSet> sets;
  std::size_t first = 0;
  for (const TextureSet& set : object.sets) {
    const std::size_t total = set.soup.triangle_count();
    std::size_t chosen = 0;
    for (std::size_t f = first; f < first + total; ++f) chosen += (flags[f] != 0) == wanted ? 1 : 0;
    // Sets that keep all their triangles stay shared, so that export copies their source files.
    if (chosen == total)
      sets.push_back(set);
    else if (chosen > 0)
      sets.push_back({subset(set.soup, flags, first, wanted), set.texels});
    first += total;
  }
  return with_sets(object, std::move(sets));
}

void keep_triangles(Node& node, const TriangleSet& flags, bool wanted) {
  node.object = triangles_of(*node.object, flags, wanted);
  node.selection = nullptr;
  for (auto& [name, saved] : node.saved_selections) {
    TriangleSet kept;
    for (std::size_t f = 0; f < flags.size(); ++f)
      if ((flags[f] != 0) == wanted) kept.push_back((*saved)[f]);
    saved = std::make_shared<const TriangleSet>(std::move(kept));
  }
}

void move_in_parent(Node& node, const Affine& motion) {
  node.to_parent = motion * node.to_parent;
  if (!node.motion || node.motion->place.empty()) return;
  NodeMotion moved = *node.motion;
  for (auto& key : moved.place) key.value = motion * key.value;
  node.motion = std::make_shared<const NodeMotion>(std::move(moved));
}

Node without_ids(const Node& node) {
  Node copy = node;
  copy.id = NodeId::none;
  copy.selection = nullptr;
  for (NodePtr& child : copy.children) child = std::make_shared<const Node>(without_ids(*child));
  return copy;
}

TreePosition place_of(const Scene& scene, NodeId id) {
  const NodeId parent = parent_of(scene, id);
  const std::vector<NodePtr> siblings = parent == NodeId::none ? scene.roots : find(scene, parent)->children;
  std::size_t index = 0;
  while (index < siblings.size() && siblings[index]->id != id) ++index;
  return {parent, index};
}

Scene with_only(const Scene& scene, const std::vector<NodeRef>& nodes) {
  if (nodes.empty()) return scene;
  std::set<NodeId> wanted;
  for (const NodeRef& node : nodes) wanted.insert(present(scene, node.id).node->id);
  // Groups above a wanted node stay, because their transforms place it.
  const std::function<NodePtr(const NodePtr&)> kept = [&](const NodePtr& node) -> NodePtr {
    if (wanted.contains(node->id)) return node;
    Node around = *node;
    around.object = nullptr;
    around.selection = nullptr;
    around.saved_selections.clear();
    around.children.clear();
    for (const NodePtr& child : node->children)
      if (NodePtr inside = kept(child)) around.children.push_back(std::move(inside));
    return around.children.empty() ? nullptr : std::make_shared<const Node>(std::move(around));
  };
  Scene result = scene;
  result.roots.clear();
  for (const NodePtr& root : scene.roots)
    if (NodePtr inside = kept(root)) result.roots.push_back(std::move(inside));
  return result;
}

namespace {

// A node and its children, the node itself visible, where they are in the world; nothing if there is no such node.
Scene subtree(const Scene& scene, NodeId id) {
  Scene part;
  const auto placed = find_placed(scene, id);
  if (!placed) return part;
  Node root = *placed->node;
  root.visible = true;
  root.to_parent = placed->to_world;
  part.roots.push_back(std::make_shared<const Node>(std::move(root)));
  return part;
}

template <class Visit>
void for_visible_corners(const Scene& scene, const Visit& visit) {
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    for (const TextureSet& set : placed.node->object->sets)
      for (const Face& face : set.soup.faces())
        for (const std::uint32_t vertex : face) visit(placed.to_world * set.soup.positions()[vertex]);
  }
}

}  // namespace

Box subtree_bounds(const Scene& scene, NodeId id) { return world_bounds(subtree(scene, id)); }

Box triangle_bounds(const Scene& scene, NodeId id) {
  Box box;
  for_visible_corners(subtree(scene, id), [&](const Vec3& corner) { box.extend(corner); });
  return box;
}

double lowest_visible(const Scene& scene) {
  double lowest = std::numeric_limits<double>::infinity();
  for_visible_corners(scene, [&](const Vec3& corner) {
    if (corner.y() < lowest) lowest = corner.y();
  });
  return lowest;
}

Box selection_bounds(const PlacedNode& placed) {
  Box box;
  std::size_t f = 0;
  for (const TextureSet& set : placed.node->object->sets)
    for (const Face& face : set.soup.faces())
      if ((*placed.node->selection)[f++] != 0)
        for (const std::uint32_t vertex : face) box.extend(placed.to_world * set.soup.positions()[vertex]);
  return box;
}

void check_subtree(const Scene& scene, NodeId id) {
  if (depth(scene) > deepest_group)
    throw EditError(fmt::format("groups can be nested at most {} levels deep", deepest_group));
  std::vector<NodeId> inside{id};
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (std::find(inside.begin(), inside.end(), placed.node->id) == inside.end()) continue;
    for (const NodePtr& child : placed.node->children) inside.push_back(child->id);
    check_invertible(placed.to_world);
    const Box box = placed.node->object ? transformed(placed.node->object->bounds(), placed.to_world) : Box();
    if (!placed.to_world.matrix().allFinite() || !(box.isEmpty() || (box.min().allFinite() && box.max().allFinite())))
      throw EditError(fmt::format("the coordinates of \"{}\" would be too large", placed.node->name));
  }
}

void check_invertible(const Affine& transform) {
  try {
    orthogonal_factor(transform.linear());
  } catch (const std::invalid_argument& error) {
    throw EditError(error.what());
  }
}

void check_boxes(const nlohmann::json& edit) {
  if (edit.is_array())
    for (const nlohmann::json& one : edit) check_boxes(one);
  if (!edit.is_object()) return;
  for (const char* field : {"box", "eyes"}) {
    const auto box = edit.find(field);
    if (box == edit.end() || !box->is_object() || !box->contains("min") || !box->contains("max")) continue;
    const nlohmann::json &min = box->at("min"), &max = box->at("max");
    for (std::size_t axis = 0; axis < 3 && min.is_array() && max.is_array(); ++axis)
      if (axis < min.size() && axis < max.size() && min[axis].is_number() && max[axis].is_number() &&
          min[axis].get<double>() > max[axis].get<double>())
        throw FieldError(field, fmt::format("min {0} is above max {0}, so the box is empty; swap them", "xyz"[axis]));
  }
  for (const char* list : {"moves", "fixed"})
    if (edit.contains(list)) check_boxes(edit.at(list));
}

Scene moved_in_world(const Scene& scene, NodeId id, const Affine& motion) {
  const NodeId parent = parent_of(scene, id);
  const Affine parent_to_world = parent == NodeId::none ? Affine(Affine::Identity()) : present(scene, parent).to_world;
  const Affine to_world = present(scene, id).to_world;
  Scene result = with_changed(scene, id, [&](Node& node) {
    node.to_parent = parent_to_world.matrix().isIdentity(0) ? motion * node.to_parent
                                                            : parent_to_world.inverse() * motion * to_world;
  });
  check_subtree(result, id);
  return result;
}

void set_ground(Scene& scene, const Ground& ground) {
  scene.ground = ground;
  if (!scene.light || scene.light->up == ground.normal) return;
  auto light = std::make_shared<SceneLight>(*scene.light);
  light->up = ground.normal;
  scene.light = light;
}

}  // namespace rebake
