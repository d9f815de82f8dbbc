#include "editor/studies/representations/fitted_files.h"

#include <gtest/gtest.h>

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
    const StudyInput input{[this]() -> Renderer& { return renderer; }, scene, {}, 1, {}, {}, folder.path()};
    SampleTruth truth("kettle", sizes, {});
    return fitted_files(input, sizes, "kettle", truth, folder.path());
  }
  Renderer renderer;
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

TEST_F(FittedFilesTest, DamagedResultsAreRefusedByName) {
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
