// Outputs must not overwrite pictures, photographs, camera files and pages of others, by any path.
#include "tests/support/guards_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

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
  fs::create_directories(path("film"));
  fs::create_directories(path("links"));
  write_capture();
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

// Such pages of earlier builds may have been changed.
TEST_F(Guards, PagesWithoutAHashAreNotReplaced) {
  const std::string publish = "publish " REBAKE_SOURCE "/samples/scenes/kettle -o {}/page";
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(program(publish), 0) << log();
  std::string index = read_file(path("page/index.html"));
  const std::size_t hash = index.find("<meta name=\"rebake-files\"");
  ASSERT_NE(hash, std::string::npos);
  index.erase(hash, index.find('\n', hash) - hash);
  write_text(path("page/index.html"), index);
  EXPECT_EQ(program(publish), 1);
  EXPECT_NE(log().find("is a page of an earlier build, or was changed"), std::string::npos) << log();
  EXPECT_EQ(read_file(path("page/index.html")), index);
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
