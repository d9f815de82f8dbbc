// Outputs of a run must not overwrite its inputs, by any path: its journal, script, project, cage meshes and camera
// files.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "editor/actions/session.h"
#include "editor/edits/nodes/import.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class Guards : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  void write(const std::string& name, const std::string& text) const { write_file_atomically(path(name), text, {}); }
  // Exit status of the program; {} in the arguments is replaced by the test's folder.
  int program(std::string arguments) const {
    for (std::size_t at = 0; (at = arguments.find("{}", at)) != std::string::npos;)
      arguments.replace(at, 2, folder_.path().string());
    const std::string command = fmt::format("'{}' {} >'{}' 2>&1", REBAKE_PROGRAM, arguments, path("log").string());
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string log() const { return read_file(path("log")); }
  std::string import_line() const {
    return fmt::format("{{\"op\": \"import\", \"path\": \"{}/samples/scenes/kettle\", \"as\": \"kettle\"}}\n",
                       REBAKE_SOURCE);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Guards, RejectsOutputsOverTheJournal) {
  fs::create_directory_symlink(path("."), path("link"));
  for (const std::string out : {"work.journal", "link/work.journal", "./work.journal"})
    for (const std::string line :
         {R"({"op": "render", "out": "OUT", "width": 16, "height": 16})", R"({"op": "save_project", "out": "OUT"})",
          R"({"op": "export", "out": "OUT-folder", "plain": true, "report": "OUT"})"}) {
      std::string text = line;
      text.replace(text.find("OUT\""), 3, path(out).string());
      if (const std::size_t at = text.find("OUT-"); at != std::string::npos) text.replace(at, 3, path("x").string());
      write("script.jsonl", import_line() + text);
      EXPECT_EQ(program("run {}/script.jsonl --journal {}/work.journal"), 1) << line;
      EXPECT_EQ(program("recover {}/work.journal -o {}/back.rebake --replace"), 0) << line << '\n' << log();
      EXPECT_NE(log().find("1 edit recovered"), std::string::npos) << log();
      fs::remove(path("work.journal"));
    }
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --journal {}/work.journal --list-files {}/work.journal"), 1);
  EXPECT_EQ(program("recover {}/work.journal -o {}/back.rebake --replace"), 0) << log();
}

TEST_F(Guards, ListsOfFilesReplaceOnlyLists) {
  write("script.jsonl", import_line() + fmt::format(R"({{"op": "render", "out": "{}", "width": 8, "height": 8}})",
                                                    path("r.png").string()));
  write("notes.txt", "mine\n");
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/notes.txt"), 1);
  EXPECT_NE(log().find("is not a list of files"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("notes.txt")), "mine\n");
  EXPECT_FALSE(fs::exists(path("r.png"))) << "refused before the run";
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(program("run {}/script.jsonl --list-files {}/list"), 0) << log();
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/r.png"), 1);
  EXPECT_TRUE(read_file(path("r.png")).starts_with("\x89PNG")) << "an output of the same run";
}

TEST_F(Guards, ViewsReplaceOnlyCameraFiles) {
  const std::string out = path("views.json").string();
  write("script.jsonl", import_line() +
                            R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})" + "\n" +
                            fmt::format(R"({{"op": "export_views", "out": "{}"}})", out));
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
  write("views.json", R"({"mine": 1})");
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_EQ(read_file(out), R"({"mine": 1})");
}

TEST_F(Guards, RejectsProjectOverAnotherJournal) {
  write("script.jsonl", import_line() + R"({"op": "no such op"})");
  EXPECT_EQ(program("run {}/script.jsonl --journal {}/other.rebake"), 1);
  write("save.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}", path("other.rebake").string()));
  EXPECT_EQ(program("run {}/save.jsonl"), 1);
  EXPECT_NE(log().find("is a journal that may contain unsaved work:"), std::string::npos) << log();
  EXPECT_EQ(program("recover {}/other.rebake -o {}/back.rebake"), 0) << log();
}

