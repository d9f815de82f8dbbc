// Parts of the window that need no display: keys, typed numbers, settings, jobs, previews.
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <set>
#include <sstream>
#include <thread>

#include "editor/edits/deform/bend.h"
#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/rename.h"
#include "editor/edits/nodes/transform.h"
#include "editor/edits/select/select.h"
#include "editor/edits/support.h"
#include "editor/gui/panels/euler.h"
#include "editor/gui/tools/expression.h"
#include "editor/gui/tools/typed_number.h"
#include "editor/gui/ui/theme.h"
#include "editor/gui/window/child_process.h"
#include "editor/gui/window/commands.h"
#include "editor/gui/window/editor_context.h"
#include "editor/gui/window/input_queue.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Keys, ParsesKeyNames) {
  EXPECT_EQ(parse_key("R"), (KeyPress{GLFW_KEY_R}));
  EXPECT_EQ(parse_key("Ctrl+Shift+Z"), (KeyPress{GLFW_KEY_Z, true, true, false}));
  EXPECT_EQ(parse_key("["), (KeyPress{GLFW_KEY_LEFT_BRACKET}));
  EXPECT_EQ(parse_key("F12"), (KeyPress{GLFW_KEY_F12}));
  EXPECT_EQ(parse_key("KP_7"), (KeyPress{GLFW_KEY_KP_7}));
  EXPECT_EQ(parse_key("Alt+Delete"), (KeyPress{GLFW_KEY_DELETE, false, false, true}));
  for (const char* text : {"", "Ctrl+", "F13", "KP_X", "rr", "Shift"}) EXPECT_FALSE(parse_key(text)) << text;
}

TEST(Keys, KeymapsContainValidUniqueKeys) {
  for (const bool blender : {false, true}) {
    std::set<std::string> taken;
    for (const Command& command : command_table()) {
      std::istringstream keys(blender ? command.blender_keys : command.keys);
      for (std::string key; keys >> key;) {
        EXPECT_TRUE(parse_key(key)) << key;
        EXPECT_TRUE(taken.insert(key).second) << key << " is assigned twice, also to " << command.title;
      }
    }
  }
}

TEST(Expression, EvaluatesArithmetic) {
  EXPECT_EQ(evaluated("90/4 + 1"), 23.5);
  EXPECT_EQ(evaluated(" -(2+3)*2 "), -10);
  EXPECT_EQ(evaluated("2-3-4"), -5);
  EXPECT_EQ(evaluated("1e-3*-2"), -0.002);
  EXPECT_NEAR(*evaluated("pi/2"), 1.5707963267948966, 1e-15);
  for (const char* text : {"", "1+", "(1", "1/0", "x", "1 2", "--"}) EXPECT_FALSE(evaluated(text)) << text;
  EXPECT_FALSE(evaluated(std::string(100000, '('))) << "however deep";
}

TEST(Input, TypedNumberIsAnExpression) {
  TypedNumber number;
  const auto type = [&](std::initializer_list<int> keys) {
    for (const int key : keys) EXPECT_TRUE(number.key({key})) << key;
  };
  EXPECT_FALSE(number.value());
  type({GLFW_KEY_MINUS});
  EXPECT_FALSE(number.value()) << "half typed";
  type({GLFW_KEY_3, GLFW_KEY_SLASH});
  EXPECT_EQ(number.value(), -3.0) << "the last complete number stays valid";
  type({GLFW_KEY_KP_4});
  EXPECT_EQ(number.value(), -0.75);
  type({GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE});
  EXPECT_FALSE(number.value()) << "without text the pointer applies again";
  EXPECT_FALSE(number.key({GLFW_KEY_X}));
  EXPECT_FALSE(number.key({GLFW_KEY_1, false, true})) << "Ctrl is for commands";
}

TEST(Input, EachFrameSeesOneButtonChange) {
  using Kind = InputEvent::Kind;
  const auto shares = [](std::deque<InputEvent> waiting) {
    std::vector<std::size_t> result;
    while (!waiting.empty()) {
      result.push_back(events_of_frame(waiting));
      waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(result.back()));
    }
    return result;
  };
  const InputEvent move{Kind::move}, press{Kind::button, 0, 0, true}, release{Kind::button},
      key{Kind::key, 65, 0, true}, up{Kind::key, 65}, text{Kind::text, 'a'}, repeat{Kind::repeat, 65, 0, true},
      wheel{Kind::wheel};
  using Shares = std::vector<std::size_t>;
  EXPECT_EQ(shares({move, move, move}), Shares{3});
  EXPECT_EQ(shares({press, release}), (Shares{1, 1})) << "a click within one frame is seen";
  EXPECT_EQ(shares({move, press, move, move, release}), (Shares{2, 3})) << "and pressed at the pointer's position";
  EXPECT_EQ(shares({key, text, up, key, text, up}), (Shares{2, 1, 2, 1})) << "text stays with its key";
  EXPECT_EQ(shares({key, repeat, repeat, wheel, wheel}), Shares{5}) << "repeats must not delay frames";
  EXPECT_EQ(shares({move, wheel, move}), (Shares{2, 1})) << "the wheel zooms to the pointer's position";
}

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

