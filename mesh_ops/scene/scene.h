#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/camera.h"
#include "mesh_ops/scene/ground_plane.h"
#include "mesh_ops/scene/keyframes.h"
#include "mesh_ops/scene/object.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

/// Identity of a node, stable through all edits and never reused within a scene's history.
enum class NodeId : std::uint64_t { none = 0 };

struct Node;
using NodePtr = std::shared_ptr<const Node>;

/// A group (no object) or a placed object. Names are unique within a scene.
struct Node {
  NodeId id = NodeId::none;
  std::string name;
  bool visible = true;  ///< if false, its children are hidden too
  bool locked = false;  ///< if true, edits reject the node and its children
  Affine to_parent = Affine::Identity();
  std::shared_ptr<const BakedObject> object;     ///< null for groups
  std::shared_ptr<const TriangleSet> selection;  ///< null if nothing is selected
  std::map<std::string, std::shared_ptr<const TriangleSet>> saved_selections;
  std::shared_ptr<const NodeMotion> motion;  ///< null without keyframes
  std::vector<NodePtr> children;             ///< of groups only
};

/// Everything that users edit, as a value: copying is cheap, and functions never modify their argument.
struct Scene {
  std::vector<NodePtr> roots;
  Color background{1, 1, 1};
  Ground ground;
  std::map<std::string, Camera> views;
  Keyframes<Camera> camera_keys;            ///< camera of films; empty: none
  std::uint64_t next_id = 1;                ///< identity of the next added node
  std::shared_ptr<const SceneLight> light;  ///< null: colours stay as baked
};

/// A node with its world transform and inherited flags.
struct PlacedNode {
  NodePtr node;
  Affine to_world;
  bool visible;  ///< whether the node and all its ancestors are visible
  bool locked;   ///< whether the node or an ancestor is locked
};

/// All nodes, parents before their children, in drawing order.
std::vector<PlacedNode> placed_nodes(const Scene& scene);

/// Null or nullopt if there is no such node.
NodePtr find(const Scene& scene, NodeId id);
NodePtr find(const Scene& scene, const std::string& name);
std::optional<PlacedNode> find_placed(const Scene& scene, NodeId id);
/// NodeId::none if the node is a root or absent.
NodeId parent_of(const Scene& scene, NodeId id);

/// The scene with one node changed; shares everything except the path to that node.
Scene with_changed(const Scene& scene, NodeId id, const std::function<void(Node&)>& change);
/// The scene without a node and its children.
Scene without(const Scene& scene, NodeId id);
/// The scene with `node` added under `parent` (none: as a root) at position `index` (past the end: last). The node and
/// its children get an id if they have none, and a unique name. `added` receives the id if it is not null.
Scene with_added(const Scene& scene, Node node, NodeId parent, std::size_t index, NodeId* added = nullptr);

/// `wanted`, or `wanted.2`, `wanted.3`, … if that name is taken.
std::string unique_name(const Scene& scene, const std::string& wanted);

/// Maximum nesting depth of groups.
inline constexpr int deepest_group = 64;
/// Levels of nodes: 0 for an empty scene, 1 without groups.
int depth(const Scene& scene);

/// Bounding box of all visible objects in world space, from the boxes of the objects: too large for rotated ones.
Box world_bounds(const Scene& scene);
/// Bounding box of an object's triangles in world space.
Box world_bounds(const PlacedNode& object);
/// Axis-aligned bounding box of a transformed box.
Box transformed(const Box& box, const Affine& transform);

}  // namespace rebake
