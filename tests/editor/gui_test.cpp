// What the window is made of, without a window: keys, typed numbers, settings, the worker.
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <chrono>
#include <set>
#include <sstream>
#include <thread>

#include "editor/gui/panels/euler.h"
#include "editor/gui/tools/expression.h"
#include "editor/gui/tools/typed_number.h"
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
    ASSERT_EQ(desk.messages.error, "");
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

TEST(Euler, AnglesComeBackAndQuarterTurnsAreExact) {
  for (const Vec3& degrees : {Vec3(10, 20, 30), Vec3(-170, 80, 95), Vec3(179, -89.9, -179), Vec3(0, 0, 0)}) {
    EXPECT_LT((euler_degrees(rotation_of(degrees)) - degrees).norm(), 1e-11) << degrees.transpose();
    EXPECT_TRUE(rotation_of(degrees).isUnitary(1e-15));
  }
  EXPECT_EQ(rotation_of({90, 0, 0}) * Vec3::UnitY(), Vec3::UnitZ());
  EXPECT_EQ(rotation_of({90, 90, 0}) * Vec3::UnitY(), Vec3::UnitX()) << "about X first, then about Y";
  EXPECT_EQ(rotation_of({0, 180, 0}).diagonal(), Vec3(-1, 1, -1));
  // Where two axes fall together the angles are others, the rotation is the same.
  for (const double y : {90.0, -90.0}) {
    const Mat3 locked = rotation_of({25, y, 60});
    EXPECT_LT((rotation_of(euler_degrees(locked)) - locked).norm(), 1e-12);
  }
}

TEST(SettingsFile, ComesBackAndABadOneIsSaid) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "deeper" / "settings.json";
  std::string problem;
  EXPECT_TRUE(read_settings(file, problem).dark);
  EXPECT_EQ(problem, "") << "none is no problem";
  Settings settings;
  settings.dark = false;
  settings.brush_radius = 33;
  for (int k = 0; k < 20; ++k) settings.remember("folder " + std::to_string(k));
  settings.remember("folder 15");
  write_settings(settings, file);
  const Settings read = read_settings(file, problem);
  EXPECT_FALSE(read.dark);
  EXPECT_EQ(read.brush_radius, 33);
  ASSERT_EQ(read.recent.size(), 12U);
  EXPECT_EQ(read.recent[0], "folder 15");
  EXPECT_EQ(read.recent[1], "folder 19");
  for (const char* text : {"{", "[]", R"({"dark": 3})", R"({"brush_radius": "wide"})"}) {
    write_file_atomically(file, text, {});
    problem.clear();
    EXPECT_TRUE(read_settings(file, problem).dark) << text;
    EXPECT_NE(problem.find(file.string()), std::string::npos) << text;
  }
  write_file_atomically(file, R"({"side_width": -5, "window_width": 1000000, "something_newer": 1})", {});
  EXPECT_EQ(read_settings(file, problem).side_width, 200);
}

}  // namespace
}  // namespace rebake::test