TEST_F(Guards, RejectsOutputsOverAnotherRunsJournal) {
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  const std::string journal = read_file(path("left.journal"));
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/left.journal"), 1);
  EXPECT_NE(log().find("may contain unsaved work"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("left.journal")), journal);
}

TEST_F(Guards, ProjectsAreNotReplacedByOtherOutputsNorBySmallerProjects) {
  const std::string save = fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string());
  write("large.jsonl", import_line() + R"({"op": "background", "color": [1, 0, 0]})" + "\n" + save);
  write("small.jsonl", import_line() + save);
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_EQ(log().find("it replaced a project"), std::string::npos) << log();
  write("large.jsonl", import_line() + R"({"op": "background", "color": [0, 1, 0]})" + "\n" + save);
  EXPECT_EQ(program("run {}/large.jsonl"), 0) << log();
  EXPECT_NE(log().find("it replaced a project with 1 other edits"), std::string::npos) << log();
  const std::string project = read_file(path("p.rebake"));
  for (const char* command :
       {"run {}/small.jsonl", "run {}/small.jsonl --list-files {}/p.rebake", "render {}/p.rebake -o {}/p.rebake",
        "render " REBAKE_SOURCE "/samples/scenes/kettle -o {}/p.rebake --size 8x8"})
    EXPECT_EQ(program(command), 1) << command;
  write("views.jsonl", import_line() +
                           R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})" + "\n" +
                           fmt::format("{{\"op\": \"export_views\", \"out\": \"{}\"}}", path("p.rebake").string()));
  EXPECT_EQ(program("run {}/views.jsonl"), 1);
  EXPECT_NE(log().find("is a project, whose edits would be lost"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("p.rebake")), project);
  write("p.rebake", R"({"rebake_project": 99, "sources": [], "edits": []})");
  EXPECT_EQ(program("run {}/large.jsonl"), 1);
  EXPECT_NE(log().find("newer version"), std::string::npos) << log();
}

TEST_F(Guards, ScenesBeforeTheEditsOfAPageAreProtected) {
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  fs::copy(kettle, path("source"));
  ASSERT_EQ(program("export " + kettle + " -o {}/scene --format rebake"), 0) << log();
  write("make.jsonl",
        fmt::format("{{\"op\": \"import\", \"path\": \"{0}/source\"}}\n{{\"op\": \"save_project\", \"out\": "
                    "\"{0}/before.rebake\"}}\n",
                    path("").parent_path().string()));
  ASSERT_EQ(program("run {}/make.jsonl"), 0) << log();
  const std::string publish = R"({"op": "publish", "out": "FOLDER/page", "before": "FOLDER/BEFORE"})"
                              "\n";
  for (const auto& [before, line] : std::vector<std::pair<std::string, std::string>>{
           {"scene", R"({"op": "save", "out": "FOLDER/scene"})"},
           {"before.rebake", R"({"op": "save_project", "out": "FOLDER/before.rebake"})"},
           {"before.rebake", R"({"op": "export", "out": "FOLDER/source"})"}}) {
    std::string script = import_line() + publish + line + "\n";
    for (const auto& [word, text] :
         {std::pair<std::string, std::string>{"BEFORE", before}, {"FOLDER", path("").parent_path().string()}})
      for (std::size_t at = 0; (at = script.find(word, at)) != std::string::npos;)
        script.replace(at, word.size(), text);
    write("s.jsonl", script);
    const auto scene = folder_bytes(path("scene")), source = folder_bytes(path("source"));
    const std::string project = read_file(path("before.rebake"));
    EXPECT_EQ(program("run {}/s.jsonl"), 1) << line;
    EXPECT_NE(log().find("scene before the edits"), std::string::npos) << log();
    EXPECT_EQ(folder_bytes(path("scene")), scene);
    EXPECT_EQ(folder_bytes(path("source")), source);
    EXPECT_EQ(read_file(path("before.rebake")), project);
  }
}

