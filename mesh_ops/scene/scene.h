#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/camera.h"
#include "mesh_ops/scene/ground.h"
#include "mesh_ops/scene/light.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Identity of a node, stable through all edits and never reused within a scene's history.
enum class NodeId : std::uint64_t { none = 0 };

struct Node;
using NodePtr = std::shared_ptr<const Node>;

/// A group (no object) or a placed object. Names are unique within a scene.
struct Node {
  NodeId id = NodeId::none;
  std::string name;
  bool visible = true;  ///< hides its children too
  bool locked = false;  ///< edits refuse it and its children
  Affine to_parent = Affine::Identity();
  std::shared_ptr<const BakedObject> object;     ///< null for groups
  std::shared_ptr<const TriangleSet> selection;  ///< null when nothing is selected
  std::map<std::string, std::shared_ptr<const TriangleSet>> saved_selections;
  std::vector<NodePtr> children;
};

/// Everything people edit, as a value: copying is cheap, and no function changes a scene that it was given.
struct Scene {
  std::vector<NodePtr> roots;
  Color background{1, 1, 1};
  Ground ground;
  std::map<std::string, Camera> views;
  std::uint64_t next_id = 1;
  std::shared_ptr<const SceneLight> light;  ///< null: colours stay as they were baked
};

/// A node as it stands in the world.
struct PlacedNode {
  NodePtr node;
  Affine to_world;
  bool visible;  ///< the node and all its ancestors are
  bool locked;   ///< the node or an ancestor is
};

/// All nodes, parents before their children, in drawing order.
std::vector<PlacedNode> placed_nodes(const Scene& scene);

/// Null or nothing when there is no such node.
NodePtr find(const Scene& scene, NodeId id);
NodePtr find(const Scene& scene, const std::string& name);
std::optional<PlacedNode> find_placed(const Scene& scene, NodeId id);
/// Empty when the node is a root (or absent).
NodeId parent_of(const Scene& scene, NodeId id);

/// The scene with one node changed; everything beside the path to it is shared.
Scene with_changed(const Scene& scene, NodeId id, const std::function<void(Node&)>& change);
/// The scene without a node and its children.
Scene without(const Scene& scene, NodeId id);
/// The scene with `node` added under `parent` (none: at the top) at `index` (past the end: last). Nodes without an id
/// get one, their children too; names that are taken get a number. `added`, where given, receives the id.
Scene with_added(const Scene& scene, Node node, NodeId parent, std::size_t index, NodeId* added = nullptr);

/// `wanted`, or `wanted.2`, `wanted.3`, … when it is taken.
std::string unique_name(const Scene& scene, const std::string& wanted);

/// Groups are nested at most this deep.
inline constexpr int deepest_group = 64;
/// Levels of nodes: 0 for an empty scene, 1 without groups.
int depth(const Scene& scene);

/// World box of all visible objects.
Box world_bounds(const Scene& scene);
/// Box of an axis-aligned box after a transform.
Box transformed(const Box& box, const Affine& transform);

}  // namespace rebake
