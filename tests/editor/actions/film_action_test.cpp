// Films: resumed, replaced and refused.
#include "editor/actions/film_action.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "render/image.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class FilmActionTest : public Script {
 protected:
  FilmActionTest() {
    session.say = [&](const std::string& line) { said_ += line + "\n"; };
    run(import + R"({"op": "key", "node": "ball", "time": 0, "interpolation": "linear"}
{"op": "key", "node": "ball", "time": 1, "position": [1, 0, 0]})");
  }
  ~FilmActionTest() override { ::setenv("PATH", path_.c_str(), 1); }

  fs::path at(const std::string& name) const { return folder_.path() / name; }
  std::string film(const std::string& more) const {
    return fmt::format(R"({{"op": "film", "width": 40, "height": 30, "fps": 4, {}}})", more);
  }
  // Puts a stand-in for ffmpeg before all other programs.
  void encoder(const std::string& script) const {
    fs::create_directories(at("bin"));
    write_text(at("bin/ffmpeg"), "#!/bin/sh\n" + script + "\n");
    fs::permissions(at("bin/ffmpeg"), fs::perms::owner_all);
    ::setenv("PATH", (at("bin").string() + ":" + path_).c_str(), 1);
  }
  std::string said() { return std::exchange(said_, ""); }

 private:
  std::string said_, path_ = std::getenv("PATH");
};

TEST_F(FilmActionTest, GoesOnAfterAnInterruptionWithTheSamePictures) {
  run(film(R"("out": "{here}/film")"));
  const auto all = folder_bytes(at("film"));
  ASSERT_EQ(all.size(), 6U);  // 5 pictures and film.json
  EXPECT_NE(all.at("00000.png"), all.at("00004.png"));
  fs::remove(at("film/00002.png"));
  fs::remove(at("film/00004.png"));
  said();
  run(film(R"("out": "{here}/film")"));
  EXPECT_EQ(folder_bytes(at("film")), all);
  const std::string words = said();
  EXPECT_NE(words.find("3 of 5 pictures exist already"), std::string::npos) << words;
  EXPECT_NE(words.find("wrote 2 pictures; "), std::string::npos) << words;
  EXPECT_NE(words.find("film holds the whole film now: 5 pictures"), std::string::npos) << words;
  // A picture that is not as it was written may hold somebody's work. What a killed run left is removed.
  write_text(at("film/00001.png"), all.at("00001.png") + "retouched");
  expect_error(film(R"("out": "{here}/film")"), "was changed or damaged since");
  fs::remove(at("film/00001.png"));
  write_text(at("film/00003.png.1234abcd.rebake-partial"), "half of a picture");
  run(film(R"("out": "{here}/film")"));
  EXPECT_EQ(folder_bytes(at("film")), all);
  // Pictures of an edited scene need another folder.
  run(R"({"op": "transform", "node": "ball", "scale": 0.5})"
      "\n"
      R"({"op": "key", "node": "ball", "time": 1, "position": [0, 1, 0]})");
  expect_error(film(R"("out": "{here}/film")"), "holds pictures of another film");
  EXPECT_EQ(folder_bytes(at("film")), all);
}

TEST_F(FilmActionTest, NeverReplacesOtherFiles) {
  fs::create_directories(at("mine"));
  write_text(at("mine/00000.png"), "a picture of mine");
  expect_error(film(R"("out": "{here}/mine")"), "is not a film's folder");
  EXPECT_EQ(read_file(at("mine/00000.png")), "a picture of mine");
  run(film(R"("out": "{here}/film")"));
  for (const char* mine : {"film/notes.txt", "film/20240131.txt", "film/00099.png"}) {
    write_text(at(mine), "mine");
    expect_error(film(R"("out": "{here}/film")"), "which is not part of its film");
    EXPECT_EQ(read_file(at(mine)), "mine");
    fs::remove(at(mine));
  }
  encoder("exit 0");
  write_text(at("a.mp4"), "a file of mine");
  expect_error(film(R"("out": "{here}/a.mp4")"), "is not a video of Rebake");
  expect_error(film(R"("out": "{here}/ball/x.mp4")"), "ball");
}

TEST_F(FilmActionTest, DistinguishesFormatsAndObjectsThatOnlyCastShadows) {
  run(film(R"("out": "{here}/film")"));
  expect_error(film(R"("out": "{here}/film", "picture": "jpg")"), "holds pictures of another film");
  run(R"({"op": "import", "path": "{here}/ball", "as": "other"}
{"op": "light", "effects": ["self", "cast"], "source": "sky", "rays": 16}
)" + film(R"("out": "{here}/part", "nodes": ["ball"])"));
  const auto before = folder_bytes(at("part"));
  run(R"({"op": "transform", "node": "other", "translate": [0, 3, 0]})");
  expect_error(film(R"("out": "{here}/part", "nodes": ["ball"])"), "holds pictures of another film");
  EXPECT_EQ(folder_bytes(at("part")), before);
}

TEST_F(FilmActionTest, LeavesFoldersOfRunningFilmsAndForeignPartsAlone) {
  run(film(R"("out": "{here}/film")"));
  write_text(at("film/00003.png.1234abcd.rebake-partial"), "half of a picture");
  {
    const FolderLock other(at("film"));
    expect_error(film(R"("out": "{here}/film")"), "in use: another run writes its film there");
    EXPECT_TRUE(fs::exists(at("film/00003.png.1234abcd.rebake-partial")));
  }
  fs::create_directories(at("mine"));
  write_text(at("mine/film.json.mine.rebake-partial"), "my notes");
  expect_error(film(R"("out": "{here}/mine")"), "is not a film's folder");
  EXPECT_EQ(read_file(at("mine/film.json.mine.rebake-partial")), "my notes");
}

