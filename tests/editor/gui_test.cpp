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
#include "editor/gui/window/desk.h"
#include "editor/gui/window/input_queue.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Keys, AreReadAsPeopleWriteThem) {
  EXPECT_EQ(parse_key("R"), (KeyPress{GLFW_KEY_R}));
  EXPECT_EQ(parse_key("Ctrl+Shift+Z"), (KeyPress{GLFW_KEY_Z, true, true, false}));
  EXPECT_EQ(parse_key("["), (KeyPress{GLFW_KEY_LEFT_BRACKET}));
  EXPECT_EQ(parse_key("F12"), (KeyPress{GLFW_KEY_F12}));
  EXPECT_EQ(parse_key("KP_7"), (KeyPress{GLFW_KEY_KP_7}));
  EXPECT_EQ(parse_key("Alt+Delete"), (KeyPress{GLFW_KEY_DELETE, false, false, true}));
  for (const char* text : {"", "Ctrl+", "F13", "KP_X", "rr", "Shift"}) EXPECT_FALSE(parse_key(text)) << text;
}

TEST(Keys, EveryKeyOfBothKeymapsIsKnownAndMeansOneThing) {
  for (const bool blender : {false, true}) {
    std::set<std::string> taken;
    for (const Command& command : command_table()) {
      std::istringstream keys(blender ? command.blender_keys : command.keys);
      for (std::string key; keys >> key;) {
        EXPECT_TRUE(parse_key(key)) << key;
        EXPECT_TRUE(taken.insert(key).second) << key << " is taken twice, by " << command.title;
      }
    }
  }
}

TEST(Expression, IsWhatACalculatorSays) {
  EXPECT_EQ(evaluated("90/4 + 1"), 23.5);
  EXPECT_EQ(evaluated(" -(2+3)*2 "), -10);
  EXPECT_EQ(evaluated("2-3-4"), -5);
  EXPECT_EQ(evaluated("1e-3*-2"), -0.002);
  EXPECT_NEAR(*evaluated("pi/2"), 1.5707963267948966, 1e-15);
  for (const char* text : {"", "1+", "(1", "1/0", "x", "1 2", "--"}) EXPECT_FALSE(evaluated(text)) << text;
  EXPECT_FALSE(evaluated(std::string(100000, '('))) << "however deep";
}

TEST(Input, ANumberTypedDuringADragIsAnExpression) {
  TypedNumber number;
  const auto type = [&](std::initializer_list<int> keys) {
    for (const int key : keys) EXPECT_TRUE(number.key({key})) << key;
  };
  EXPECT_FALSE(number.value());
  type({GLFW_KEY_MINUS});
  EXPECT_FALSE(number.value()) << "half typed";
  type({GLFW_KEY_3, GLFW_KEY_SLASH});
  EXPECT_EQ(number.value(), -3.0) << "what was whole counts on";
  type({GLFW_KEY_KP_4});
  EXPECT_EQ(number.value(), -0.75);
  type({GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE, GLFW_KEY_BACKSPACE});
  EXPECT_FALSE(number.value()) << "without a text the pointer counts again";
  EXPECT_FALSE(number.key({GLFW_KEY_X}));
  EXPECT_FALSE(number.key({GLFW_KEY_1, false, true})) << "Ctrl is for commands";
}

TEST(Input, AFrameSeesOneChangeWhereItHappened) {
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
  EXPECT_EQ(shares({move, press, move, move, release}), (Shares{2, 3})) << "and pressed where the pointer was";
  EXPECT_EQ(shares({key, text, up, key, text, up}), (Shares{2, 1, 2, 1})) << "text stays with its key";
  EXPECT_EQ(shares({key, repeat, repeat, wheel, wheel}), Shares{5}) << "what is held makes no frame wait";
  EXPECT_EQ(shares({move, wheel, move}), (Shares{2, 1})) << "it zooms to where the pointer was";
}