// The state of the window without its display, with a scene of two objects.
class EditorContextTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("XDG_STATE_HOME", home.path().c_str(), 1);
    editor = std::make_unique<EditorContext>(Settings{}, [] {});
    for (const char* name : {"ball", "box"}) {
      export_scene(scene_of(made_object({.columns = 8, .rows = 4})), home.path() / name, {});
      editor->project.open({(home.path() / name).string()});
    }
    wait();
  }
  void TearDown() override {
    editor->jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
    wait();
  }
  void wait() {
    do {
      while (editor->jobs.worker.busy() || editor->previews.busy())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      editor->update();
    } while (editor->jobs.worker.busy());
  }
  NodeId id(const char* name) const { return find(editor->scene(), std::string(name))->id; }
  std::size_t selected(const char* name) const {
    const NodePtr node = find(editor->scene(), std::string(name));
    return node->selection ? count(*node->selection) : 0;
  }
  TemporaryFolder home;
  std::unique_ptr<EditorContext> editor;
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

TEST(ThemeColors, TextContrastMeetsWcag) {
  EXPECT_NEAR(contrast({0, 0, 0}, {255, 255, 255}), 21, 1e-9);
  EXPECT_NEAR(contrast({119, 119, 119}, {255, 255, 255}), 4.48, 0.01) << "a reference value of WCAG";
  for (const Theme* theme : {&dark_theme(), &light_theme()})
    for (const auto& [text, ground] : text_pairs(*theme))
      EXPECT_GE(contrast(text, ground), 4.5) << int{text.r} << "," << int{text.g} << "," << int{text.b} << " on "
                                             << int{ground.r} << "," << int{ground.g} << "," << int{ground.b};
}

TEST(Euler, AnglesRoundTripAndRightAnglesAreExact) {
  for (const Vec3& degrees : {Vec3(10, 20, 30), Vec3(-170, 80, 95), Vec3(179, -89.9, -179), Vec3(0, 0, 0)}) {
    EXPECT_LT((euler_degrees(rotation_of(degrees)) - degrees).norm(), 1e-11) << degrees.transpose();
    EXPECT_TRUE(rotation_of(degrees).isUnitary(1e-15));
  }
  EXPECT_EQ(rotation_of({90, 0, 0}) * Vec3::UnitY(), Vec3::UnitZ());
  EXPECT_EQ(rotation_of({90, 90, 0}) * Vec3::UnitY(), Vec3::UnitX()) << "about X first, then about Y";
  EXPECT_EQ(rotation_of({0, 180, 0}).diagonal(), Vec3(-1, 1, -1));
  // In gimbal lock the angles differ, but the rotation is the same.
  for (const double y : {90.0, -90.0}) {
    const Mat3 locked = rotation_of({25, y, 60});
    EXPECT_LT((rotation_of(euler_degrees(locked)) - locked).norm(), 1e-12);
  }
}

TEST(SettingsFile, RoundTripsAndReportsInvalidFiles) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "deeper" / "settings.json";
  std::string problem;
  EXPECT_EQ(read_settings(file, problem).looks, ColorTheme::dark);
  EXPECT_EQ(problem, "") << "a missing file is not an error";
  Settings settings;
  settings.looks = ColorTheme::light;
  settings.brush_radius = 33;
  for (int k = 0; k < 20; ++k) settings.remember("folder " + std::to_string(k));
  settings.remember("folder 15");
  write_settings(settings, file);
  const Settings read = read_settings(file, problem);
  EXPECT_EQ(read.looks, ColorTheme::light);
  EXPECT_EQ(read.brush_radius, 33);
  ASSERT_EQ(read.recent.size(), 12U);
  EXPECT_EQ(read.recent[0], "folder 15");
  EXPECT_EQ(read.recent[1], "folder 19");
  for (const char* text : {"{", "[]", R"({"text_scale": []})", R"({"brush_radius": "wide"})"}) {
    write_file_atomically(file, text, {});
    problem.clear();
    EXPECT_EQ(read_settings(file, problem), Settings{}) << text;
    EXPECT_NE(problem.find(file.string()), std::string::npos) << text;
  }
  write_file_atomically(file, R"({"side_width": -5, "window_width": 1000000, "something_newer": 1})", {});
  EXPECT_EQ(read_settings(file, problem).side_width, 200);
}

TEST(ChildProcess, ReadsAllOutputAndEndsWithItsOwner) {
  const auto ended = [](ChildProcess& child) {
    std::optional<int> status;
    while (!(status = child.ended())) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return *status;
  };
  const std::string shell = program_path("sh");
  ASSERT_FALSE(shell.empty());
  EXPECT_TRUE(program_path("no program is called so").empty());
  // More output than a pipe buffers, written before it is read.
  ChildProcess talks({shell, "-c", "head -c 200000 /dev/zero | tr '\\0' x; exit 3"});
  EXPECT_EQ(ended(talks), 3);
  EXPECT_EQ(talks.output(), std::string(200000, 'x'));
  ChildProcess killed({shell, "-c", "kill -9 $$"});
  EXPECT_EQ(ended(killed), 128 + 9);
  EXPECT_THROW(ChildProcess({"/nowhere/program"}), Error);
  const auto start = std::chrono::steady_clock::now();
  { ChildProcess sleeps({shell, "-c", "exec sleep 60"}); }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30))
      << "the destructor must not wait for the child";
}

}  // namespace
}  // namespace rebake::test
