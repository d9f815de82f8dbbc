// The command line: exit codes, messages, files.
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "render/image.h"
#include "tests/support/cli_fixture.h"

namespace rebake::test {
namespace {

TEST_F(Cli, InfoAsJson) {
  const ProgramResult o = rebake_run("info " + in("ball") + " --json");
  ASSERT_EQ(o.code, 0) << o.text;
  const auto info = nlohmann::json::parse(o.text);
  EXPECT_EQ(info.at("triangles"), 256);
  EXPECT_EQ(info.at("vertices"), 512);
  EXPECT_EQ(info.at("texture_sets"), 1);
  EXPECT_EQ(info.at("chunks"), 1);
  EXPECT_EQ(info.at("axes"), "360");
  EXPECT_EQ(info.at("decoder"), nlohmann::json({11, 16, 16, 3}));
  for (const char* key : {"opaque_texels", "bounds", "memory"}) EXPECT_TRUE(info.contains(key)) << key;
}

TEST_F(Cli, InfoCountsSharedTexelsOnce) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"(", "as": "ball"}
{"op": "select", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"}
{"op": "separate", "node": "ball", "as": "top"}
{"op": "duplicate", "node": "top"}
{"op": "save_project", "out": ")" +
                                in("p.rebake") + "\"}");
  const ProgramResult made = rebake_run("run " + in("s.jsonl"));
  ASSERT_EQ(made.code, 0) << made.text;
  const auto whole = nlohmann::json::parse(rebake_run("info " + in("ball") + " --json").text);
  const auto parts = nlohmann::json::parse(rebake_run("info " + in("p.rebake") + " --json").text);
  ASSERT_EQ(parts.at("objects").size(), 3U);
  EXPECT_EQ(parts.at("opaque_texels"), whole.at("opaque_texels"));
  EXPECT_EQ(parts.at("chunks"), 1) << "both parts were read from one file";
  EXPECT_LT(parts.at("memory"), 1.5 * whole.at("memory").get<double>());
}

TEST_F(Cli, InfoHasTheBoundsOfRotatedTriangles) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"(", "as": "ball"}
{"op": "transform", "node": "ball", "rotate": {"axis": [1, 0, 0], "degrees": 45}}
{"op": "save", "out": ")" + in("rotated") +
                                R"("})");
  ASSERT_EQ(rebake_run("run " + in("s.jsonl")).code, 0);
  const auto info = nlohmann::json::parse(rebake_run("info " + in("rotated") + " --json").text);
  for (const auto& bounds : {info.at("bounds"), info.at("objects").at(0).at("bounds")}) {
    EXPECT_LT(bounds.at("max").at(2).get<double>(), 1.0001) << "of the ball of radius 1, not of its rotated box";
    EXPECT_GT(bounds.at("max").at(2).get<double>(), 0.95);
  }
}

TEST_F(Cli, InfoNamesFormatAndDecoder) {
  const auto said = [&](const std::string& path) { return rebake_run("info " + path).text; };
  const std::string tests = REBAKE_SOURCE "/tests/mesh_ops/formats/";
  EXPECT_NE(said(in("ball")).find("split, 1 texture set, read from 1 geometry file\n"), std::string::npos)
      << said(in("ball"));
  EXPECT_NE(said(in("ball")).find("decoder        11-16-16-3\n"), std::string::npos);
  const std::string nerf2mesh = said(tests + "nerf2mesh/written_by_nerf2mesh");
  EXPECT_NE(nerf2mesh.find("layout         nerf2mesh, 2 texture sets, read from 2 geometry files\n"), std::string::npos)
      << nerf2mesh;
  EXPECT_NE(nerf2mesh.find("decoder        6-32-3, added to a diffuse colour\n"), std::string::npos) << nerf2mesh;
  const std::string mesh = said(tests + "meshes/blender/blender.glb");
  EXPECT_NE(mesh.find("layout         glTF, 2 texture sets\n"), std::string::npos) << mesh;
  EXPECT_NE(mesh.find("decoder        none: texels hold colours\n"), std::string::npos) << mesh;
}

