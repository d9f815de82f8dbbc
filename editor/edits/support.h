#pragma once

#include <nlohmann/json_fwd.hpp>

#include <vector>

#include "editor/edits/edit.h"
#include "editor/fields/values.h"
#include "mesh_ops/base/error.h"

namespace rebake {

/// The node, if it may be edited. Throws EditError if it is missing, or if it or a group above it is locked.
PlacedNode editable(const Scene& scene, NodeId id);

/// As editable(); also throws EditError if a node inside it is locked.
PlacedNode editable_with_children(const Scene& scene, NodeId id);

/// Notes for a report that an edit of this group moves locked nodes inside it.
std::vector<std::string> locked_inside(const Scene& scene, NodeId group);

/// The node, locked or not. Throws EditError if it is missing.
PlacedNode present(const Scene& scene, NodeId id);

/// Objects with selected triangles: the given object, the objects in the given group, or all objects. Hidden and locked
/// objects are skipped unless named. Throws EditError if nothing is selected or the named node is locked.
std::vector<PlacedNode> objects_with_selection(const Scene& scene, const std::optional<NodeRef>& node);
/// The object `node`. Throws EditError if it is a group, is locked, or has no selected triangle.
PlacedNode object_with_selection(const Scene& scene, const NodeRef& node);

/// The objects that `find` gives for one node after the other, each object once.
std::vector<PlacedNode> objects_of_each(const Scene& scene, const std::vector<NodeRef>& nodes,
                                        std::vector<PlacedNode> (*find)(const Scene&, const std::optional<NodeRef>&));

/// A copy of the object with these texture sets, without empty ones; null if no triangle is left.
std::shared_ptr<const BakedObject> with_sets(const BakedObject& object, std::vector<TextureSet> sets);

/// The object with only its flagged triangles, or with `wanted` false the unflagged ones; null if there are none.
/// `flags`: one per triangle, set by set.
std::shared_ptr<const BakedObject> triangles_of(const BakedObject& object, const TriangleSet& flags, bool wanted);

/// Keeps the node's triangles whose flag equals `wanted`, in its object and its stored selections. Clears the
/// selection.
void keep_triangles(Node& node, const TriangleSet& flags, bool wanted);

/// Moves a node within its parent: its transform, and its keyframes.
void move_in_parent(Node& node, const Affine& motion);

/// A copy of the node and its children without ids and selections, for adding as new nodes.
Node without_ids(const Node& node);

/// Position of a node in the tree.
struct TreePosition {
  NodeId parent;      ///< none for roots
  std::size_t index;  ///< among the parent's children
};
TreePosition place_of(const Scene& scene, NodeId id);

/// The scene with only these nodes, their children, and the groups above them; the whole scene if `nodes` is empty.
/// Throws EditError if a node is missing.
Scene with_only(const Scene& scene, const std::vector<NodeRef>& nodes);

/// A world box around a node and its children, from the boxes of their objects: quick, and too large for rotated
/// nodes. Hidden children do not count.
Box subtree_bounds(const Scene& scene, NodeId id);
/// The world box of the triangles of a node and its children; hidden children do not count.
Box triangle_bounds(const Scene& scene, NodeId id);
/// Least world y of the triangles of visible nodes; infinity if there are none.
double lowest_visible(const Scene& scene);
/// World box of a node's selected triangles.
Box selection_bounds(const PlacedNode& placed);

/// Throws EditError if `id` or a node below it has a singular transform or non-finite bounds, or if groups are nested
/// more than `deepest_group` deep.
void check_subtree(const Scene& scene, NodeId id);

/// Sets the ground plane, and with its normal the up direction of the sky light.
void set_ground(Scene& scene, const Ground& ground);
/// Moves a node and its children by a transform of world space. Throws EditError if one can no longer be drawn.
Scene moved_in_world(const Scene& scene, NodeId id, const Affine& motion);

/// Throws EditError for a singular transform.
void check_invertible(const Affine& transform);

/// Throws FieldError for a box in a new edit's JSON that is empty because min is above max. Journals and projects are
/// not checked, so that old ones still open.
void check_boxes(const nlohmann::json& edit);

}  // namespace rebake