TEST_F(Guards, CameraFilesOfOthersAreKept) {
  write("sprites.json", R"({"frames": {"hero.png": {"x": 1}}, "meta": {"app": "Packer"}})");
  write("poses.json",
        R"({"camera_angle_x": 0.7, "frames": [{"file_path": "/data/0.jpg",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  const std::string views = import_line() +
                            R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})"
                            "\n"
                            R"({"op": "view", "name": "w", "camera": {"eye": [0, 0, 6], "target": [0, 0, 0]}})"
                            "\n";
  const auto export_to = [&](const std::string& name, const std::string& more) {
    write("s.jsonl",
          views + more + fmt::format("{{\"op\": \"export_views\", \"out\": \"{}\"}}\n", path(name).string()));
    return program("run {}/s.jsonl");
  };
  // Another program's file with pictures of the same names.
  write("same.json", R"({"camera_angle_x": 0.7, "aabb_scale": 4, "frames": [{"file_path": "images/v.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  // Files of Rebake of other kinds.
  write("rebake_training.json", R"({"software": "Rebake", "plan": "64"})");
  for (const char* name : {"sprites.json", "poses.json", "same.json", "rebake_training.json"}) {
    const std::string before = read_file(path(name));
    EXPECT_EQ(export_to(name, ""), 1) << name;
    EXPECT_EQ(read_file(path(name)), before);
  }
  // Own files are replaced, also after a view got another name.
  EXPECT_EQ(export_to("own.json", ""), 0) << log();
  EXPECT_EQ(export_to("own.json", R"({"op": "view", "name": "x", "camera": {"eye": [0, 1, 6], "target": [0, 0, 0]}})"
                                  "\n"),
            0)
      << log();
  // Until someone changes them.
  std::string changed = read_file(path("own.json"));
  changed.replace(changed.find("fl_x"), 4, "FL_X");
  write("own.json", changed);
  EXPECT_EQ(export_to("own.json", ""), 1) << log();
  EXPECT_EQ(read_file(path("own.json")), changed);
}

TEST_F(Guards, ReportsOfTrainingAreReplacedWithTheirSceneButOtherFilesOfThatNameAreNot) {
  write("s.jsonl", import_line() + fmt::format("{{\"op\": \"export\", \"out\": \"{}\"}}\n", path("scene").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  write("scene/rebake_training.json", "notes");
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("scene/rebake_training.json")), "notes");
  write("scene/rebake_training.json", R"({"software": "Rebake"})");
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_FALSE(fs::exists(path("scene/rebake_training.json"))) << "the report of another scene";
}

TEST_F(Guards, RenderedPhotographsAreNotReplacedButOwnPicturesAre) {
  fs::create_directories(path("cap/images"));
  fs::create_directories(path("edited"));
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  ASSERT_EQ(program("render " + kettle + " -o {}/cap/images/0.png --size 16x16"), 0) << log();
  write("cap/transforms.json",
        R"({"camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [{"file_path": "images/0.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  const std::string photograph = read_file(path("cap/images/0.png"));
  const std::string render = "render " + kettle + " --cameras {}/cap/transforms.json -o {}/";
  EXPECT_EQ(program(render + "cap/images"), 1);
  EXPECT_EQ(read_file(path("cap/images/0.png")), photograph);
  for (int run = 0; run < 2; ++run) EXPECT_EQ(program(render + "cap/renders"), 0) << log();
  write("edited/0.png", "\x89PNG of somebody else");
  EXPECT_EQ(program(render + "edited"), 1);
  EXPECT_NE(log().find("was not rendered by Rebake"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("edited/0.png")), "\x89PNG of somebody else");
}

TEST_F(Guards, ScriptsThatSaveOneProjectSeveralTimesRunAgain) {
  const std::string save = fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string());
  const std::string red = R"({"op": "background", "color": [1, 0, 0]})"
                          "\n";
  write("s.jsonl", import_line() + save + red + save + save);
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_EQ(log().find("a later line"), std::string::npos) << log();
  const std::string project = read_file(path("p.rebake"));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_NE(log().find("has more edits already; a later line"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("p.rebake")), project);
  // A script that fails between its saves leaves the project of the run before.
  write("s.jsonl", import_line() + save + "{}\n" + save);
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("p.rebake")), project);
}

