#pragma once

#include <nlohmann/json_fwd.hpp>

#include <vector>

#include "editor/edits/edit.h"
#include "editor/fields/values.h"
#include "mesh_ops/base/error.h"

namespace rebake {

/// The node, where it may be edited. Throws EditError when it is absent, or locked (itself or a group above it).
PlacedNode editable(const Scene& scene, NodeId id);

/// As editable(), and throws EditError where a node inside it is locked.
PlacedNode editable_with_children(const Scene& scene, NodeId id);

/// The node, locked or not. Throws EditError when it is absent.
PlacedNode present(const Scene& scene, NodeId id);

/// Editable objects with selected triangles: the given object, the objects in a group, or all objects. Hidden and
/// locked objects are skipped unless named. Throws EditError when nothing is selected.
std::vector<PlacedNode> with_selection(const Scene& scene, const std::optional<NodeRef>& node);
/// The same of one object. Throws EditError for a group.
PlacedNode object_with_selection(const Scene& scene, const NodeRef& node);

/// A copy of the object with other sets; turns into null when no triangle is left.
std::shared_ptr<const BakedObject> with_sets(const BakedObject& object, std::vector<TextureSet> sets);

/// The object's selected (or, with `wanted` false, unselected) triangles; null when there are none.
std::shared_ptr<const BakedObject> triangles_of(const BakedObject& object, const TriangleSet& flags, bool wanted);

/// Keeps the triangles of a node whose flag is `wanted`, in its object and its saved selections; nothing is selected
/// then.
void keep_triangles(Node& node, const TriangleSet& flags, bool wanted);

/// The node and its children without ids and selections, to be added as new ones.
Node without_ids(const Node& node);

/// Where a node hangs: its parent (none at the top) and its index there.
struct OutlinePlace {
  NodeId parent;
  std::size_t index;
};
OutlinePlace place_of(const Scene& scene, NodeId id);

/// The scene without objects that are neither one of the nodes nor inside one; all of it where none is named. Throws
/// EditError when a node is absent.
Scene with_only(const Scene& scene, const std::vector<NodeRef>& nodes);

/// World box of a node's and its children's triangles.
Box subtree_bounds(const Scene& scene, NodeId id);
/// World box of a node's selected triangles.
Box selection_bounds(const PlacedNode& placed);

/// Throws EditError when a node below `id` (itself included) is flattened or lies beyond what numbers hold, and when
/// groups nest too deep.
void check_subtree(const Scene& scene, NodeId id);

/// Sets the scene's ground, and up for its sky light.
void set_ground(Scene& scene, const Ground& ground);

/// Throws EditError when the transform flattens what it moves.
void checked_turn(const Affine& transform);

/// Throws FieldError for a box in a new edit's JSON whose min lies above its max: nothing would be inside. What
/// journals and projects hold is not asked.
void check_boxes(const nlohmann::json& edit);

}  // namespace rebake
