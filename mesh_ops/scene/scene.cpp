#include "mesh_ops/scene/scene.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace rebake {

namespace {

void collect(const std::vector<NodePtr>& nodes, const Affine& to_world, bool visible, bool locked,
             std::vector<PlacedNode>& out) {
  for (const NodePtr& node : nodes) {
    const Affine placed = to_world * node->to_parent;
    out.push_back({node, placed, visible && node->visible, locked || node->locked});
    collect(node->children, placed, visible && node->visible, locked || node->locked, out);
  }
}

// Rebuilds the path to `id`; `change` edits the list that holds the node, at the node's place.
bool edit_list(std::vector<NodePtr>& nodes, NodeId id,
               const std::function<void(std::vector<NodePtr>&, std::size_t)>& change) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i]->id == id) {
      change(nodes, i);
      return true;
    }
    std::vector<NodePtr> children = nodes[i]->children;
    if (!edit_list(children, id, change)) continue;
    Node copy = *nodes[i];
    copy.children = std::move(children);
    nodes[i] = std::make_shared<const Node>(std::move(copy));
    return true;
  }
  return false;
}

// Names in use, and the last number appended to each.
class Names {
 public:
  explicit Names(const Scene& scene) {
    for (const PlacedNode& placed : placed_nodes(scene)) taken_.insert(placed.node->name);
  }
  std::string unique(const std::string& wanted) {
    const std::string base = wanted.empty() ? "object" : wanted;
    std::string name = base;
    for (int& n = last_.try_emplace(base, 1).first->second; !taken_.insert(name).second;)
      name = base + "." + std::to_string(++n);
    return name;
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, int> last_;
};

void adopt(Node& node, std::uint64_t& next_id, Names& names) {
  if (node.id == NodeId::none) node.id = NodeId{next_id++};
  node.name = names.unique(node.name);
  for (NodePtr& child : node.children) {
    Node copy = *child;
    adopt(copy, next_id, names);
    child = std::make_shared<const Node>(std::move(copy));
  }
}

}  // namespace

std::vector<PlacedNode> placed_nodes(const Scene& scene) {
  std::vector<PlacedNode> out;
  collect(scene.roots, Affine::Identity(), true, false, out);
  return out;
}

NodePtr find(const Scene& scene, NodeId id) {
  const auto placed = find_placed(scene, id);
  return placed ? placed->node : nullptr;
}

NodePtr find(const Scene& scene, const std::string& name) {
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->name == name) return placed.node;
  return nullptr;
}

std::optional<PlacedNode> find_placed(const Scene& scene, NodeId id) {
  for (PlacedNode& placed : placed_nodes(scene))
    if (placed.node->id == id) return std::move(placed);
  return std::nullopt;
}

NodeId parent_of(const Scene& scene, NodeId id) {
  for (const PlacedNode& placed : placed_nodes(scene))
    for (const NodePtr& child : placed.node->children)
      if (child->id == id) return placed.node->id;
  return NodeId::none;
}

Scene with_changed(const Scene& scene, NodeId id, const std::function<void(Node&)>& change) {
  Scene result = scene;
  edit_list(result.roots, id, [&](std::vector<NodePtr>& list, std::size_t at) {
    Node copy = *list[at];
    change(copy);
    list[at] = std::make_shared<const Node>(std::move(copy));
  });
  return result;
}

Scene without(const Scene& scene, NodeId id) {
  Scene result = scene;
  edit_list(result.roots, id, [](std::vector<NodePtr>& list, std::size_t at) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(at));
  });
  return result;
}

Scene with_added(const Scene& scene, Node node, NodeId parent, std::size_t index, NodeId* added) {
  Scene result = scene;
  Names names(scene);
  adopt(node, result.next_id, names);
  if (added != nullptr) *added = node.id;
  const auto pointer = std::make_shared<const Node>(std::move(node));
  const auto insert = [&](std::vector<NodePtr>& list) {
    list.insert(list.begin() + static_cast<std::ptrdiff_t>(std::min(index, list.size())), pointer);
  };
  if (parent == NodeId::none)
    insert(result.roots);
  else
    result = with_changed(result, parent, [&](Node& group) { insert(group.children); });
  return result;
}

std::string unique_name(const Scene& scene, const std::string& wanted) { return Names(scene).unique(wanted); }

Box transformed(const Box& box, const Affine& transform) {
  Box result;
  if (box.isEmpty()) return result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(transform * box.corner(static_cast<Box::CornerType>(corner)));
  return result;
}

int depth(const Scene& scene) {
  int levels = 0;
  for (std::vector<NodePtr> row = scene.roots, next; !row.empty(); row = std::move(next), next.clear(), ++levels)
    for (const NodePtr& node : row) next.insert(next.end(), node->children.begin(), node->children.end());
  return levels;
}

Box world_bounds(const Scene& scene) {
  Box result;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object)
      result.extend(transformed(placed.node->object->bounds(), placed.to_world));
  return result;
}

Box world_bounds(const PlacedNode& object) {
  Box result;
  for (const TextureSet& set : object.node->object->sets)
    for (const Face& face : set.soup.faces())
      for (const std::uint32_t vertex : face) result.extend(object.to_world * set.soup.positions()[vertex]);
  return result;
}

}  // namespace rebake