TEST_F(Guards, FilesBesideMeshesAreProtected) {
  fs::create_directories(path("obj"));
  write("obj/m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  write("obj/m.mtl", "newmtl a\nKd 1 0 0\n");
  const std::string before = read_file(path("obj/m.mtl"));
  write("s.jsonl", import_line() + R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})" +
                       "\n" +
                       fmt::format("{{\"op\": \"export_views\", \"out\": \"{0}/m.mtl\"}}\n"
                                   "{{\"op\": \"import\", \"path\": \"{0}/m.obj\"}}\n",
                                   path("obj").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_NE(log().find("is a file that this script reads"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("obj/m.mtl")), before);
}

TEST_F(Guards, PicturesThatMaterialsNameAreProtectedEvenIfNotRead) {
  fs::create_directories(path("obj"));
  write("obj/m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n");
  write("obj/m.mtl",
        "newmtl a\nKd 1 0 0\nmap_d opacity.png\nmap_Bump -bm 0.5 .\\\\the bumps.png\nnewmtl unused\nnorm n.png\n");
  for (const std::string name : {"opacity.png", "the bumps.png", "n.png", "other.png"}) {
    write("obj/" + name, "\x89PNG of somebody");
    const bool is_named = name != "other.png";
    EXPECT_EQ(program("render {}/obj/m.obj -o \"{}/obj/" + name + "\" --size 8x8"), 1) << log();
    EXPECT_EQ(read_file(path("obj/" + name)), "\x89PNG of somebody") << name;
    EXPECT_EQ(log().find("was not made by Rebake") == std::string::npos, is_named) << log();
  }
}

// Pictures that no file names may be photographs, textures or maps all the same.
TEST_F(Guards, PicturesOfOthersAreNotReplaced) {
  for (const char* name : {"a.png", "b.jpg", "c.exr", "d.webp"}) {
    write(name, "a picture of somebody");
    EXPECT_EQ(program("render " REBAKE_SOURCE "/samples/scenes/kettle -o {}/" + std::string(name) + " --size 8x8"), 1)
        << name;
    EXPECT_EQ(read_file(path(name)), "a picture of somebody");
    fs::remove(path(name));
    for (int twice = 0; twice < 2; ++twice)
      EXPECT_EQ(program("render " REBAKE_SOURCE "/samples/scenes/kettle -o {}/" + std::string(name) + " --size 8x8"), 0)
          << log();
  }
  // Not even by a script that reads it later.
  write("e.png", "a map of somebody");
  write("s.jsonl", import_line() + fmt::format(R"({{"op": "render", "out": "{0}", "width": 8, "height": 8}}
{{"op": "light", "source": "picture", "picture": "{0}"}}
)",
                                               path("e.png").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("e.png")), "a map of somebody");
}

