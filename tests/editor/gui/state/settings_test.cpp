// The settings file.
#include <gtest/gtest.h>

#include "editor/gui/state/settings.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

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
  write_settings(settings, {}, file);
  const Settings read = read_settings(file, problem);
  EXPECT_EQ(read.looks, ColorTheme::light);
  EXPECT_EQ(read.brush_radius, 33);
  ASSERT_EQ(read.recent.size(), 12U);
  EXPECT_EQ(read.recent[0], "folder 15");
  EXPECT_EQ(read.recent[1], "folder 19");
  int number = 0;
  for (const char* text : {"{", "[]", R"({"text_scale": []})", R"({"brush_radius": "wide"})"}) {
    write_file_atomically(file, text, {});
    problem.clear();
    EXPECT_EQ(read_settings(file, problem), Settings{}) << text;
    EXPECT_NE(problem.find(file.string()), std::string::npos) << text;
    write_settings(settings, {}, file);
    const auto kept = file.string() + ".unreadable" + (number++ == 0 ? "" : "-" + std::to_string(number));
    EXPECT_EQ(read_file(kept), text) << "what a person edited is not lost";
  }
  write_file_atomically(file, R"({"side_width": -5, "window_width": 1000000, "something_newer": 1})", {});
  EXPECT_EQ(read_settings(file, problem).side_width, 200);
}

TEST(SettingsFile, KeepsWhatPeopleWriteThereMeanwhile) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "settings.json";
  Settings known, now;
  write_settings(now, known, file);
  std::string text = read_file(file);
  const std::string scale = R"("text_scale": 1.0)";
  ASSERT_NE(text.find(scale), std::string::npos) << text;
  text.replace(text.find(scale), scale.size(), R"("text_scale": 1.5, "of a newer build": 7)");
  write_file_atomically(file, text, {});
  now.grid = !now.grid;
  write_settings(now, known, file);
  std::string problem;
  const Settings read = read_settings(file, problem);
  EXPECT_EQ(problem, "");
  EXPECT_EQ(read.grid, now.grid);
  EXPECT_EQ(read.text_scale, 1.5);
  EXPECT_NE(read_file(file).find("of a newer build"), std::string::npos);
}

}  // namespace
}  // namespace rebake::test
