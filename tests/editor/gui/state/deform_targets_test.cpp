// What the deformation tools and commands of the window work on, with several objects.
#include <gtest/gtest.h>

#include <algorithm>

#include "editor/edits/nodes/group.h"
#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/select/select.h"
#include "editor/gui/state/commands.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/window_state.h"

namespace rebake::test {
namespace {

class DeformTargets : public WindowState {
 protected:
  DeformTargets() {
    for (const char* name : {"a", "b", "c", "d"}) {
      export_scene(scene_of(made_object({.columns = 8, .rows = 4})), home.path() / name, {});
      editor->project.open({(home.path() / name).string()});
    }
    wait();
    editor->active.clear();
  }
  NodeId id(const char* name) const { return find(editor->scene(), std::string(name))->id; }
  std::vector<NodeId> targets() const {
    std::vector<NodeId> nodes;
    for (const DeformTarget& target : editor->deform_targets()) nodes.push_back(target.node->id);
    return nodes;
  }
};

TEST_F(DeformTargets, AreAllPickedNodesWithWhatIsInsideThem) {
  editor->active = {id("a"), id("c")};
  EXPECT_EQ(targets(), (std::vector{id("a"), id("c")}));
  EXPECT_EQ(editor->deform_nodes(), (std::set{id("a"), id("c")}));
  EXPECT_FALSE(editor->one_deform_target()) << "a cage has one node";
  // Selections elsewhere do not count.
  Select all;
  all.all = true;
  editor->active = {id("b"), id("d")};
  editor->edit_scope(all);
  wait();
  editor->active = {id("a"), id("c")};
  EXPECT_FALSE(editor->one_deform_target());
  EXPECT_EQ(editor->messages.log().back().text, "This tool deforms one node and its children. Pick one node.");
  editor->active.clear();
  EXPECT_EQ(editor->deform_nodes(), (std::set{id("b"), id("d")})) << "those with selected triangles";
  all.mode = SelectMode::remove;
  editor->edit_scope(all);
  wait();
  Group group;
  group.nodes = {NodeRef{id("a")}, NodeRef{id("b")}};
  group.as = "plants";
  editor->edit(group);
  wait();
  editor->active = {id("plants")};
  EXPECT_EQ(targets(), std::vector{id("plants")});
  EXPECT_EQ(editor->deform_nodes(), (std::set{id("a"), id("b")}));
  ASSERT_TRUE(editor->one_deform_target());
  editor->active = {id("plants"), id("a")};
  EXPECT_EQ(targets(), std::vector{id("plants")}) << "once";
  editor->edit(Hide{{id("b")}});
  wait();
  EXPECT_EQ(editor->deform_nodes(), std::set{id("a")});
}

TEST_F(DeformTargets, AreNotGuessedIfNothingIsPicked) {
  EXPECT_TRUE(targets().empty());
  EXPECT_FALSE(editor->one_deform_target());
  EXPECT_EQ(editor->messages.log().back().text,
            "There are several objects. Pick the one to deform, or select triangles.");
  editor->edits({Hide{{id("a")}}, Hide{{id("b")}}, Hide{{id("d")}}});
  wait();
  EXPECT_EQ(targets(), std::vector{id("c")}) << "the only visible one";
}

// The step and its title have only what fell; the log says what did not.
TEST_F(DeformTargets, DroppingNamesOnlyWhatFell) {
  Transform up;
  up.node = NodeRef{id("a")};
  up.translate = Vec3(3, 5, 0);
  editor->edit(up);
  wait();
  editor->active = {id("b")};
  run_command(*editor, command_named("Drop to surface"));
  wait();
  const std::size_t steps = editor->now->done.size();
  editor->active = {id("a"), id("b")};
  run_command(*editor, command_named("Drop to surface"));
  wait();
  EXPECT_EQ(editor->now->done.size(), steps + 1);
  EXPECT_EQ(editor->status, "Dropped a");
  const auto& log = editor->messages.log();
  EXPECT_TRUE(std::any_of(log.begin(), log.end(), [](const Messages::Line& line) {
    return line.text.find("\"b\" already stands") != std::string::npos;
  }));
}

}  // namespace
}  // namespace rebake::test