TEST_F(FilmActionTest, ProtectsItsCameraFile) {
  run(R"({"op": "view", "name": "x", "camera": {"eye": [0, 3, 4], "target": [0, 0, 0]}}
{"op": "view", "name": "y", "camera": {"eye": [0, -3, 4], "target": [0, 0, 0]}}
{"op": "export_views", "out": "{here}/cams.json", "format": "nerfstudio_path"}
)" + film(R"("out": "{here}/film", "path": "{here}/cams.json")"));
  const std::string cameras = read_file(at("cams.json"));
  expect_error(R"({"op": "export_views", "out": "{here}/cams.json"})", "is a camera file of this run");
  EXPECT_EQ(read_file(at("cams.json")), cameras);
}

TEST_F(FilmActionTest, KeepsThePicturesIfTheEncoderFails) {
  encoder("exit 7");
  expect_error(film(R"("out": "{here}/a.mp4")"), "ffmpeg failed with exit status 7");
  EXPECT_FALSE(fs::exists(at("a.mp4")));
  EXPECT_TRUE(fs::exists(at("a.mp4.pictures/00004.png")));
  encoder(R"(for last; do :; done; printf 'a video' > "$last")");
  said();
  run(film(R"("out": "{here}/a.mp4")"));
  EXPECT_NE(said().find("5 of 5 pictures exist already"), std::string::npos);
  EXPECT_TRUE(read_file(at("a.mp4")).starts_with("a video"));
  EXPECT_FALSE(fs::exists(at("a.mp4.pictures")));
}

// Also not if the other program copies the text that names Rebake.
TEST_F(FilmActionTest, ReplacesItsOwnVideosButNotThoseCutFromThem) {
  encoder(R"(for last; do :; done; printf 'a video' > "$last")");
  for (const char* name : {"a.mp4", "a.webm"}) {
    const std::string options = fmt::format(R"("out": "{{here}}/{}")", name);
    run(film(options.c_str()));
    const std::string first = read_file(at(name));
    run(film(options.c_str()));
    EXPECT_EQ(read_file(at(name)), first);
    for (const std::string& cut : {"cut " + first, first + " and music", first.substr(1)}) {
      write_text(at(name), cut);
      expect_error(film(options.c_str()), "is not a video of Rebake");
      EXPECT_EQ(read_file(at(name)), cut);
    }
  }
}

// Someone may have put a picture of their own among those of a video that failed.
TEST_F(FilmActionTest, PicturesOfOthersAmongThoseOfAVideoAreKept) {
  encoder("exit 7");
  expect_error(film(R"("out": "{here}/a.mp4")"), "ffmpeg failed with exit status 7");
  const std::string mine = "\x89PNG of somebody";
  write_text(at("a.mp4.pictures/00003.png"), mine);
  encoder(R"(for last; do :; done; printf 'a video' > "$last")");
  for (const char* options : {R"("out": "{here}/a.mp4", "samples": 1)", R"("out": "{here}/a.mp4")"})
    expect_error(film(options), "was not rendered by Rebake");
  EXPECT_EQ(read_file(at("a.mp4.pictures/00003.png")), mine);
}

// A folder of pictures that was asked for is never taken for the temporary pictures of a video.
TEST_F(FilmActionTest, VideosDoNotRemovePicturesThatWereAskedFor) {
  encoder(R"(for last; do :; done; printf 'a video' > "$last")");
  run(film(R"("out": "{here}/a.mp4.pictures")"));
  const auto pictures = folder_bytes(at("a.mp4.pictures"));
  expect_error(film(R"("out": "{here}/a.mp4")"), "because they were asked for");
  EXPECT_EQ(folder_bytes(at("a.mp4.pictures")), pictures);
  // Also if they were rendered for a video that failed, and asked for later.
  encoder("exit 7");
  expect_error(film(R"("out": "{here}/b.mp4")"), "ffmpeg failed with exit status 7");
  run(film(R"("out": "{here}/b.mp4.pictures")"));
  encoder(R"(for last; do :; done; printf 'a video' > "$last")");
  expect_error(film(R"("out": "{here}/b.mp4")"), "because they were asked for");
  EXPECT_TRUE(fs::exists(at("b.mp4.pictures/00004.png")));
}

TEST_F(FilmActionTest, RenderedPicturesDoNotBecomeFramesOfAnUnfinishedFilm) {
  run(film(R"("out": "{here}/a")"));
  fs::remove(at("a/00002.png"));
  expect_error(R"({"op": "render", "out": "{here}/a/00002.png", "width": 40, "height": 30})",
               "would be a picture of the film");
  EXPECT_FALSE(fs::exists(at("a/00002.png")));
}

TEST_F(FilmActionTest, SaysWhatIsMissingOrDoesNotFit) {
  ::setenv("PATH", at("empty").c_str(), 1);
  expect_error(film(R"("out": "{here}/a.mp4")"), "needs the program ffmpeg");
  encoder("exit 0");
  expect_error(film(R"("out": "{here}/a.mp4", "transparent": true)"), "MP4 has no alpha");
  expect_error(film(R"("out": "{here}/a.mov")"), "written as .mp4 and .webm");
  expect_error(film(R"("out": "{here}/a.png")"), "names a picture");
  expect_error(film(R"("out": "{here}/f", "panorama": true)"), "twice its height");
  expect_error(film(R"("out": "{here}/f", "passes": ["depth"])"), "set picture to exr");
  expect_error(film(R"("out": "{here}/f", "picture": "exr", "passes": ["dept"])"), "known: color, alpha");
  EXPECT_FALSE(fs::exists(at("f")));
}

}  // namespace
}  // namespace rebake::test
