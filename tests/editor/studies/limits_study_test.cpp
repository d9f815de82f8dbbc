#include <gtest/gtest.h>

#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"
#include "tests/support/thorough.h"

namespace rebake {
namespace {

TEST(OwnFolder, OfAStudyContainsNoLinks) {
  const test::TemporaryFolder folder;
  Renderer renderer;
  const Scene scene;
  const StudyInput input{[&]() -> Renderer& { return renderer; }, scene, {}, 1, {}, {}, folder.path()};
  const std::filesystem::path own = own_folder(input, "limits");
  EXPECT_EQ(own_folder(input, "limits"), own) << "the folder of an earlier run";
  std::filesystem::create_directories(own / "deeper");
  std::filesystem::create_symlink("/nowhere/photograph.png", own / "deeper/opacity.png");
  EXPECT_THROW(own_folder(input, "limits"), FileError);
}

TEST(LimitsStudy, MeasuresThreeLimitsAndGoesOnWithBakedScenes) {
  REBAKE_ONLY_DEEP();
  const test::TemporaryFolder folder;
  Renderer renderer;
  const Scene scene;
  StudyInput input{[&]() -> Renderer& { return renderer; }, scene, {}, 1, {}, {}, folder.path()};
  input.quick = true;
  const StudyTable first = study_limits(input);
  for (const char* file : {"close-up-pictures.png", "opacity.png"})
    EXPECT_TRUE(std::filesystem::exists(folder.path() / "limits" / file)) << file;
  const auto baked = [&] {
    std::vector<std::filesystem::file_time_type> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "limits"))
      if (entry.is_directory()) found.push_back(std::filesystem::last_write_time(entry.path() / "mlp.json"));
    return found;
  };
  const auto before = baked();
  EXPECT_EQ(before.size(), 6U);
  const StudyTable again = study_limits(input);
  EXPECT_EQ(baked(), before) << "nothing is baked twice";
  ASSERT_EQ(again.rows.size(), first.rows.size());
  for (std::size_t row = 0; row < first.rows.size(); ++row)
    EXPECT_EQ(again.rows[row].values[1], first.rows[row].values[1]) << first.rows[row].choice;
  // Nearer is worse, and a part of half opacity is drawn best by every other texel.
  EXPECT_GT(first.rows[0].values[1], first.rows[4].values[1]);
  EXPECT_GT(first.rows[18].values[1], std::max(first.rows[15].values[1], first.rows[16].values[1]));
}

}  // namespace
}  // namespace rebake