TEST_F(Cli, InfoCountsGeometryFilesThatWereRead) {
  const auto files = [&](const std::string& path) {
    const std::string text = rebake_run("info " + path + " --json").text;  // after warnings
    return nlohmann::json::parse(text.substr(text.find("{\n"))).at("chunks").get<int>();
  };
  write_text(in("ball/shape0_0.obj"), read_file(in("ball/shape0.obj")));
  EXPECT_EQ(files(in("ball")), 1) << "the whole file and its chunk are the same mesh";
  write_text(in("ball/shape0_1.obj"), read_file(in("ball/shape0.obj")));
  EXPECT_EQ(files(in("ball")), 3) << "all are read";
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"(", "as": "a"}
{"op": "import", "path": ")" + in("ball") +
                                R"(", "as": "b"}
{"op": "place", "node": "b", "position": [3, 0, 0]}
{"op": "merge", "nodes": ["a", "b"]}
{"op": "save_project", "out": ")" +
                                in("p.rebake") + R"("})");
  const ProgramResult merged = rebake_run("run " + in("s.jsonl"));
  ASSERT_EQ(merged.code, 0) << merged.text;
  EXPECT_EQ(files(in("p.rebake")), 0) << "merged objects were not read from files";
}

TEST_F(Cli, AnnouncesDurationOfLongWork) {
  const std::string import = R"({"op": "import", "path": ")" + in("ball") + "\"}\n";
  const std::string moves = R"("moves": [{"points": [0], "translate": [1, 0, 0]}]})";
  write_text(in("fine.jsonl"), import + R"({"op": "cage", "node": "ball", "wrap": 0.019, )" + moves);
  // Without cached results of earlier runs.
  const ProgramResult fine = rebake_run("run " + in("fine.jsonl"), "REBAKE_RESULTS=");
  EXPECT_EQ(fine.code, 0) << fine.text;
  EXPECT_NE(fine.text.find("note: wrap, about "), std::string::npos) << fine.text;
  write_text(in("coarse.jsonl"), import + R"({"op": "cage", "node": "ball", "wrap": 0.2, )" + moves);
  EXPECT_EQ(rebake_run("run " + in("coarse.jsonl")).text.find("about"), std::string::npos);
}

// If standard error is closed, a new journal must not get its file descriptor, or messages would be written into it.
TEST_F(Cli, SurvivesClosedOrFullStreams) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + "\"}\n" +
                                R"({"op": "select", "all": true})" + "\n" + R"({"op": "no such thing"})" + "\n");
  EXPECT_EQ(run_program("(" REBAKE_PROGRAM, "run " + in("s.jsonl") + " --journal " + in("j") + " 2>&-)").code, 1);
  const ProgramResult recovered = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(recovered.code, 0) << recovered.text;
  EXPECT_NE(recovered.text.find("2 edits recovered"), std::string::npos) << recovered.text;
  EXPECT_EQ(run_program("(" REBAKE_PROGRAM, "info " + in("none") + " 2> /dev/full)").code, 1);
  EXPECT_EQ(run_program("(" REBAKE_PROGRAM, "info " + in("ball") + " --json > /dev/full)").code, 1);
}

TEST_F(Cli, RejectsEmptyJournalName) { EXPECT_EQ(rebake_run("run " + in("ball") + " --journal ''").code, 2); }

