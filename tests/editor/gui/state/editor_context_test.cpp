// The window's state without a display: edits, previews and costs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "editor/edits/deform/bend.h"
#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/rename.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/select/select.h"
#include "editor/edits/select/select_picture.h"
#include "editor/edits/select/select_triangles.h"
#include "editor/edits/support.h"
#include "editor/gui/state/commands.h"
#include "editor/gui/state/editor_context.h"
#include "editor/gui/state/lost_work.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"
#include "tests/support/window_state.h"

namespace rebake::test {
namespace {

TEST(EditorContext, MeasuresCostsInTheView) {
  const TemporaryFolder home;  // for the journal
  ::setenv("XDG_STATE_HOME", home.path().c_str(), 1);
  EditorContext editor({}, [] {});
  editor.view.width = 160;
  editor.view.height = 120;
  const auto wait = [&editor] {
    while (editor.jobs.worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    editor.update();
    for (const Messages::Line& line : editor.messages.log()) ASSERT_FALSE(line.failed) << line.text;
  };
  editor.project.open({REBAKE_SOURCE "/samples/scenes/ficus"});
  wait();
  editor.jobs.measure_costs(editor.view, editor.scene());
  wait();
  ASSERT_TRUE(editor.jobs.costs);
  ASSERT_EQ(editor.jobs.costs->rows.size(), 7U);
  const auto decibels = [&](std::size_t row) { return editor.jobs.costs->rows[row].values[1]; };
  EXPECT_GT(decibels(2), decibels(1)) << "16 samples must be closer to 64 samples than 4 are";
  EXPECT_GT(decibels(1), decibels(0));
  EXPECT_NEAR(decibels(3), decibels(0), 0.01) << "full resolution with 1 sample equals 1 sample";
  EXPECT_GT(decibels(3), decibels(6)) << "a third of the resolution must be worse than full resolution";
  for (const StudyTable::Row& row : editor.jobs.costs->rows) EXPECT_GT(row.values[0], 0) << row.choice;
  editor.jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
  wait();
}

// With a scene of two objects.
class EditorContextTest : public WindowState {
 protected:
  EditorContextTest() {
    for (const char* name : {"ball", "box"}) {
      export_scene(scene_of(made_object({.columns = 8, .rows = 4})), home.path() / name, {});
      editor->project.open({(home.path() / name).string()});
    }
    wait();
  }
  NodeId id(const char* name) const { return find(editor->scene(), std::string(name))->id; }
  std::size_t selected(const char* name) const {
    const NodePtr node = find(editor->scene(), std::string(name));
    return node->selection ? count(*node->selection) : 0;
  }
};

TEST_F(EditorContextTest, ToolsWorkOnThePickedNodes) {
  EXPECT_EQ(editor->active, std::set<NodeId>{id("box")}) << "import must pick the new node";
  EXPECT_EQ(editor->scope_words(), "in box");
  Select all;
  all.all = true;
  editor->edit_scope(all);
  wait();
  EXPECT_EQ(selected("ball"), 0U);
  EXPECT_GT(selected("box"), 0U);
  EXPECT_EQ(editor->status, "Selected 64 triangles in box");
  editor->active = {id("ball")};
  EXPECT_TRUE(editor->scope(true).empty()) << "no triangle is selected in the ball";
  EXPECT_EQ(editor->deform_targets().at(0).node->id, id("ball"));
  EXPECT_FALSE(editor->deform_targets().at(0).selection);
  editor->active.clear();
  EXPECT_EQ(editor->scope_words(), "in the scene");
  editor->edit_scope(all);
  wait();
  EXPECT_GT(selected("ball"), 0U);
}

TEST_F(EditorContextTest, AdjustingKeepsOneStepAndSurvivesFailure) {
  Transform move;
  move.node = NodeRef{id("box")};
  move.translate = Vec3(1, 0, 0);
  editor->edit(move);
  wait();
  const std::size_t steps = editor->now->steps_done;
  move.translate = Vec3(3, 0, 0);
  editor->adjust({move});
  wait();
  EXPECT_EQ(editor->now->steps_done, steps);
  EXPECT_EQ(find(editor->scene(), id("box"))->to_parent.translation().x(), 3);
  move.scale.value = Vec3(0, 1, 1);
  editor->adjust({move});
  wait();
  EXPECT_EQ(find(editor->scene(), id("box"))->to_parent.translation().x(), 3)
      << "a failed adjustment must keep the step";
  EXPECT_EQ(editor->now->steps_done, steps);
  EXPECT_FALSE(editor->messages.shown().empty());
}

TEST_F(EditorContextTest, ReleaseCommitsThePreview) {
  Bend bend;
  bend.target.node = NodeRef{id("box")};
  bend.axis.axis = Vec3(1, 0, 0);
  bend.direction = Vec3(0, 1, 0);
  const auto drag = [&](double degrees) {
    bend.degrees = degrees;
    editor->show_preview({bend});
  };
  for (const double degrees : {5.0, 10.0, 20.0}) drag(degrees);
  editor->edits({bend});  // waits for the preview if it is still being computed
  wait();
  EXPECT_EQ(editor->now->done.back().as<Bend>()->degrees, 20);
  drag(30);
  wait();
  ASSERT_TRUE(editor->preview);
  const std::vector<NodePtr> previewed = editor->preview->scene.roots;
  editor->edits({bend});
  wait();
  EXPECT_EQ(editor->scene().roots, previewed);
  // An edit that no preview was requested for is applied.
  drag(40);
  wait();
  bend.degrees = 41;
  editor->edits({bend});
  wait();
  const auto* last = editor->now->done.back().as<Bend>();
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->degrees, 41);
  // A dropped preview is not waited for.
  drag(50);
  editor->drop_preview();
  bend.degrees = 50;
  editor->edits({bend});
  wait();
  EXPECT_EQ(editor->now->steps_done, editor->now->steps.size());
}

TEST_F(EditorContextTest, ReleaseWaitingForAPreviewCanBeCancelled) {
  std::atomic<bool> begun = false, run_step = false;
  editor->previews.request(editor->scene().roots, [&begun, &run_step, scene = editor->scene()](const Progress&) {
    begun = true;
    while (!run_step) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return scene;
  });
  Hide hide;
  hide.node = NodeRef{id("box")};
  const std::size_t steps = editor->now->steps_done;
  while (!begun)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // otherwise the next request would replace it
  editor->show_preview({hide});
  editor->edits({hide});
  editor->jobs.worker.cancel();
  while (editor->jobs.worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  run_step = true;
  wait();
  EXPECT_EQ(editor->now->steps_done, steps);
  EXPECT_TRUE(find(editor->scene(), id("box"))->visible);
  EXPECT_FALSE(editor->preview) << "a cancelled edit must not be shown";
}

// A job may make several steps, such as a script, or open another document.
TEST_F(EditorContextTest, EveryStepOfAJobCountsItsOwnTriangles) {
  editor->jobs.worker.start("script", [](Session& session) {
    const auto step = [&](int last) {
      const std::string select =
          fmt::format(R"({{"op": "select_triangles", "node": "box", "triangles": [[0, {}]]}})", last);
      session.edit(read_edit(nlohmann::json::parse(select), session.scene()));
      session.edit(read_edit({{"op", "delete"}}, session.scene()));
    };
    step(9);
    step(4);
  });
  wait();
  ASSERT_EQ(editor->now->steps.size(), 6U);
  EXPECT_EQ(editor->now->steps[3].title, "Deleted 10 triangles of box");
  EXPECT_EQ(editor->now->steps[5].title, "Deleted 5 triangles of box");
}

TEST_F(EditorContextTest, AdjustedSelectionsCountFromBeforeTheStep) {
  SelectTriangles some;
  some.node = {id("box")};
  some.triangles.ranges = {{0, 3}};
  editor->edit(some);
  wait();
  some.triangles.ranges = {{0, 9}};
  editor->adjust({some});
  wait();
  some.triangles.ranges = {{0, 7}};
  editor->adjust({some});
  wait();
  EXPECT_EQ(editor->now->steps.back().title, "Selected 8 triangles in box");
}

TEST_F(EditorContextTest, TitlesAreImmutable) {
  Rename rename;
  rename.node = NodeRef{id("box")};
  rename.name = "crate";
  Hide hide;
  hide.node = rename.node;
  editor->edit(hide);
  editor->edit(rename);
  wait();
  ASSERT_EQ(editor->now->steps.size(), 4U);
  EXPECT_EQ(editor->now->steps[2].title, "Hid box") << "the title keeps the name at that time";
  EXPECT_EQ(editor->now->steps[3].title, "Renamed to \"crate\"");
  editor->undo();
  wait();
  EXPECT_EQ(editor->status, "Undid: Renamed to \"crate\"");
  EXPECT_EQ(editor->now->steps[3].title, "Renamed to \"crate\"");
  EXPECT_EQ(editor->now->steps_done, 3U);
}

TEST_F(EditorContextTest, SelectionsOfHiddenPickedNodesAreNamedSo) {
  editor->active.clear();
  Select all;
  all.all = true;
  editor->edit_scope(all);
  wait();
  Hide hide;
  hide.node = NodeRef{id("box")};
  editor->edit(hide);
  wait();
  editor->active = {id("box")};
  EXPECT_EQ(editor->selected_words(), "0 selected in box, 64 hidden or locked, 64 elsewhere");
  editor->active = {id("ball")};
  EXPECT_EQ(editor->selected_words(), "64 selected in ball, 64 elsewhere");
  editor->active.clear();
  EXPECT_EQ(editor->selected_words(), "64 selected, 64 hidden or locked");
}

TEST_F(EditorContextTest, ProjectsOpenWithoutAFolderForJournals) {
  const std::filesystem::path project = home.path() / "p.rebake";
  editor->project.save(project);
  wait();
  editor->jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
  wait();
  std::filesystem::remove_all(journal_folder());
  std::filesystem::create_directories(journal_folder().parent_path());
  write_text(journal_folder(), "a file where the folder should be");
  editor->project.open({project.string()});
  wait();
  EXPECT_EQ(editor->project.path, project);
  EXPECT_NE(editor->messages.log().back().text.find("there is no crash recovery"), std::string::npos)
      << editor->messages.log().back().text;
  // Saving begins a journal as soon as that is possible.
  std::filesystem::remove(journal_folder());
  editor->project.save(project);
  wait();
  EXPECT_FALSE(std::filesystem::is_empty(journal_folder()));
}

TEST_F(EditorContextTest, AJournalCutInItsFirstLinesIsShownAndKept) {
  editor->project.begin_journal();
  wait();
  const std::filesystem::path whole = editor->now->journal, cut = whole.parent_path() / "cut.journal";
  const std::string bytes = read_file(whole);
  ASSERT_GT(bytes.size(), 40U);
  write_text(cut, bytes.substr(0, bytes.find('\n') / 2));
  std::filesystem::last_write_time(cut, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  const std::vector<LostWork> found = lost_work();
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const LostWork& work) { return work.journal == cut; }));
  EXPECT_TRUE(std::filesystem::exists(cut));
}

TEST_F(EditorContextTest, AnEditThatRunsWhileAProjectIsOpenedGoesToTheTrash) {
  editor->project.begin_journal();
  const std::filesystem::path project = home.path() / "two.rebake";
  editor->project.save(project);
  wait();
  ASSERT_FALSE(editor->project.unsaved());
  // The edit ends after the user has asked for the project.
  std::atomic<bool> asked = false;
  const NodeId ball = id("ball");
  editor->jobs.worker.start("slow edit", [&asked, ball](Session& session) {
    while (!asked) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    Rename edit;
    edit.node = {ball};
    edit.name = "slow";
    session.edit(edit);
  });
  editor->project.open({project.string()});
  asked = true;
  wait();
  std::vector<std::filesystem::path> trash;
  for (const auto& entry : std::filesystem::directory_iterator(home.path() / "rebake/trash")) trash.push_back(entry);
  ASSERT_EQ(trash.size(), 1U);
  EXPECT_NE(read_file(trash.front()).find("slow"), std::string::npos);
  EXPECT_TRUE(find(editor->scene(), std::string("ball"))) << "the project is open";
}

TEST_F(EditorContextTest, SavingWhileAnotherProjectOpensDoesNotReplaceTheFirst) {
  const std::filesystem::path first = home.path() / "first.rebake", second = home.path() / "second.rebake";
  editor->project.save(first);
  wait();
  Rename edit;
  edit.node = {id("ball")};
  edit.name = "renamed";
  editor->edit(edit);
  wait();
  editor->project.save(second);
  wait();
  editor->project.open({first.string()});
  wait();
  const std::string before = read_file(first);
  std::atomic<bool> pressed = false;
  editor->jobs.worker.start("slow", [&pressed](Session&) {
    while (!pressed) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  editor->project.open({second.string()});
  editor->project.save(editor->project.path);
  editor->edit(Hide{NodeRef{id("box")}});
  pressed = true;
  wait();
  EXPECT_EQ(read_file(first), before);
  EXPECT_EQ(editor->project.path, second);
  EXPECT_FALSE(editor->project.unsaved());
  EXPECT_TRUE(find(editor->scene(), std::string("renamed")));
  EXPECT_TRUE(find(editor->scene(), std::string("box"))->visible) << "the key was meant for the first project";
}

// A running pick or select changes the nodes that a command works on.
TEST_F(EditorContextTest, CommandsOnPicksAreRefusedWhileAJobRuns) {
  editor->active = {id("ball")};
  std::atomic<bool> pressed = false;
  editor->jobs.worker.start_change(
      "pick",
      [&pressed](Session&) {
        while (!pressed) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      },
      [this, node = id("box")] { editor->active = {node}; });
  editor->update();
  for (const char* command :
       {"Hide", "Delete", "Remove picked nodes", "Duplicate", "Invert", "Group", "Drop to surface"})
    run_command(*editor, command_named(command));
  EXPECT_NE(editor->messages.log().back().text.find("another step is still running"), std::string::npos);
  pressed = true;
  wait();
  EXPECT_EQ(editor->now->steps_done, 2U) << "two imports";
  run_command(*editor, command_named("Hide"));
  wait();
  EXPECT_TRUE(find(editor->scene(), std::string("ball"))->visible);
  EXPECT_FALSE(find(editor->scene(), std::string("box"))->visible);
  // Jobs that change neither, such as a save, do not matter.
  pressed = false;
  editor->jobs.worker.start("save", [&pressed](Session&) {
    while (!pressed) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  editor->update();
  editor->active = {id("ball")};
  run_command(*editor, command_named("All"));
  pressed = true;
  wait();
  EXPECT_EQ(editor->now->steps_done, 4U);
  // Undo and Save keep their order among the jobs.
  editor->edit(Hide{NodeRef{id("ball")}});
  run_command(*editor, command_named("Undo"));
  wait();
  EXPECT_TRUE(find(editor->scene(), std::string("ball"))->visible);
}

TEST_F(EditorContextTest, SavedScriptsNameNodes) {
  Rename rename;
  rename.node = {id("box")};
  rename.name = "crate";
  editor->edit(rename);
  editor->edit(Hide{NodeRef{id("box")}});
  wait();
  editor->project.save_script(home.path() / "s.jsonl");
  wait();
  const std::string script = read_file(home.path() / "s.jsonl");
  EXPECT_NE(script.find(R"("node":"box","op":"rename")"), std::string::npos) << script;
  EXPECT_NE(script.find(R"("node":"crate","op":"hide")"), std::string::npos) << script;
  EXPECT_NE(script.find(R"("as":"ball")"), std::string::npos) << "an import of another folder gets this name";
}

// Edits made from what the window shows must not undo what a running job is about to change.
TEST_F(EditorContextTest, EditsOfStatesThatAJobChangesAreRefused) {
  std::atomic<bool> made = false;
  const NodeId ball = id("ball");
  editor->jobs.worker.start("slow edit", [&made, ball](Session& session) {
    while (!made) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    Transform move;
    move.node = NodeRef{ball};
    move.translate = Vec3(1, 0, 0);
    session.edit(move);
  });
  Rename edit;
  edit.node = {ball};
  edit.name = "late";
  const auto same_place = [ball, from = find(editor->scene(), ball)->to_parent](const Scene& scene) {
    return find(scene, ball)->to_parent.matrix() == from.matrix();
  };
  editor->edit_unchanged(edit, same_place);
  made = true;
  wait();
  EXPECT_EQ(find(editor->scene(), ball)->name, "ball");
  EXPECT_TRUE(editor->messages.log().back().failed);
  editor->edit_unchanged(edit, [](const Scene&) { return true; });
  wait();
  EXPECT_EQ(find(editor->scene(), ball)->name, "late");
}

TEST_F(EditorContextTest, ViewsStoredDuringAJobGetDifferentNames) {
  std::atomic<bool> stored = false;
  editor->jobs.worker.start("slow", [&stored](Session&) {
    while (!stored) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  store_view(*editor);
  editor->view.camera.eye.x() += 1;
  store_view(*editor);
  stored = true;
  wait();
  EXPECT_EQ(editor->scene().views.size(), 2U);
}

TEST_F(EditorContextTest, VisibleSelectionsAreAllThatTheSelectionConsistsOf) {
  const auto picture = [&](const char* node, SelectMode mode, bool through = false) {
    SelectPicture edit;
    edit.node = NodeRef{id(node)};
    edit.picture.camera = editor->view.camera;
    edit.picture.size = {64, 64};
    edit.picture.depth = Interval{0, 1000};
    edit.mode = mode;
    edit.through = through;
    return Edit(edit);
  };
  const auto after = [&](const std::vector<Edit>& edits) {
    editor->edits(edits);
    wait();
    return editor->visible_selections().size();
  };
  using enum SelectMode;
  EXPECT_EQ(after({picture("ball", set), picture("box", set)}), 2U) << editor->messages.log().back().text;
  EXPECT_EQ(after({picture("ball", add)}), 3U);
  EXPECT_EQ(after({picture("ball", remove)}), 0U) << "occluded triangles may be left of earlier ones";
  EXPECT_EQ(after({picture("ball", set)}), 1U);
  EXPECT_EQ(after({picture("ball", add, true)}), 0U);
  EXPECT_EQ(after({picture("ball", add)}), 0U);
}

TEST_F(EditorContextTest, ClicksInTheHistoryReachTheirStepWhateverIsQueued) {
  for (const char* name : {"a", "b", "c", "d"}) {
    Rename edit;
    edit.node = {id("box")};
    edit.name = name;
    editor->edit(edit);
    wait();
    edit.name = "box";
    editor->edit(edit);
    wait();
  }
  const std::size_t steps = editor->now->steps_done;
  editor->go_to(steps - 3);
  editor->go_to(steps - 3);
  wait();
  EXPECT_EQ(editor->now->steps_done, steps - 3) << "a double click";
  editor->go_to(steps);
  wait();
  EXPECT_EQ(editor->now->steps_done, steps);
  // An edit that is still queued: the click was meant for other steps.
  Rename edit;
  edit.node = {id("box")};
  edit.name = "late";
  editor->go_to(steps - 2);
  wait();
  editor->edit(edit);
  editor->go_to(steps);
  wait();
  EXPECT_EQ(editor->now->steps_done, steps - 1);
  EXPECT_EQ(find(editor->scene(), std::string("late")) != nullptr, true);
  EXPECT_TRUE(editor->messages.log().back().failed);
}

TEST_F(EditorContextTest, UndoIsNamedByTheStepItUndid) {
  Rename edit;
  edit.node = {id("box")};
  edit.name = "first";
  editor->edit(edit);
  wait();
  edit.name = "second";
  editor->edit(edit);
  editor->undo();
  wait();
  EXPECT_NE(editor->status.find("second"), std::string::npos) << editor->status;
}

TEST_F(EditorContextTest, PickedNodesDoNotSurviveAnotherDocument) {
  Rename edit;
  edit.node = {id("ball")};
  edit.name = "renamed";
  editor->edit(edit);
  editor->project.save(home.path() / "p.rebake");
  wait();
  editor->active = {id("renamed")};
  editor->project.open({(home.path() / "p.rebake").string()});
  wait();
  EXPECT_TRUE(editor->active.empty());
}

TEST_F(EditorContextTest, WorkDoneWhileSourcesAreSoughtGoesToTheTrash) {
  editor->project.begin_journal();
  const std::filesystem::path project = home.path() / "p.rebake";
  editor->project.save(project);
  wait();
  std::filesystem::rename(home.path() / "ball", home.path() / "moved");
  editor->project.open({project.string()});
  wait();
  ASSERT_TRUE(editor->project.relinking);
  Rename edit;
  edit.node = {id("box")};
  edit.name = "newer";
  editor->edit(edit);
  wait();
  editor->project.relinking->sources.front().now = (home.path() / "moved").string();
  editor->project.relink(false);
  wait();
  std::string kept;
  for (const auto& entry : std::filesystem::directory_iterator(home.path() / "rebake/trash"))
    kept += read_file(entry.path());
  EXPECT_NE(kept.find("newer"), std::string::npos);
}

// Steps that a later one revised are in the history, too.
TEST_F(EditorContextTest, ClicksInTheHistoryCountRevisedSteps) {
  Transform move;
  move.node = NodeRef{id("box")};
  move.translate = Vec3(1, 0, 0);
  editor->edit(move);
  wait();
  for (const double x : {2.0, 3.0}) {
    move.translate = Vec3(x, 0, 0);
    editor->revise({move});
    wait();
  }
  const std::size_t steps = editor->now->steps_done;
  const auto at = [&] { return find(editor->scene(), id("box"))->to_parent.translation().x(); };
  ASSERT_EQ(at(), 3);
  for (const std::size_t back : {1U, 2U, 0U, 3U}) {
    editor->go_to(steps - back);
    wait();
    EXPECT_EQ(editor->now->steps_done, steps - back);
    EXPECT_EQ(at(), 3 - static_cast<double>(back));
  }
}

TEST_F(EditorContextTest, ScriptsRunInTheWindowKeepWhatTheirLaterLinesRead) {
  export_scene(scene_of(made_object({.columns = 4, .rows = 2})), home.path() / "later", {});
  const auto before = folder_bytes(home.path() / "later");
  write_text(home.path() / "s.jsonl", fmt::format(R"({{"op": "export", "out": "{0}"}}
{{"op": "import", "path": "{0}", "content": "0000000000000000"}}
)",
                                                  (home.path() / "later").string()));
  editor->project.run_script(home.path() / "s.jsonl");
  wait();
  EXPECT_EQ(folder_bytes(home.path() / "later"), before);
  EXPECT_TRUE(editor->messages.log().back().failed);
}

}  // namespace
}  // namespace rebake::test
