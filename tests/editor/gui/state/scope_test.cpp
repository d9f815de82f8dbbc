// Nothing outside the scope changes: random nodes in groups, hidden, locked, picked and selected, and commands
// that work on the scope, which the test finds by itself.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "editor/edits/nodes/group.h"
#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/lock.h"
#include "editor/edits/scene_change.h"
#include "editor/edits/select/select_triangles.h"
#include "editor/gui/state/commands.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/window_state.h"

namespace rebake::test {
namespace {

constexpr int objects = 4;

class Scope : public WindowState {
 protected:
  Scope() {
    export_scene(scene_of(made_object({.columns = 4, .rows = 3})), home.path() / "ball", {});
    for (int k = 0; k < objects; ++k) editor->project.open({(home.path() / "ball").string()});
    wait();
    for (const PlacedNode& placed : placed_nodes(editor->scene())) nodes.push_back(placed.node->id);
  }
  template <class T>
  void each(const std::set<NodeId>& of) {
    for (const NodeId id : of) {
      T edit;
      edit.node = NodeRef{id};
      editor->edit(edit);
      wait();
    }
  }
  std::set<NodeId> some(const std::vector<NodeId>& of, unsigned in) {
    std::set<NodeId> result;
    for (const NodeId id : of)
      if (random() % in == 0) result.insert(id);
    return result;
  }
  // Each of the four nodes as an object, its selection and its transform.
  using State = std::map<NodeId, std::tuple<const void*, std::vector<std::uint8_t>, Eigen::Matrix4d>>;
  State state_of(const Scene& scene) const {
    State state;
    for (const PlacedNode& placed : placed_nodes(scene))
      if (std::find(nodes.begin(), nodes.end(), placed.node->id) != nodes.end())
        state[placed.node->id] = {placed.node->object.get(),
                                  placed.node->selection ? *placed.node->selection : std::vector<std::uint8_t>(),
                                  placed.to_world.matrix()};
    return state;
  }
  std::size_t triangles() const {
    std::size_t count = 0;
    for (const PlacedNode& placed : placed_nodes(editor->scene()))
      if (placed.node->object) count += placed.node->object->triangle_count();
    return count;
  }
  std::vector<NodeId> nodes;
  std::mt19937 random{11};
};

TEST_F(Scope, CommandsChangeNothingOutside) {
  const std::map<std::string, std::function<void()>> commands = {
      {"All", [&] { command_named("All").run(*editor); }},
      {"None", [&] { command_named("None").run(*editor); }},
      {"Invert", [&] { command_named("Invert").run(*editor); }},
      {"Grow", [&] { command_named("Grow").run(*editor); }},
      {"Shrink", [&] { command_named("Shrink").run(*editor); }},
      {"Connected", [&] { command_named("Connected").run(*editor); }},
      {"Separate", [&] { command_named("Separate").run(*editor); }},
      {"Delete", [&] { command_named("Delete").run(*editor); }},
      {"Delete and fill holes", [&] { command_named("Delete and fill holes").run(*editor); }},
  };
  editor->tools.kind = ToolKind::rectangle;  // with it, Delete removes no nodes
  int changed = 0, refused = 0;
  for (int trial = 0; trial < 24; ++trial) {
    const std::size_t start = editor->now->steps_done;
    for (const NodeId id : some(nodes, 2)) {
      SelectTriangles select;
      select.node = NodeRef{id};
      select.triangles = NumberRanges{{{1, 2}, {5, 6}}};
      editor->edit(select);
      wait();
    }
    std::vector<NodeId> can_be_picked = nodes;
    if (random() % 2 == 0) {
      Group group;
      for (const NodeId id : some(nodes, 2)) group.nodes.push_back(NodeRef{id});
      if (!group.nodes.empty()) {
        editor->edit(group);
        wait();
        can_be_picked.push_back(parent_of(editor->scene(), group.nodes.front().id));
      }
    }
    each<Hide>(some(can_be_picked, 4));
    each<Lock>(some(can_be_picked, 4));
    const std::set<NodeId> picked = some(can_be_picked, 3);
    std::set<NodeId> inside;
    for (const PlacedNode& placed : placed_nodes(editor->scene())) {
      bool is_picked = picked.empty();
      for (NodeId at = placed.node->id; at != NodeId::none; at = parent_of(editor->scene(), at))
        is_picked = is_picked || picked.contains(at);
      if (is_picked && placed.visible && !placed.locked && placed.node->object) inside.insert(placed.node->id);
    }
    const State before = state_of(editor->scene());
    for (const auto& [name, run] : commands) {
      editor->active = picked;
      const std::size_t steps = editor->now->steps_done, triangles_before = triangles();
      editor->status.clear();
      run();
      wait();
      if (name == "Delete" && editor->now->steps_done > steps) {
        const std::string title = editor->now->steps.at(steps).title;
        EXPECT_TRUE(title.starts_with("Deleted " + triangles_text(triangles_before - triangles()) + " of ")) << title;
      }
      const State after = state_of(editor->scene());
      for (const NodeId id : nodes) {
        if (inside.contains(id)) continue;
        EXPECT_EQ(after.at(id), before.at(id)) << "trial " << trial << ", " << name;
      }
      (editor->now->steps_done > steps ? changed : refused)++;
      while (editor->now->steps_done > steps) {
        editor->undo(1);
        wait();
      }
    }
    EXPECT_EQ(editor->nodes_in_scope(), inside);
    while (editor->now->steps_done > start) {
      editor->undo(1);
      wait();
    }
  }
  EXPECT_GT(changed, 40);
  EXPECT_GT(refused, 10);
}

TEST_F(Scope, OneEditNamesOneNodeOrEverything) {
  for (const NodeId id : nodes) {
    SelectTriangles select;
    select.node = NodeRef{id};
    select.triangles = NumberRanges{{{1, 2}}};
    editor->edit(select);
    wait();
  }
  editor->active = {nodes[0], nodes[1]};
  EXPECT_FALSE(editor->one_deform_target()) << "an edit of all selected triangles would deform two more nodes";
  EXPECT_NE(editor->messages.log().back().text.find("Pick one node, or none"), std::string::npos);
  editor->active = {nodes[0]};
  EXPECT_EQ(editor->one_deform_target()->node->id, nodes[0]);
  editor->active = {nodes.begin(), nodes.end()};
  EXPECT_FALSE(editor->one_deform_target()->node) << "all of them";
  editor->active.clear();
  EXPECT_FALSE(editor->one_deform_target()->node);
  Lock lock;
  lock.node = NodeRef{nodes[0]};
  editor->edit(lock);
  wait();
  editor->active = {nodes[0]};
  EXPECT_FALSE(editor->one_deform_target());
  EXPECT_NE(editor->messages.log().back().text.find("no visible, unlocked object"), std::string::npos);
}

}  // namespace
}  // namespace rebake::test