// A wrong path for a report must not overwrite a project, mesh or scene file.
TEST_F(Cli, ReportsOverwriteOnlyReports) {
  write_text(in("m.obj"), "v 0 0 0\n");
  const std::string plain = "export " + in("ball") + " --plain -o " + in("out") + " --report ";
  EXPECT_EQ(rebake_run(plain + in("m.obj")).code, 1);
  EXPECT_EQ(read_file(in("m.obj")), "v 0 0 0\n");
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(plain + in("r.json")).code, 0);
  auto noted = nlohmann::json::parse(read_file(in("r.json")));
  noted["note"] = "mine";
  write_text(in("r.json"), noted.dump());
  EXPECT_EQ(rebake_run(plain + in("r.json")).code, 1);
  EXPECT_EQ(read_file(in("r.json")), noted.dump());
  write_text(in("s.jsonl"), R"({"op": "select", "all": true})");
  const std::string batch =
      "batch " + in("s.jsonl") + " --scenes " + in("ball") + " -o " + in("results") + " --report ";
  EXPECT_EQ(rebake_run(batch + in("m.obj")).code, 1);
  EXPECT_EQ(read_file(in("m.obj")), "v 0 0 0\n");
  // Nor other hard links to an earlier report.
  EXPECT_EQ(rebake_run(batch + in("b.jsonl")).code, 0);
  std::filesystem::create_hard_link(in("b.jsonl"), in("kept.jsonl"));
  const std::string before = read_file(in("kept.jsonl"));
  EXPECT_EQ(rebake_run(batch + in("b.jsonl")).code, 0);
  EXPECT_EQ(read_file(in("kept.jsonl")), before);
  // Nor notes in one, nor what a link will lead to once its disk is there.
  write_text(in("b.jsonl"), before + "my notes\n" + before);
  EXPECT_EQ(rebake_run(batch + in("b.jsonl")).code, 1);
  EXPECT_EQ(read_file(in("b.jsonl")), before + "my notes\n" + before);
  std::filesystem::create_symlink(in("none.jsonl"), in("link.jsonl"));
  EXPECT_EQ(rebake_run(batch + in("link.jsonl")).code, 1);
  EXPECT_FALSE(std::filesystem::exists(in("none.jsonl")));
}

TEST_F(Cli, RejectsOutputsOverInputs) {
  write_text(in("m.obj"), "v 0 0 0\n");
  const ProgramResult trained = rebake_run("light train " + in("ball") + " -o " + in("m.obj") + " --edit '" +
                                           R"({"op": "cage", "mesh": ")" + in("m.obj") + R"("})" + "'");
  EXPECT_EQ(trained.code, 1);
  EXPECT_NE(trained.text.find("is a file that this run reads"), std::string::npos) << trained.text;
  EXPECT_EQ(read_file(in("m.obj")), "v 0 0 0\n");
  // A journal inside a scene folder would become one of its files.
  const auto before = folder_bytes(in("ball"));
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("})");
  write_text(in("none.jsonl"), "# nothing\n");
  EXPECT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("ball/j")).code, 1);
  EXPECT_EQ(rebake_run("run " + in("none.jsonl") + " --scene " + in("ball") + " --journal " + in("ball/j")).code, 1);
  EXPECT_EQ(folder_bytes(in("ball")), before);
}

TEST_F(Cli, StudiesReplaceOnlyTheirOwnFiles) {
  const std::string study = "study samples --frames 1 --size 16x16 --scene " + in("ball") + " -o " + in("out");
  std::filesystem::create_directories(in("out"));
  write_text(in("out/samples.png"), "a picture");
  const ProgramResult refused = rebake_run(study);
  EXPECT_EQ(refused.code, 1) << refused.text;
  EXPECT_NE(refused.text.find("was not written by an earlier study"), std::string::npos) << refused.text;
  EXPECT_EQ(read_file(in("out/samples.png")), "a picture");
  std::filesystem::remove(in("out/samples.png"));
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(study).code, 0);
}

