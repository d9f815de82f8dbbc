#include "editor/studies/representations/fitted_files.h"

#include <gtest/gtest.h>

#include <atomic>
#include <map>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake {
namespace {

class FittedFilesTest : public ::testing::Test {
 protected:
  FittedFilesTest() {
    sizes.resolutions = {16};
    sizes.texels = {3};
    sizes.views = 4;
    sizes.ray_side = 24;
    sizes.held_out = 1;
    sizes.picture = 32;
    sizes.most_passes = 1;
  }
  std::vector<FittedFiles> fit() {
    const Scene scene;
    const StudyInput input{[this]() -> Renderer& { return renderer; }, scene, {}, 1, progress, {}, folder.path(), say};
    SampleTruth truth("kettle", sizes, progress);
    return fitted_files(input, sizes, "kettle", truth, folder.path());
  }
  Renderer renderer;
  Progress progress;
  std::function<void(const std::string&)> say = [](const std::string&) {};
  RepresentationSizes sizes;
  test::TemporaryFolder folder;
};

TEST_F(FittedFilesTest, AreFittedOnceAndReadAfterwards) {
  const std::vector<FittedFiles> first = fit();
  ASSERT_EQ(first.size(), 3U);
  std::vector<std::string> bytes;
  for (const FittedFiles& one : first) {
    EXPECT_FALSE(one.curve.empty());
    EXPECT_GT(one.passes, 0);
    EXPECT_GT(one.minutes, 0);
    EXPECT_TRUE(std::filesystem::exists(one.folder / "baked"));
    bytes.push_back(read_file(one.folder / "fit.json"));
  }
  const std::vector<FittedFiles> again = fit();
  for (std::size_t k = 0; k < first.size(); ++k) {
    EXPECT_EQ(again[k].minutes, first[k].minutes) << "it must not be fitted again";
    EXPECT_EQ(again[k].curve, first[k].curve);
    EXPECT_EQ(read_file(again[k].folder / "fit.json"), bytes[k]);
  }
  // Other sizes are another fit.
  sizes.most_passes = 2;
  EXPECT_NE(read_file(fit().back().folder / "fit.json"), bytes.back());
}

TEST_F(FittedFilesTest, InterruptedFitsGoOnWithTheSameBytes) {
  sizes.texels = {};
  sizes.most_passes = 8;
  const auto bytes_of = [](const std::vector<FittedFiles>& all) {
    std::vector<std::map<std::string, std::string>> bytes;
    for (const FittedFiles& one : all) {
      bytes.push_back(test::folder_bytes(one.folder));
      bytes.back().erase("fit.json");
    }
    return bytes;
  };
  const std::vector<FittedFiles> whole = fit();
  const auto wanted = bytes_of(whole);
  for (const FittedFiles& one : whole) std::filesystem::remove_all(one.folder);
  std::atomic<bool> cancel = false;
  progress = Progress([](std::string_view, double) {}, &cancel);
  std::string said;
  say = [&](const std::string& line) {
    said += line + "\n";
    // During the passes after it.
    if (line.find(" after 4 passes") != std::string::npos && line.find("goes on") == std::string::npos) cancel = true;
  };
  for (int stops = 0; stops < 2; ++stops) {
    EXPECT_THROW(fit(), Cancelled);
    cancel = false;
  }
  const std::filesystem::path notes = whole.back().folder / "baked/notes.txt";
  write_file_atomically(notes, "somebody's", {});
  EXPECT_THROW(fit(), FileError);
  EXPECT_EQ(read_file(notes), "somebody's");
  std::filesystem::remove(notes);
  std::vector<FittedFiles> parts = fit();
  EXPECT_NE(said.find("goes on after 4 passes"), std::string::npos) << said;
  EXPECT_EQ(bytes_of(parts), wanted);
  for (std::size_t k = 0; k < parts.size(); ++k) EXPECT_EQ(parts[k].curve, whole[k].curve);
  // A damaged checkpoint is refused by name.
  const std::filesystem::path checkpoint = parts[0].folder / "checkpoint";
  std::filesystem::remove(parts[0].folder / "fit.json");
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
  write_file_atomically(checkpoint, "no checkpoint", {});
  try {
    fit();
    FAIL();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("checkpoint: is damaged"), std::string::npos) << error.what();
  }
}

TEST_F(FittedFilesTest, DamagedResultsAreRefusedByName) {
  sizes.texels = {};
  const std::filesystem::path file = fit().back().folder / "fit.json";
  for (const char* const damaged : {"", "{", "[]", "{\"sizes\": 3}", "null"}) {
    write_file_atomically(file, damaged, {});
    try {
      fit();
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("fit.json"), std::string::npos);
      continue;
    }
    // A result of other sizes is made again.
    EXPECT_EQ(std::string(damaged), "{\"sizes\": 3}");
  }
}

}  // namespace
}  // namespace rebake