// Writing to a symbolic link replaces the file it leads to. Links to nothing stay.
TEST_F(Guards, LinksToFilesOfOthersAreNotWrittenThrough) {
  fs::create_directories(path("cap/images"));
  fs::create_directories(path("film"));
  fs::create_directories(path("links"));
  write("cap/transforms.json", R"({"camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [{"file_path": "images/0.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  write("cap/images/0.png", "\x89PNG of somebody");
  write("film/film.json", "{}");
  write("film/00001.png", "\x89PNG of somebody");
  fs::copy(REBAKE_SOURCE "/samples/scenes/kettle", path("other"));
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  fs::create_directory_symlink(path("links"), path("more"));
  const auto before = folder_bytes(path(""));
  for (const std::string target :
       {"cap/images/0.png", "cap/images/new.png", "film/00001.png", "other/shape0.pngfeat0.png"})
    for (const std::string link : {"links/a.png", "links/b.png", "more/a.png"}) {
      fs::create_symlink("../" + target, path("links/a.png"));
      fs::create_symlink("a.png", path("links/b.png"));
      EXPECT_EQ(program("render " + kettle + " -o {}/" + link + " --size 8x8"), 1) << target << ", " << link << '\n'
                                                                                   << log();
      fs::remove(path("links/a.png"));
      fs::remove(path("links/b.png"));
      fs::remove(path("log"));
      EXPECT_EQ(folder_bytes(path("")), before) << target << ", " << link;
    }
}

// Every command that reads cameras protects the photographs and masks that they name, wherever they are.
TEST_F(Guards, AllThatReadsCamerasProtectsTheirPhotographsAndMasks) {
  fs::create_directories(path("store/images"));
  fs::create_directories(path("store/masks"));
  fs::create_directories(path("cap"));
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  ASSERT_EQ(program("render " + kettle + " -o {}/drawn.png --size 16x16"), 0) << log();
  for (const char* kind : {"images", "masks"}) {
    fs::create_directory_symlink(path(std::string("store/") + kind), path(std::string("cap/") + kind));
    fs::copy_file(path("drawn.png"), path(fmt::format("store/{}/0.png", kind)));
  }
  write("cap/transforms.json", R"({"camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [{"file_path": "images/0.png",
            "mask_path": "masks/0.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  const std::string photograph = read_file(path("store/images/0.png"));
  for (const std::string line :
       {R"({"op": "compare_photographs", "cameras": "CAP", "samples": 1})",
        R"({"op": "film", "path": "CAP", "out": "FILM", "width": 8, "height": 8, "samples": 1, "fps": 1})",
        R"({"op": "import_views", "path": "CAP"})", R"({"op": "refit", "path": "CAP", "epochs": 1})",
        R"({"op": "select_masks", "path": "CAP"})"})
    for (const std::string kind : {"images", "masks"})
      for (const bool after : {true, false}) {
        std::string reads = line;
        for (const auto& [word, name] : {std::pair("CAP", "cap/transforms.json"), std::pair("FILM", "film")})
          if (const std::size_t at = reads.find(word); at != std::string::npos)
            reads.replace(at, 3 + (*word == 'F'), path(name).string());
        const std::string writes =
            fmt::format(R"({{"op": "render", "out": "{}", "width": 8, "height": 8, "samples": 1}})",
                        path("store/" + kind + "/0.png").string());
        write("s.jsonl", import_line() + (after ? reads + "\n" + writes : writes + "\n" + reads));
        EXPECT_EQ(program("run {}/s.jsonl"), 1) << line << ", " << kind << '\n' << log();
        EXPECT_EQ(read_file(path("store/" + kind + "/0.png")), photograph) << line << ", " << kind;
        fs::remove_all(path("film"));
      }
  EXPECT_EQ(program("render " + kettle + " --cameras {}/cap/transforms.json -o {}/cap/masks"), 1) << log();
  EXPECT_EQ(program("compare " + kettle + " --photos {}/cap/transforms.json -o {}/cap/masks --samples 1"), 1) << log();
  EXPECT_EQ(read_file(path("store/masks/0.png")), photograph);
}

TEST_F(Guards, ExportsReplaceNoFilesThatOnlyHaveNamesOfTheScene) {
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  ASSERT_EQ(program("export " + kettle + " -o {}/out"), 0) << log();
  for (const char* name : {"shape99.obj", "shape1.obj", "shape7_3.obj", "shape5.pngfeat0.png"}) {
    write(std::string("out/") + name, "mine");
    EXPECT_EQ(program("export " + kettle + " -o {}/out"), 1) << name;
    EXPECT_NE(log().find("is not part of its scene"), std::string::npos) << log();
    EXPECT_EQ(read_file(path(std::string("out/") + name)), "mine");
    fs::remove(path(std::string("out/") + name));
  }
  EXPECT_EQ(program("export " + kettle + " -o {}/out"), 0) << log();
}

// Names that the system does not resolve, though their resolved form is a file.
TEST_F(Guards, AnotherSpellingOfAnOutputIsNotAnotherFile) {
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  fs::copy(kettle, path("kettle"));
  fs::create_directories(path("cap/images"));
  write("cap/transforms.json", R"({"camera_angle_x": 0.7, "w": 16, "h": 16, "frames": [{"file_path": "images/0.png",
            "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  write("cap/images/0.png", "\x89PNG of somebody");
  write("notes.txt", "mine");
  write("user.glb", "mine");
  write("user.html", "mine");
  write("s.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}\n", path("p.rebake").string()));
  ASSERT_EQ(program("run {}/s.jsonl"), 0) << log();
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  const auto before = folder_bytes(path(""));
  const auto unchanged = [&](const std::string& what) {
    const auto after = folder_bytes(path(""));
    for (const auto& [name, bytes] : before) {
      if (name.find("log") != std::string::npos) continue;
      EXPECT_TRUE(after.contains(name) && after.at(name) == bytes) << what << ": " << name;
    }
  };
  const auto spelled = [](const std::string& file, int how) {
    const std::size_t slash = file.rfind('/');
    const std::string in = slash == std::string::npos ? "" : file.substr(0, slash + 1), name = file.substr(in.size());
    return how == 0   ? file + "/"
           : how == 1 ? file + "/."
           : how == 2 ? in + "missing/../" + name
                      : in + "notes.txt/../" + name;
  };
  for (int how = 0; how < 4; ++how) {
    for (const char* file :
         {"p.rebake", "left.journal", "notes.txt", "kettle/mlp.json", "cap/transforms.json", "cap/images/0.png"}) {
      const std::string command = "render " + kettle + " --size 8x8 -o {}/" + spelled(file, how);
      EXPECT_EQ(program(command), 1) << command;
      unchanged(command);
    }
    for (const std::string& command : {"recover {}/left.journal --keep -o {}/" + spelled("p.rebake", how),
                                       "export " + kettle + " --format gltf -o {}/" + spelled("user.glb", how),
                                       "publish " + kettle + " --single-file -o {}/" + spelled("user.html", how),
                                       "run {}/s.jsonl --list-files {}/" + spelled("notes.txt", how),
                                       "render " + kettle + " --path turntable -o {}/" +
                                           (how < 2 ? std::string("cap/images") : spelled("cap/images", how))}) {
      EXPECT_NE(program(command), 0) << command;
      unchanged(command);
    }
  }
}

TEST_F(Guards, ProjectsOfLinkedFilesOpen) {
  fs::create_directories(path("blobs"));
  write("blobs/abc123", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n");
  fs::create_symlink(path("blobs/abc123"), path("m.obj"));
  write("s.jsonl",
        fmt::format("{{\"op\": \"import\", \"path\": \"{}\"}}\n{{\"op\": \"save_project\", \"out\": \"{}\"}}\n",
                    path("m.obj").string(), path("p.rebake").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  EXPECT_EQ(program("info {}/p.rebake"), 0) << log();
}

TEST_F(Guards, PhotographsOfEveryUsualLayoutAreProtected) {
  for (const auto& [model, pictures] : {std::pair("ns/colmap/sparse/0", "ns/images"),
                                        {"c3/sparse/1", "c3/images"},
                                        {"c4/sparse/0", "c4/input"},
                                        {"c5/sparse", "c5"},
                                        {"c6/sparse/0", "c6/images_4"}}) {
    fs::create_directories(path(model));
    fs::create_directories(path(pictures));
    write(std::string(model) + "/cameras.txt", "1 PINHOLE 12 10 14 14 6 5\n");
    write(std::string(model) + "/images.txt", "1 1 0 0 0 0 0 4 1 0001.png\n\n");
    write(std::string(model) + "/points3D.txt", "");
    write(std::string(pictures) + "/0001.png", "photograph");
    EXPECT_EQ(program(fmt::format("render " REBAKE_SOURCE "/samples/scenes/kettle --cameras {{}}/{} -o {{}}/{}", model,
                                  pictures)),
              1)
        << model;
    EXPECT_NE(log().find("is a file of the capture"), std::string::npos) << log();
    EXPECT_EQ(read_file(path(std::string(pictures) + "/0001.png")), "photograph");
  }
  // Other pictures of the same names in the capture's folder, such as those for testing.
  fs::create_directories(path("ns/colmap/masks"));
  write("ns/colmap/masks/0001.png", "mask");
  EXPECT_EQ(
      program("render " REBAKE_SOURCE "/samples/scenes/kettle --cameras {}/ns/colmap/sparse/0 -o {}/ns/colmap/masks"),
      1);
  EXPECT_EQ(read_file(path("ns/colmap/masks/0001.png")), "mask");
}

TEST_F(Guards, KeepsDamagedProjectsAndLeftoversThatAreRead) {
  write("failing.jsonl", import_line() + R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(program("run {}/failing.jsonl --journal {}/left.journal"), 1);
  write("damaged.rebake", "{\"rebake_project\": 2, \"edits\": [");
  EXPECT_EQ(program("recover {}/left.journal -o {}/damaged.rebake --replace"), 1);
  EXPECT_NE(log().find("damaged project"), std::string::npos) << log();
  // The leftover of a killed export that the script imports.
  fs::copy(fs::path(REBAKE_SOURCE) / "samples/scenes/kettle", path(".ex.1234abcd.rebake-partial"));
  write("script.jsonl", import_line() + fmt::format("{{\"op\": \"export\", \"out\": \"{}\"}}\n", path("ex").string()) +
                            fmt::format("{{\"op\": \"import\", \"path\": \"{}\", \"as\": \"left\"}}\n",
                                        path(".ex.1234abcd.rebake-partial").string()));
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
}

TEST_F(Guards, EditFailsWithoutItsJournal) {
  Session session;
  session.document.keep_journal(path("work.journal"));
  Import import;
  import.path = REBAKE_SOURCE "/samples/scenes/kettle";
  session.edit(import);
  for (const bool replaced : {false, true}) {
    fs::remove(path("work.journal"));
    if (replaced) write("work.journal", "something else");
    EXPECT_THROW(session.edit(import), FileError);
    EXPECT_EQ(session.scene().roots.size(), 1U) << "an edit that is not acknowledged must not be applied";
  }
  session.document.discard_journal();
  EXPECT_EQ(read_file(path("work.journal")), "something else") << "a foreign file must stay";
}

TEST_F(Guards, RejectsImportThatContainsTheJournal) {
  fs::copy(REBAKE_SOURCE "/samples/scenes/kettle", path("kettle"), fs::copy_options::recursive);
  Session session;
  session.document.keep_journal(path("kettle/work.journal"));
  Import import;
  import.path = path("kettle");
  EXPECT_THROW(session.edit(import), FileError);
  EXPECT_TRUE(session.scene().roots.empty());
  session.document.discard_journal();
}

TEST_F(Guards, LaterImportsMayOnlyBeReplacedAsAWhole) {
  const auto line_of = [&](const char* form) { return fmt::format(fmt::runtime(form), path("later").string()); };
  fs::copy(fs::path(REBAKE_SOURCE) / "samples/scenes/kettle", path("later"), fs::copy_options::recursive);
  const std::string render =
                        line_of("{{\"op\": \"render\", \"out\": \"{}/mlp.json\", \"width\": 16, \"height\": 16}}\n"),
                    import = line_of("{{\"op\": \"import\", \"path\": \"{}\", \"as\": \"later\"}}\n"),
                    exported = line_of("{{\"op\": \"export\", \"out\": \"{}\"}}\n");
  const std::string decoder = read_file(path("later/mlp.json"));
  write("script.jsonl", import_line() + render + import);
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_EQ(read_file(path("later/mlp.json")), decoder);
  // If a later import expects other contents at that path, the export is refused, because they would be lost.
  write("script.jsonl", import_line() + exported +
                            line_of("{{\"op\": \"import\", \"path\": \"{}\", \"content\": \"0000000000000000\"}}\n"));
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_NE(log().find("would be written into"), std::string::npos) << log();
  // A script may import its own export, also when it runs again.
  write("script.jsonl", import_line() + exported + import);
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
  EXPECT_EQ(program("run {}/script.jsonl"), 0) << log();
}

TEST_F(Guards, RejectsOutputsOverInputs) {
  write("script.jsonl", import_line());
  EXPECT_EQ(program("run {}/script.jsonl --list-files {}/script.jsonl"), 1);
  EXPECT_EQ(read_file(path("script.jsonl")), import_line());

  write("script.jsonl",
        import_line() + fmt::format("{{\"op\": \"save_project\", \"out\": \"{}\"}}", path("p.rebake").string()));
  ASSERT_EQ(program("run {}/script.jsonl"), 0) << log();
  const std::string project = read_file(path("p.rebake"));
  EXPECT_EQ(program("render {}/p.rebake -o {}/p.rebake --size 16x16"), 1);
  EXPECT_EQ(read_file(path("p.rebake")), project);

  write("camera.json", R"({"eye": [0, 0, 3], "target": [0, 0, 0]})");
  EXPECT_EQ(program("render {}/p.rebake --camera {}/camera.json -o {}/camera.json --size 16x16"), 1);
  EXPECT_EQ(read_file(path("camera.json")), R"({"eye": [0, 0, 3], "target": [0, 0, 0]})");

  const std::string mesh = "v -9 -9 -9\nv 9 -9 -9\nv 0 9 -9\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  write("cage.obj", mesh);
  write(
      "script.jsonl",
      import_line() +
          fmt::format(
              "{{\"op\": \"cage\", \"node\": \"kettle\", \"mesh\": \"{0}\", \"moves\": [{{\"points\": [3], "
              "\"translate\": [0, 0, 1]}}]}}\n{{\"op\": \"render\", \"out\": \"{0}\", \"width\": 16, \"height\": 16}}",
              path("cage.obj").string()));
  EXPECT_EQ(program("run {}/script.jsonl"), 1);
  EXPECT_NE(log().find("a cage mesh that this run reads"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("cage.obj")), mesh);
}

// A file that a later line expects with a known content is not that of an earlier line.
TEST_F(Guards, FilesOfKnownContentAreNotReplacedBeforeTheyAreRead) {
  const std::string view = import_line() +
                           R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}})"
                           "\n";
  const std::string to_views =
      fmt::format("{{\"op\": \"export_views\", \"out\": \"{0}\"}}\n", path("views.json").string());
  write("s.jsonl", view + to_views);
  EXPECT_EQ(program("run {}/s.jsonl"), 0) << log();
  const std::string before = read_file(path("views.json"));
  write("s.jsonl",
        view +
            R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 6], "target": [0, 0, 0]}})"
            "\n" +
            to_views +
            fmt::format("{{\"op\": \"import_views\", \"path\": \"{0}\", \"content\": \"0123456789abcdef\"}}\n",
                        path("views.json").string()));
  EXPECT_EQ(program("run {}/s.jsonl"), 1);
  EXPECT_EQ(read_file(path("views.json")), before);
}

TEST_F(Guards, RenderedPhotographsOfColmapAreNotReplaced) {
  fs::create_directories(path("c/images"));
  fs::create_directories(path("c/sparse/0"));
  const std::string kettle = REBAKE_SOURCE "/samples/scenes/kettle";
  ASSERT_EQ(program("render " + kettle + " -o {}/c/images/0.png --size 16x16"), 0) << log();
  write("c/sparse/0/cameras.txt", "1 PINHOLE 16 16 20 20 8 8\n");
  write("c/sparse/0/images.txt", "1 1 0 0 0 0 0 4 1 0.png\n\n");
  write("c/sparse/0/points3D.txt", "");
  const std::string before = read_file(path("c/images/0.png"));
  EXPECT_EQ(program("render " + kettle + " --cameras {}/c/sparse/0 -o {}/c/images"), 1) << log();
  EXPECT_EQ(read_file(path("c/images/0.png")), before);
}

}  // namespace
}  // namespace rebake::test