TEST_F(Cli, OutputsDoNotReplaceFilesOfOtherScenesAndCaptures) {
  export_scene(scene_of(made_object({.seed = 5})), folder_.path() / "other", {});
  const auto before = folder_bytes(in("other"));
  const ProgramResult texture =
      rebake_run("render " + in("ball") + " --size 8x8 -o " + in("other/shape0.pngfeat0.png"));
  EXPECT_EQ(texture.code, 1);
  EXPECT_NE(texture.text.find("is a file of the scene"), std::string::npos) << texture.text;
  EXPECT_EQ(folder_bytes(in("other")), before);
  std::filesystem::create_directories(in("shoot"));
  write_text(in("shoot/transforms.json"),
             R"({"camera_angle_x": 0.7, "frames": [{"file_path": "0001.png", "transform_matrix":
                [[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})");
  write_text(in("shoot/0001.png"), "a photograph");
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("}
{"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}}
{"op": "{what}", "out": "{out}"})");
  const auto capture = folder_bytes(in("shoot"));
  for (const auto& [what, out] :
       {std::pair("render", "shoot/0001.png"), std::pair("export_views", "shoot/transforms.json")}) {
    const ProgramResult refused = rebake_run("run " + in("s.jsonl") + " --var what=" + what + " out=" + in(out));
    EXPECT_EQ(refused.code, 1) << what << refused.text;
    EXPECT_EQ(folder_bytes(in("shoot")), capture) << what;
  }
  // Nor photographs that the cameras do not name, or smaller ones.
  std::filesystem::create_directories(in("nerf/images"));
  std::filesystem::create_directories(in("nerf/images_4"));
  std::string cameras = read_file(in("shoot/transforms.json"));
  cameras.replace(cameras.find("0001.png"), 8, "images/0001.png");
  write_text(in("nerf/transforms.json"), cameras);
  const std::string photograph = encode_png(1, 1, 3, std::vector<std::uint8_t>{1, 2, 3}, 1);
  for (const char* file : {"images/0001.png", "images/0002.png", "images_4/0001.png"}) {
    write_text(in("nerf/" + std::string(file)), photograph);
    EXPECT_EQ(rebake_run("render " + in("ball") + " --size 8x8 -o " + in("nerf/" + std::string(file))).code, 1) << file;
    EXPECT_EQ(read_file(in("nerf/" + std::string(file))), photograph);
  }
  // Pictures of its own, and only pictures.
  for (int twice = 0; twice < 2; ++twice)
    EXPECT_EQ(rebake_run("render " + in("ball") + " --size 8x8 -o " + in("nerf/images/new.png")).code, 0);
  for (const char* file : {"notes.tex", "transforms.json", "s.jsonl", "m.obj"}) {
    write_text(in(file), "precious");
    const ProgramResult refused = rebake_run("render " + in("ball") + " --size 8x8 -o " + in(file));
    EXPECT_EQ(refused.code, 1) << file;
    EXPECT_NE(refused.text.find("is not a picture"), std::string::npos) << refused.text;
    EXPECT_EQ(read_file(in(file)), "precious");
  }
  write_text(in("notes.txt"), "precious");
  EXPECT_EQ(rebake_run("light train " + in("ball") +
                       R"( --edit '{"op": "bend", "degrees": 30}' --poses 8 --rays 16 -o )" + in("notes.txt"))
                .code,
            1);
  EXPECT_EQ(read_file(in("notes.txt")), "precious");
}

TEST_F(Cli, PublishedPagesReplaceOnlyPages) {
  const std::string publish = "publish " + in("ball") + " -o ";
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(publish + in("page")).code, 0);
  for (const char* file : {"index.html", "scene.json", "viewer/viewer.js", "data/mesh0.gz"})
    EXPECT_TRUE(std::filesystem::exists(in("page/" + std::string(file)))) << file;
  write_text(in("page/notes.txt"), "mine");
  const auto before = folder_bytes(in("page"));
  EXPECT_EQ(rebake_run(publish + in("page")).code, 1);
  EXPECT_EQ(folder_bytes(in("page")), before);
  std::filesystem::remove(in("page/notes.txt"));
  for (const char* file : {"data/mine.txt", "viewer/mine.js", "data/feat0.0.gif"}) {
    write_text(in("page/" + std::string(file)), "mine");
    EXPECT_EQ(rebake_run(publish + in("page")).code, 1) << file;
    EXPECT_TRUE(std::filesystem::exists(in("page/" + std::string(file)))) << file;
    std::filesystem::remove(in("page/" + std::string(file)));
  }
  // A page or poster that someone has changed since.
  for (const char* file : {"poster.png", "index.html", "viewer/viewer.css", "scene.json"}) {
    EXPECT_EQ(rebake_run(publish + in("page") + " --poster").code, 0) << file;
    const std::string published = read_file(in("page/" + std::string(file)));
    write_text(in("page/" + std::string(file)), published + "<p>mine</p>");
    EXPECT_EQ(rebake_run(publish + in("page")).code, 1) << file;
    EXPECT_EQ(read_file(in("page/" + std::string(file))), published + "<p>mine</p>");
    write_text(in("page/" + std::string(file)), published);
  }
  const auto scene = folder_bytes(in("ball"));
  export_scene(scene_of(made_object({.seed = 5})), folder_.path() / "other", {});
  EXPECT_EQ(rebake_run(publish + in("other")).code, 1) << "another scene";
  EXPECT_EQ(rebake_run(publish + in("ball")).code, 1) << "its own source";
  EXPECT_EQ(folder_bytes(in("ball")), scene);
  const std::string single = publish + in("page.html") + " --single-file";
  write_text(in("page.html"), "<p>mine</p>");
  EXPECT_EQ(rebake_run(single).code, 1);
  EXPECT_EQ(read_file(in("page.html")), "<p>mine</p>");
  std::filesystem::remove(in("page.html"));
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(single + " --poster").code, 0);
  write_text(in("page.html"), read_file(in("page.html")) + "<p>mine</p>");
  EXPECT_EQ(rebake_run(single).code, 1) << "changed by hand";
  EXPECT_EQ(rebake_run(publish + in("page2") + " --single-file").code, 2) << "must end in .html";
}