TEST(Desk, CostsAreMeasuredInTheView) {
  const TemporaryFolder home;  // for the journal
  ::setenv("XDG_STATE_HOME", home.path().c_str(), 1);
  Desk desk({}, [] {});
  desk.view.width = 160;
  desk.view.height = 120;
  const auto wait = [&desk] {
    while (desk.jobs.worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    desk.update();
    for (const Messages::Line& line : desk.messages.log()) ASSERT_FALSE(line.failed) << line.text;
  };
  desk.project.open({REBAKE_SOURCE "/samples/scenes/ficus"});
  wait();
  desk.jobs.measure_costs(desk.view, desk.scene());
  wait();
  ASSERT_TRUE(desk.jobs.costs);
  ASSERT_EQ(desk.jobs.costs->rows.size(), 7U);
  const auto decibels = [&](std::size_t row) { return desk.jobs.costs->rows[row].values[1]; };
  EXPECT_GT(decibels(2), decibels(1)) << "16 samples are nearer to 64 than 4";
  EXPECT_GT(decibels(1), decibels(0));
  EXPECT_NEAR(decibels(3), decibels(0), 0.01) << "all of the resolution at 1 sample is 1 sample";
  EXPECT_GT(decibels(3), decibels(6)) << "a third of the resolution is worse than all of it";
  for (const StudyTable::Row& row : desk.jobs.costs->rows) EXPECT_GT(row.values[0], 0) << row.choice;
  desk.jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
  wait();
}

// A Desk, the state of the window without its display, with a scene of two objects.
class DeskTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("XDG_STATE_HOME", home.path().c_str(), 1);
    desk = std::make_unique<Desk>(Settings{}, [] {});
    for (const char* name : {"ball", "box"}) {
      export_scene(scene_of(made_object({.columns = 8, .rows = 4})), home.path() / name, {});
      desk->project.open({(home.path() / name).string()});
    }
    wait();
  }
  void TearDown() override {
    desk->jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
    wait();
  }
  void wait() {
    do {
      while (desk->jobs.worker.busy() || desk->previews.busy())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      desk->update();
    } while (desk->jobs.worker.busy());
  }
  NodeId id(const char* name) const { return find(desk->scene(), std::string(name))->id; }
  std::size_t selected(const char* name) const {
    const NodePtr node = find(desk->scene(), std::string(name));
    return node->selection ? count(*node->selection) : 0;
  }
  TemporaryFolder home;
  std::unique_ptr<Desk> desk;
};

TEST_F(DeskTest, ToolsWorkOnThePickedNodes) {
  EXPECT_EQ(desk->active, std::set<NodeId>{id("box")}) << "import picks what it made";
  EXPECT_EQ(desk->scope_words(), "in box");
  Select all;
  all.all = true;
  desk->edit_scope(all);
  wait();
  EXPECT_EQ(selected("ball"), 0U);
  EXPECT_GT(selected("box"), 0U);
  EXPECT_EQ(desk->status, "Selected 64 triangles in box");
  desk->active = {id("ball")};
  EXPECT_TRUE(desk->scope(true).empty()) << "nothing is selected there";
  EXPECT_EQ(desk->deform_targets().at(0).node->id, id("ball"));
  EXPECT_FALSE(desk->deform_targets().at(0).selection);
  desk->active.clear();
  EXPECT_EQ(desk->scope_words(), "in all");
  desk->edit_scope(all);
  wait();
  EXPECT_GT(selected("ball"), 0U);
}

TEST_F(DeskTest, AnAdjustedStepStaysOneStepAndAFailureLeavesIt) {
  Transform move;
  move.node = NodeRef{id("box")};
  move.translate = Vec3(1, 0, 0);
  desk->edit(move);
  wait();
  const std::size_t steps = desk->now->steps_done;
  move.translate = Vec3(3, 0, 0);
  desk->adjust({move});
  wait();
  EXPECT_EQ(desk->now->steps_done, steps);
  EXPECT_EQ(find(desk->scene(), id("box"))->to_parent.translation().x(), 3);
  move.scale.value = Vec3(0, 1, 1);
  desk->adjust({move});
  wait();
  EXPECT_EQ(find(desk->scene(), id("box"))->to_parent.translation().x(), 3) << "refused: what was there stays";
  EXPECT_EQ(desk->now->steps_done, steps);
  EXPECT_FALSE(desk->messages.shown().empty());
}

