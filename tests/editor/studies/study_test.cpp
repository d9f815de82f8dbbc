// Files of studies: what an earlier run wrote is replaced, anything else is kept.
#include "editor/studies/study.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class StudyFiles : public ::testing::Test {
 protected:
  ~StudyFiles() override { ::setenv("PATH", path_.c_str(), 1); }
  // A stand-in for gnuplot before all other programs; empty: none at all.
  void plotter(const std::string& script) const {
    std::filesystem::create_directories(folder.path() / "bin");
    const std::filesystem::path program = folder.path() / "bin/gnuplot";
    write_text(program, "#!/bin/sh\n" + script + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    ::setenv("PATH", ((folder.path() / "bin").string() + ":" + path_).c_str(), 1);
  }
  std::filesystem::path at(const std::string& name) const { return folder.path() / "out" / name; }
  void write() const { write_study(study, table, folder.path() / "out", {}); }

  TemporaryFolder folder;
  const Study study{"textures", "help", nullptr};
  const StudyTable table{{"milliseconds", "error"}, {{"one", {1, 2}}}, 0, 1, false, false};

 private:
  std::string path_ = std::getenv("PATH");
};

TEST_F(StudyFiles, AreReplacedByALaterRun) {
  plotter("echo plot");
  write();
  write();
  EXPECT_EQ(read_file(at("textures.png")), "plot\n");
}

TEST_F(StudyFiles, AnEditedTableOrOneOfOthersIsKept) {
  plotter("echo plot");
  write();
  const std::string edited = read_file(at("textures.csv")) + "mine,1,2\n";
  write_text(at("textures.csv"), edited);
  EXPECT_THROW(write(), FileError);
  EXPECT_EQ(read_file(at("textures.csv")), edited);
  std::filesystem::remove_all(folder.path() / "out");
  std::filesystem::create_directories(folder.path() / "out");
  write_text(at("textures.csv"), "choice,votes\nred,5\n");
  EXPECT_THROW(write(), FileError);
}

// Nothing of the run before is removed until the new files are there.
TEST_F(StudyFiles, AFailedRunLeavesTheEarlierPlots) {
  plotter("echo plot");
  write();
  plotter("exit 1");
  EXPECT_THROW(write(), Error);
  EXPECT_EQ(read_file(at("textures.png")), "plot\n");
  plotter("echo again");
  write();
  EXPECT_EQ(read_file(at("textures.png")), "again\n");
}

// Without gnuplot there is a table and no plot; one of the user's must not count as the study's.
TEST_F(StudyFiles, PlotsOfOthersAreKeptAfterARunWithoutPlots) {
  plotter("exit 1");
  EXPECT_THROW(write(), Error);
  EXPECT_TRUE(std::filesystem::exists(at("textures.csv")));
  write_text(at("textures.png"), "mine");
  plotter("echo plot");
  EXPECT_THROW(write(), FileError);
  EXPECT_EQ(read_file(at("textures.png")), "mine");
}

TEST_F(StudyFiles, ChangedPicturesInTheStudysOwnFolderAreKept) {
  const Scene scene;
  const StudyInput input{{}, scene, {}, 1, {}, {}, folder.path()};
  const std::filesystem::path picture = own_folder(input, "limits") / "opacity.png";
  const Image grey{2, 1, std::vector<std::uint8_t>(6, 128)};
  for (int run = 0; run < 2; ++run) {
    EXPECT_NO_THROW(own_folder(input, "limits"));
    write_study_picture(grey, picture);
  }
  for (const std::string& other : {read_file(picture) + "retouched", std::string("a photograph")}) {
    write_text(picture, other);
    EXPECT_THROW(own_folder(input, "limits"), FileError) << "before anything is computed";
    EXPECT_THROW(write_study_picture(grey, picture), FileError);
    EXPECT_EQ(read_file(picture), other);
  }
}

TEST_F(StudyFiles, AnInputInTheStudysOwnFolderIsRefused) {
  const Scene scene;
  StudyInput input{{}, scene, {}, 1, {}, {}, folder.path()};
  const std::filesystem::path own = own_folder(input, "limits");
  std::filesystem::create_directories(own / "kettle");
  write_text(own / "kettle/mlp.json", "{}");
  input.sources.add_file(own / "kettle/mlp.json");
  EXPECT_THROW(own_folder(input, "limits"), FileError);
}

}  // namespace
}  // namespace rebake::test