// A script that reads a file of its own runs again, like one that imports its own export.
TEST_F(Cli, ScriptsMayReadTheFilesThatTheyWrite) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("}
{"op": "view", "name": "front", "camera": {"eye": [0, 0, 4], "target": [0, 0, 0]}}
{"op": "render", "view": "front", "out": ")" +
                                in("front.png") + R"(", "width": 8, "height": 8}
{"op": "export_views", "out": ")" +
                                in("views.json") + R"("}
{"op": "import_views", "path": ")" +
                                in("views.json") + R"(", "prefix": "again-"})");
  for (int twice = 0; twice < 2; ++twice) {
    const ProgramResult done = rebake_run("run " + in("s.jsonl"));
    EXPECT_EQ(done.code, 0) << done.text;
  }
  // Not one that it reads first.
  write_text(in("t.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("}
{"op": "import_views", "path": ")" +
                                in("views.json") + R"("}
{"op": "export_views", "out": ")" +
                                in("views.json") + R"("})");
  EXPECT_EQ(rebake_run("run " + in("t.jsonl")).code, 1);
}

TEST_F(Cli, BatchesDoNotShareAReport) {
  write_text(in("s.jsonl"), R"({"op": "select", "all": true})");
  const std::string batch = "batch " + in("s.jsonl") + " --scenes " + in("ball") + " -o " + in("out");
  std::filesystem::create_directories(in("out"));
  {
    const FileLock other(in("out/report.jsonl"));
    const ProgramResult refused = rebake_run(batch);
    EXPECT_EQ(refused.code, 2) << refused.text;
    EXPECT_NE(refused.text.find("is being written by another batch"), std::string::npos) << refused.text;
  }
  EXPECT_EQ(rebake_run(batch).code, 0);
}

TEST_F(Cli, TerminalShowsAndErasesProgressBar) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("})");
  const ProgramResult seen =
      run_program("TERM=xterm script -qec '" REBAKE_PROGRAM " run " + in("s.jsonl") + "' /dev/null", "");
  EXPECT_EQ(seen.code, 0) << seen.text;
  EXPECT_NE(seen.text.find("\r\033[K"), std::string::npos) << seen.text;
  EXPECT_NE(seen.text.find("[###"), std::string::npos) << seen.text;
  EXPECT_EQ(seen.text.find("\\x"), std::string::npos) << "control codes must not be escaped: " << seen.text;
}

TEST_F(Cli, RepairWritesACleanFolderAndSaysWhatItDid) {
  write_text(in("ball/Shape0.OBJ"), "l 1 2\n" + read_file(in("ball/shape0.obj")));
  std::filesystem::remove(in("ball/shape0.obj"));
  const ProgramResult o = rebake_run("repair " + in("ball") + " -o " + in("clean"));
  ASSERT_EQ(o.code, 0) << o.text;
  EXPECT_NE(o.text.find("Shape0.OBJ is read as shape0.obj"), std::string::npos) << o.text;
  EXPECT_NE(o.text.find("line 1: lines and points are skipped"), std::string::npos) << o.text;
  const ProgramResult again = rebake_run("repair " + in("clean") + " -o " + in("copy"));
  EXPECT_NE(again.text.find("nothing needed repair"), std::string::npos) << again.text;
  EXPECT_EQ(read_file(in("clean/shape0.obj")), read_file(in("copy/shape0.obj")));
  EXPECT_EQ(rebake_run("repair " + in("ball") + " -o " + in("ball")).code, 1) << "the source is protected";
  EXPECT_EQ(rebake_run("repair " + in("none") + " -o " + in("out")).code, 1);
}