TEST_F(DeskTest, AReleaseTakesThePreviewsScene) {
  Bend bend;
  bend.target.node = NodeRef{id("box")};
  bend.axis.axis = Vec3(1, 0, 0);
  bend.direction = Vec3(0, 1, 0);
  const auto drag = [&](double degrees) {
    bend.degrees = degrees;
    desk->show_preview({bend});
  };
  for (const double degrees : {5.0, 10.0, 20.0}) drag(degrees);
  desk->edits({bend});  // waits for the preview if it is still being computed
  wait();
  EXPECT_EQ(desk->now->done.back().as<Bend>()->degrees, 20);
  drag(30);
  wait();
  ASSERT_TRUE(desk->preview);
  const std::vector<NodePtr> previewed = desk->preview->scene.roots;
  desk->edits({bend});
  wait();
  EXPECT_EQ(desk->scene().roots, previewed);
  // An edit that no preview was requested for is applied.
  drag(40);
  wait();
  bend.degrees = 41;
  desk->edits({bend});
  wait();
  const auto* last = desk->now->done.back().as<Bend>();
  ASSERT_NE(last, nullptr);
  EXPECT_EQ(last->degrees, 41);
  // A dropped preview is not waited for.
  drag(50);
  desk->drop_preview();
  bend.degrees = 50;
  desk->edits({bend});
  wait();
  EXPECT_EQ(desk->now->steps_done, desk->now->steps.size());
}

TEST_F(DeskTest, AReleaseThatWaitsForAPreviewCanBeStopped) {
  std::atomic<bool> begun = false, go_on = false;
  desk->previews.request(desk->scene().roots, [&begun, &go_on, scene = desk->scene()](const Progress&) {
    begun = true;
    while (!go_on) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return scene;
  });
  Hide hide;
  hide.node = NodeRef{id("box")};
  const std::size_t steps = desk->now->steps_done;
  while (!begun)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));  // otherwise the next request would replace it
  desk->show_preview({hide});
  desk->edits({hide});
  desk->jobs.worker.cancel();
  while (desk->jobs.worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  go_on = true;
  wait();
  EXPECT_EQ(desk->now->steps_done, steps);
  EXPECT_TRUE(find(desk->scene(), id("box"))->visible);
  EXPECT_FALSE(desk->preview) << "what was not done is not shown";
}

TEST_F(DeskTest, TitlesSayWhatWasDoneAndNeverChange) {
  Rename rename;
  rename.node = NodeRef{id("box")};
  rename.name = "crate";
  Hide hide;
  hide.node = rename.node;
  desk->edit(hide);
  desk->edit(rename);
  wait();
  ASSERT_EQ(desk->now->steps.size(), 4U);
  EXPECT_EQ(desk->now->steps[2].title, "Hid box") << "it was called so then";
  EXPECT_EQ(desk->now->steps[3].title, "Renamed to \"crate\"");
  desk->undo();
  wait();
  EXPECT_EQ(desk->status, "Undid: Renamed to \"crate\"");
  EXPECT_EQ(desk->now->steps[3].title, "Renamed to \"crate\"");
  EXPECT_EQ(desk->now->steps_done, 3U);
}

TEST(ThemeColors, TextCanBeReadEverywhere) {
  EXPECT_NEAR(contrast({0, 0, 0}, {255, 255, 255}), 21, 1e-9);
  EXPECT_NEAR(contrast({119, 119, 119}, {255, 255, 255}), 4.48, 0.01) << "a known value of WCAG's";
  for (const Theme* theme : {&dark_theme(), &light_theme()})
    for (const auto& [text, ground] : text_pairs(*theme))
      EXPECT_GE(contrast(text, ground), 4.5) << int{text.r} << "," << int{text.g} << "," << int{text.b} << " on "
                                             << int{ground.r} << "," << int{ground.g} << "," << int{ground.b};
}

TEST(Euler, AnglesComeBackAndQuarterTurnsAreExact) {
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

TEST(SettingsFile, ComesBackAndABadOneIsSaid) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "deeper" / "settings.json";
  std::string problem;
  EXPECT_EQ(read_settings(file, problem).looks, Looks::dark);
  EXPECT_EQ(problem, "") << "none is no problem";
  Settings settings;
  settings.looks = Looks::light;
  settings.brush_radius = 33;
  for (int k = 0; k < 20; ++k) settings.remember("folder " + std::to_string(k));
  settings.remember("folder 15");
  write_settings(settings, file);
  const Settings read = read_settings(file, problem);
  EXPECT_EQ(read.looks, Looks::light);
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

TEST(ChildProcess, IsReadToItsEndAndEndsWithItsOwner) {
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
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << "it is not waited for";
}

}  // namespace
}  // namespace rebake::test
