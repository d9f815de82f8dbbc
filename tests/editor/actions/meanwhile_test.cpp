// Files that other programs write while a run is busy are kept, even if their names are those of its outputs.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/files.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/scene_files.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class Meanwhile : public Script {
 protected:
  Meanwhile() {
    run(import + R"({"op": "view", "name": "a", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}}
{"op": "view", "name": "b", "camera": {"eye": [3, 1, 4], "target": [0, 0, 0], "fov": 30}})");
    fs::create_directories(at("cap"));
  }
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  // Calls `act` once, at the first step of the progress whose name begins so.
  void when(const std::string& step, const std::function<void()>& act) {
    session.progress = Progress([step, act, done = false](std::string_view what, double) mutable {
      if (done || !what.starts_with(step)) return;
      done = true;
      act();
    });
  }
  // A picture of another program.
  std::string photograph(const std::string& name) const {
    write_text(at(name), encode_png(2, 2, 3, std::vector<std::uint8_t>(12, 200), 1));
    return read_file(at(name));
  }
};

TEST_F(Meanwhile, PicturesWhereAContactSheetGoesAreKept) {
  std::string mine;
  when("rendering b", [&] { mine = photograph("sheet.png"); });
  const std::string sheet =
      R"({"op": "render", "out": "{here}/sheet.png", "sheet": [2, 1], "width": 16, "height": 16})";
  expect_error(sheet, "sheet.png: exists and was not made by Rebake");
  EXPECT_EQ(read_file(at("sheet.png")), mine);
  fs::remove(at("sheet.png"));
  run(sheet);
  run(sheet);
}

TEST_F(Meanwhile, PicturesWhereAFilmGoesAreKept) {
  const std::string film =
      R"({"op": "film", "path": "turntable", "fps": 1, "seconds": 4, "width": 16, "height": 16, "out": "{here}/film"})";
  std::string mine;
  when("picture 2 of", [&] { mine = photograph("film/00003.png"); });
  expect_error(film, "00003.png: was not rendered by Rebake");
  EXPECT_EQ(read_file(at("film/00003.png")), mine);
  fs::remove(at("film/00003.png"));
  photograph("mine.png");
  when("picture 2 of", [] { FAIL() << "it exists already"; });
  when("picture 4 of", [&] { fs::create_symlink(at("mine.png"), at("film/00003.png")); });
  expect_error(film, "00003.png: is a link");
  EXPECT_EQ(read_file(at("mine.png")), mine);
  fs::remove(at("film/00003.png"));
  session.progress = {};
  run(film);
}

TEST_F(Meanwhile, PicturesWhereTheWorstViewsGoAreKept) {
  run(R"({"op": "export_views", "out": "{here}/cap/transforms.json", "width": 16, "height": 16}
{"op": "render", "view": "a", "out": "{here}/cap/a.png", "width": 16, "height": 16}
{"op": "render", "view": "b", "out": "{here}/cap/b.png", "width": 16, "height": 16})");
  std::string mine;
  when("comparing photograph 2", [&] { mine = photograph("out/worst.png"); });
  expect_error(R"({"op": "compare_photographs", "cameras": "{here}/cap/transforms.json", "out": "{here}/out"})",
               "worst.png: exists and was not made by Rebake");
  EXPECT_EQ(read_file(at("out/worst.png")), mine);
}

TEST_F(Meanwhile, ScenesWhereAFittedOneGoesAreKept) {
  run(R"({"op": "import", "path": "{here}/other", "as": "other"})");
  const std::string plain =
      R"({"op": "export", "plain": true, "seconds": 0.01, "picture_size": 16, "out": "{here}/out"})";
  for (const char* before : {"", "ball"}) {
    if (*before != '\0') fs::copy(at(before), at("out"));
    when("", [&] {
      fs::remove_all(at("out"));
      fs::copy(at("other"), at("out"));
    });
    expect_error(plain, "was written by something else during the computation");
    EXPECT_EQ(folder_hash(at("out")), folder_hash(at("other")));
    fs::remove_all(at("out"));
  }
  session.progress = {};
  run(plain);
  run(plain);
}

// Runs the program while ffmpeg, called for the film of a script, is a stand-in that runs these commands.
int run_with_encoder(const fs::path& folder, const std::string& commands, const std::string& arguments) {
  fs::create_directories(folder / "bin");
  write_text(folder / "bin/ffmpeg", "#!/bin/sh\ncd '" + folder.string() + "'\n" + commands + "\nexit 1\n");
  fs::permissions(folder / "bin/ffmpeg", fs::perms::owner_all);
  const std::string command = fmt::format("cd '{0}' && PATH='{0}/bin':\"$PATH\" '{1}' {2} >log 2>&1", folder.string(),
                                          REBAKE_PROGRAM, arguments);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Meanwhile, NotesWhereTheReportOfABatchGoesAreKept) {
  write_text(
      at("s.jsonl"),
      R"({"op": "film", "path": "turntable", "fps": 1, "seconds": 1, "width": 16, "height": 16, "out": "{name}.mp4"})");
  write_text(at("precious"), "my text");
  for (const char* commands :
       {"echo my notes >results/report.jsonl", "rm results/report.jsonl; ln -s ../precious results/report.jsonl"}) {
    EXPECT_EQ(run_with_encoder(folder_.path(), commands, "batch s.jsonl --scenes ball -o results"), 1);
    EXPECT_NE(read_file(at("log")).find("report.jsonl: is not a batch report"), std::string::npos)
        << read_file(at("log"));
    EXPECT_EQ(read_file(at("precious")), "my text");
    EXPECT_EQ(read_file(at("results/report.jsonl")),
              fs::is_symlink(at("results/report.jsonl")) ? "my text" : "my notes\n");
    fs::remove_all(at("results"));
  }
}

TEST_F(Meanwhile, ScenesWhereTheResultOfAScriptGoesAreKept) {
  write_text(
      at("s.jsonl"),
      R"({"op": "film", "path": "turntable", "fps": 1, "seconds": 1, "width": 16, "height": 16, "out": "a.mp4"})");
  // The encoder fails only after a video exists; a script goes on if its film succeeds.
  EXPECT_EQ(run_with_encoder(folder_.path(), "cp -r other out; for last; do :; done; printf x >\"$last\"; exit 0",
                             "run s.jsonl --scene ball --out out"),
            1);
  EXPECT_NE(read_file(at("log")).find("out: was written by something else during the run"), std::string::npos)
      << read_file(at("log"));
  EXPECT_EQ(folder_hash(at("out")), folder_hash(at("other")));
}

}  // namespace
}  // namespace rebake::test