TEST_F(Cli, ExportHasTheOptionsOfTheAction) {
  const std::string help = rebake_run("export --help").text;
  for (const char* option : {"--layout", "--format", "--plain", "--width", "--way", "--keep", "--psnr", "--seconds",
                             "--report", "--page-size", "--picture-size", "--nodes"})
    EXPECT_NE(help.find(option), std::string::npos) << option << "\n" << help;
  const auto code = [&](const std::string& options) {
    return rebake_run("export " + in("ball") + " -o " + in("out") + " " + options).code;
  };
  for (const char* wrong : {"--page-size 0", "--page-size x", "--page-size 1.5", "--layout flat", "--format obj",
                            "--width 3 --plain", "--width wide --plain", "--psnr high --plain", "--way best --plain",
                            "--picture-size 1 --plain", "--psnr 40", "--nodes nobody", "--layuot split"})
    EXPECT_EQ(code(wrong), 2) << wrong;
  EXPECT_FALSE(std::filesystem::exists(in("out")));
  EXPECT_EQ(code("--layout unsplit --page-size 256 --nodes ball"), 0);
  EXPECT_TRUE(std::filesystem::exists(in("out/shape.obj")));
  EXPECT_EQ(code("--format rebake"), 0);
  EXPECT_TRUE(std::filesystem::exists(in("out/scene.json")));
}

TEST_F(Cli, MissingModulesAreNamedWithARemedy) {
  write_picture(Image{1, 1, {1, 2, 3}}, in("a.png"), {});
  const std::string alone = in("rebake");
  std::filesystem::copy_file(REBAKE_PROGRAM, alone);
  const ProgramResult compared = run_program(alone, "compare " + in("a.png") + " " + in("a.png"));
  EXPECT_EQ(compared.code, 1);
  EXPECT_NE(compared.text.find("a.png: needs librebake_pictures.so"), std::string::npos) << compared.text;
  const ProgramResult trained =
      run_program(alone, "light train " + in("ball") + " --way net --poses 8 -o " + in("n.light") + " --edit " +
                             R"('{"op": "bend", "node": "ball", "degrees": 20}')");
  EXPECT_EQ(trained.code, 1);
  EXPECT_NE(trained.text.find("librebake_unet.so"), std::string::npos) << trained.text;
  EXPECT_NE(trained.text.find("libtorch-dev"), std::string::npos) << trained.text;
}

TEST_F(Cli, ExitCodes) {
  EXPECT_EQ(rebake_run("").code, 2);
  EXPECT_EQ(rebake_run("rendr").code, 2);
  EXPECT_EQ(rebake_run("--help").code, 0);
  const ProgramResult missing = rebake_run("info /no/such");
  EXPECT_EQ(missing.code, 1);
  EXPECT_NE(missing.text.find("error: /no/such: does not exist"), std::string::npos) << missing.text;
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("no/a.png")).code, 1);
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("a.png") + " --size 0x9").code, 2);
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("a.png") + " --eye 0,0").code, 2);
}

TEST_F(Cli, PipedOutputHasNoColourOrBars) {
  EXPECT_EQ(rebake_run("info /no/such").text.find('\033'), std::string::npos);
}

TEST_F(Cli, FullDiskKeepsPreviousExport) {
  std::filesystem::copy(folder_.path() / "ball", folder_.path() / "out");
  const auto before = folder_bytes(folder_.path() / "out");
  // A file size limit simulates a full disk; it applies to root too.
  const ProgramResult o = rebake_run("export " + in("ball") + " -o " + in("out") + " --layout unsplit", "ulimit -f 8;");
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_NE(o.text.find("cannot be written"), std::string::npos) << o.text;
  EXPECT_EQ(folder_bytes(folder_.path() / "out"), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2) << "nothing half-written";
}

TEST_F(Cli, ExportReportsReplacement) {
  EXPECT_EQ(rebake_run("export " + in("ball") + " -o " + in("out")).text.find("note: the existing folder was replaced"),
            std::string::npos);
  const ProgramResult again = rebake_run("export " + in("ball") + " -o " + in("out"));
  EXPECT_NE(again.text.find("note: the existing folder was replaced"), std::string::npos) << again.text;
}

}  // namespace
}  // namespace rebake::test
