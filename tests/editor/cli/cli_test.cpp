// The command line: exit codes, messages, files.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "render/image.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

struct Outcome {
  int code;
  std::string text;  // standard output and error
};

Outcome run(const std::string& program, const std::string& arguments) {
  FILE* pipe = popen((program + " " + arguments + " 2>&1").c_str(), "r");
  Outcome outcome{};
  char buffer[4096];
  while (const std::size_t got = std::fread(buffer, 1, sizeof buffer, pipe)) outcome.text.append(buffer, got);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return outcome;
}

Outcome rebake_run(const std::string& arguments, const std::string& before = "") {
  return run(before + " " + REBAKE_PROGRAM, arguments);
}

class Cli : public ::testing::Test {
 protected:
  Cli() { export_scene(scene_of(made_object()), folder_.path() / "ball", {}); }
  std::string in(const std::string& name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

TEST_F(Cli, InfoAsJson) {
  const Outcome o = rebake_run("info " + in("ball") + " --json");
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
  const Outcome made = rebake_run("run " + in("s.jsonl"));
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
  EXPECT_NE(nerf2mesh.find("layout         nerf2mesh, 2 texture sets, read from 4 geometry files\n"), std::string::npos)
      << nerf2mesh;
  EXPECT_NE(nerf2mesh.find("decoder        6-32-3, added to a diffuse colour\n"), std::string::npos) << nerf2mesh;
  const std::string mesh = said(tests + "meshes/blender/blender.glb");
  EXPECT_NE(mesh.find("layout         glTF, 2 texture sets\n"), std::string::npos) << mesh;
  EXPECT_NE(mesh.find("decoder        none: texels hold colours\n"), std::string::npos) << mesh;
}

TEST_F(Cli, RenderCompareAndTiming) {
  const Outcome o = rebake_run("render " + in("ball") + " -o " + in("a.png") + " --size 64x48 --time 2 --plan --json");
  ASSERT_EQ(o.code, 0) << o.text;
  const auto report = nlohmann::json::parse(o.text);
  for (const char* key : {"min", "median", "max"}) EXPECT_GT(report.at("frame_ms").at(key).get<double>(), 0);
  EXPECT_TRUE(report.at("passes").contains("geometry"));
  EXPECT_FALSE(report.at("plan").empty());
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("b.png") + " --size 64x48 --background 0,0,0").code, 0);
  EXPECT_EQ(rebake_run("compare " + in("a.png") + " " + in("a.png") + " --min-psnr 90").code, 0);
  EXPECT_EQ(rebake_run("compare " + in("a.png") + " " + in("b.png") + " --min-psnr 90").code, 3);
}

TEST_F(Cli, AnnouncesDurationOfLongWork) {
  const std::string import = R"({"op": "import", "path": ")" + in("ball") + "\"}\n";
  const std::string moves = R"("moves": [{"points": [0], "translate": [1, 0, 0]}]})";
  write_text(in("fine.jsonl"), import + R"({"op": "cage", "node": "ball", "wrap": 0.019, )" + moves);
  // Without cached results of earlier runs.
  const Outcome fine = rebake_run("run " + in("fine.jsonl"), "REBAKE_RESULTS=");
  EXPECT_EQ(fine.code, 0) << fine.text;
  EXPECT_NE(fine.text.find("note: wrap, about "), std::string::npos) << fine.text;
  write_text(in("coarse.jsonl"), import + R"({"op": "cage", "node": "ball", "wrap": 0.2, )" + moves);
  EXPECT_EQ(rebake_run("run " + in("coarse.jsonl")).text.find("about"), std::string::npos);
}

// If standard error is closed, a new journal must not get its file descriptor, or messages would be written into it.
TEST_F(Cli, SurvivesClosedOrFullStreams) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + "\"}\n" +
                                R"({"op": "select", "all": true})" + "\n" + R"({"op": "no such thing"})" + "\n");
  EXPECT_EQ(run("(" REBAKE_PROGRAM, "run " + in("s.jsonl") + " --journal " + in("j") + " 2>&-)").code, 1);
  const Outcome recovered = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(recovered.code, 0) << recovered.text;
  EXPECT_NE(recovered.text.find("2 edits recovered"), std::string::npos) << recovered.text;
  EXPECT_EQ(run("(" REBAKE_PROGRAM, "info " + in("none") + " 2> /dev/full)").code, 1);
  EXPECT_EQ(run("(" REBAKE_PROGRAM, "info " + in("ball") + " --json > /dev/full)").code, 1);
}

TEST_F(Cli, RejectsEmptyJournalName) { EXPECT_EQ(rebake_run("run " + in("ball") + " --journal ''").code, 2); }

// A wrong path for a report must not overwrite a project, mesh or scene file.
TEST_F(Cli, ReportsOverwriteOnlyReports) {
  write_text(in("m.obj"), "v 0 0 0\n");
  const std::string plain = "export " + in("ball") + " --plain -o " + in("out") + " --report ";
  EXPECT_EQ(rebake_run(plain + in("m.obj")).code, 1);
  EXPECT_EQ(read_file(in("m.obj")), "v 0 0 0\n");
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(plain + in("r.json")).code, 0);
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
}

TEST_F(Cli, RejectsOutputsOverInputs) {
  write_text(in("m.obj"), "v 0 0 0\n");
  const Outcome trained = rebake_run("light train " + in("ball") + " -o " + in("m.obj") + " --edit '" +
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
  const Outcome refused = rebake_run(study);
  EXPECT_EQ(refused.code, 1) << refused.text;
  EXPECT_NE(refused.text.find("was not written by an earlier study"), std::string::npos) << refused.text;
  EXPECT_EQ(read_file(in("out/samples.png")), "a picture");
  std::filesystem::remove(in("out/samples.png"));
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(rebake_run(study).code, 0);
}

TEST_F(Cli, OutputsDoNotReplaceFilesOfOtherScenesAndCaptures) {
  export_scene(scene_of(made_object({.seed = 5})), folder_.path() / "other", {});
  const auto before = folder_bytes(in("other"));
  const Outcome texture = rebake_run("render " + in("ball") + " --size 8x8 -o " + in("other/shape0.pngfeat0.png"));
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
    const Outcome refused = rebake_run("run " + in("s.jsonl") + " --var what=" + what + " out=" + in(out));
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
    const Outcome refused = rebake_run("render " + in("ball") + " --size 8x8 -o " + in(file));
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
    const Outcome done = rebake_run("run " + in("s.jsonl"));
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
    const Outcome refused = rebake_run(batch);
    EXPECT_EQ(refused.code, 2) << refused.text;
    EXPECT_NE(refused.text.find("is being written by another batch"), std::string::npos) << refused.text;
  }
  EXPECT_EQ(rebake_run(batch).code, 0);
}

TEST_F(Cli, TerminalShowsAndErasesProgressBar) {
  write_text(in("s.jsonl"), R"({"op": "import", "path": ")" + in("ball") + R"("})");
  const Outcome seen = run("TERM=xterm script -qec '" REBAKE_PROGRAM " run " + in("s.jsonl") + "' /dev/null", "");
  EXPECT_EQ(seen.code, 0) << seen.text;
  EXPECT_NE(seen.text.find("\r\033[K"), std::string::npos) << seen.text;
  EXPECT_NE(seen.text.find("[###"), std::string::npos) << seen.text;
  EXPECT_EQ(seen.text.find("\\x"), std::string::npos) << "control codes must not be escaped: " << seen.text;
}

TEST_F(Cli, PicturesAreWrittenInTheFormatOfTheirName) {
  for (const auto& [name, start] : {std::pair("a.jpg", "\xff\xd8\xff"), {"a.webp", "RIFF"}, {"a.exr", "\x76\x2f"}}) {
    const Outcome o = rebake_run("render " + in("ball") + " -o " + in(name) + " --size 32x24 --samples 1");
    ASSERT_EQ(o.code, 0) << o.text;
    EXPECT_TRUE(read_file(in(name)).starts_with(start)) << name;
  }
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("a.gif") + " --size 32x24").code, 1);
}

TEST_F(Cli, RendersEveryCameraOfAFile) {
  const nlohmann::json upright = {{1, 0, 0, 0}, {0, 0, -1, -4}, {0, 1, 0, 0}, {0, 0, 0, 1}};
  nlohmann::json file = {{"w", 64}, {"h", 48}, {"fl_x", 70}, {"frames", nlohmann::json::array()}};
  for (const char* name : {"./train/r_0", "./train/r_1"})
    file["frames"].push_back({{"file_path", name}, {"transform_matrix", upright}});
  file["frames"][1]["w"] = 32;
  write_text(in("transforms.json"), file.dump());
  const std::string render = "render " + in("ball") + " --cameras " + in("transforms.json");
  const Outcome o = rebake_run(render + " -o " + in("pictures"));
  ASSERT_EQ(o.code, 0) << o.text;
  EXPECT_EQ(read_image(in("pictures/r_0.png")).width, 64);
  EXPECT_EQ(read_image(in("pictures/r_1.png")).width, 32);
  // Where z points up in the file, its camera stands at (0, 0, 4).
  ASSERT_EQ(rebake_run("render " + in("ball") + " -o " + in("same.png") +
                       " --size 64x48 --eye 0,0,4 --target 0,0,0 --fov 37.8498657")
                .code,
            0);
  EXPECT_EQ(rebake_run("compare " + in("same.png") + " " + in("pictures/r_0.png") + " --min-psnr 60").code, 0);
  write_picture(Image{1, 1, {1, 2, 3}}, in("pictures/r_0.png"), {});
  std::filesystem::create_directories(in("train"));
  std::filesystem::copy_file(in("pictures/r_0.png"), in("train/r_0.png"));
  EXPECT_EQ(rebake_run(render + " -o " + in("train")).code, 1) << "photographs are protected";
  EXPECT_EQ(read_image(in("train/r_0.png")).width, 1);
  // Photographs of another capture.
  std::filesystem::create_directories(in("other/images"));
  std::filesystem::copy_file(in("train/r_0.png"), in("other/images/r_0.png"));
  for (nlohmann::json& frame : file["frames"])
    frame["file_path"] = "images/" + frame["file_path"].get<std::string>().substr(8);
  for (const char* name : {"other/transforms.json", "other/transforms_train.json"}) {
    write_text(in(name), file.dump());
    EXPECT_EQ(rebake_run(render + " -o " + in("other/images")).code, 1) << name;
    std::filesystem::remove(in(name));
  }
  EXPECT_EQ(read_image(in("other/images/r_0.png")).width, 1);
  EXPECT_EQ(rebake_run(render + " -o " + in("pictures") + " --size 20x20").code, 2);
  EXPECT_EQ(rebake_run(render + " -o " + in("pictures") + " --camera-format colmap").code, 1);
  EXPECT_EQ(rebake_run(render).code, 2);
  EXPECT_EQ(rebake_run(render + " -o " + in("pictures") + " --eye 1,2,3").code, 2);
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("b.png") + " --world z_up").code, 2);
  EXPECT_EQ(rebake_run("render " + in("ball") + " --cameras " + in("ball") + " -o " + in("pictures")).code, 1);
}

TEST_F(Cli, RepairWritesACleanFolderAndSaysWhatItDid) {
  write_text(in("ball/Shape0.OBJ"), "l 1 2\n" + read_file(in("ball/shape0.obj")));
  std::filesystem::remove(in("ball/shape0.obj"));
  const Outcome o = rebake_run("repair " + in("ball") + " -o " + in("clean"));
  ASSERT_EQ(o.code, 0) << o.text;
  EXPECT_NE(o.text.find("Shape0.OBJ is read as shape0.obj"), std::string::npos) << o.text;
  EXPECT_NE(o.text.find("line 1: lines and points are skipped"), std::string::npos) << o.text;
  const Outcome again = rebake_run("repair " + in("clean") + " -o " + in("copy"));
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
  const Outcome compared = run(alone, "compare " + in("a.png") + " " + in("a.png"));
  EXPECT_EQ(compared.code, 1);
  EXPECT_NE(compared.text.find("a.png: needs librebake_pictures.so"), std::string::npos) << compared.text;
  const Outcome trained = run(alone, "light train " + in("ball") + " --way net --poses 8 -o " + in("n.light") +
                                         " --edit " + R"('{"op": "bend", "node": "ball", "degrees": 20}')");
  EXPECT_EQ(trained.code, 1);
  EXPECT_NE(trained.text.find("librebake_unet.so"), std::string::npos) << trained.text;
  EXPECT_NE(trained.text.find("libtorch-dev"), std::string::npos) << trained.text;
}

TEST_F(Cli, ExitCodes) {
  EXPECT_EQ(rebake_run("").code, 2);
  EXPECT_EQ(rebake_run("rendr").code, 2);
  EXPECT_EQ(rebake_run("--help").code, 0);
  const Outcome missing = rebake_run("info /no/such");
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
  const Outcome o = rebake_run("export " + in("ball") + " -o " + in("out") + " --layout unsplit", "ulimit -f 8;");
  EXPECT_EQ(o.code, 1) << o.text;
  EXPECT_NE(o.text.find("cannot be written"), std::string::npos) << o.text;
  EXPECT_EQ(folder_bytes(folder_.path() / "out"), before);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 2) << "nothing half-written";
}

// A run that fails after some edits keeps them in its journal.
TEST_F(Cli, RecoverNamesMissingSourcesAndWritesNoEmptyProject) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" +
                            R"({"op": "hide", "node": "ball"})" + "\n" + R"({"op": "hide", "node": "nobody"})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  std::filesystem::rename(in("ball"), in("moved"));
  const Outcome gone = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(gone.code, 1) << gone.text;
  EXPECT_NE(gone.text.find("--source '" + in("ball") + "=NEW'"), std::string::npos) << gone.text;
  EXPECT_FALSE(std::filesystem::exists(in("p.rebake"))) << "a file would block the next attempt";
  const Outcome wrong = rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("bal=") + in("moved"));
  EXPECT_NE(wrong.text.find("contains no source"), std::string::npos) << wrong.text;
  EXPECT_NE(wrong.text.find(in("ball")), std::string::npos) << wrong.text;
  const Outcome missed = rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("ball=") + in("mov"));
  EXPECT_NE(missed.text.find("(expected at " + in("mov")), std::string::npos) << missed.text;
  const Outcome found =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake --source ") + in("ball=") + in("moved"));
  EXPECT_EQ(found.code, 0) << found.text;
  EXPECT_TRUE(std::filesystem::exists(in("p.rebake")));
  EXPECT_FALSE(std::filesystem::exists(in("j")));
  // An empty journal (killed while it was begun) contains nothing to recover, and stays.
  write_file_atomically(in("empty"), "", {});
  EXPECT_EQ(rebake_run("recover " + in("empty") + " -o " + in("q.rebake")).code, 1);
  EXPECT_TRUE(std::filesystem::exists(in("empty")));
  EXPECT_FALSE(std::filesystem::exists(in("q.rebake")));
}

TEST_F(Cli, RecoverKeepsProjectWithMoreEdits) {
  const std::string import = R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n",
                    hide = R"({"op": "hide", "node": "ball"})"
                           "\n";
  write_file_atomically(in("s.jsonl"), import + hide + R"({"op": "save_project", "out": ")" + in("p.rebake") + "\"}\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl")).code, 0);
  write_file_atomically(in("s.jsonl"),
                        import + R"({"op": "hide", "node": "nobody"})"
                                 "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  const std::string project = read_file(in("p.rebake"));
  const Outcome refused = rebake_run("recover " + in("j") + " --replace -o " + in("p.rebake"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.text.find("contains 2 edits, more than the 1"), std::string::npos) << refused.text;
  EXPECT_EQ(read_file(in("p.rebake")), project);
  EXPECT_TRUE(std::filesystem::exists(in("j")));
  EXPECT_EQ(rebake_run("recover " + in("j") + " -o " + in("q.rebake")).code, 0);
}

TEST_F(Cli, RecoverAcceptsEqualsSignsInPaths) {
  std::filesystem::rename(in("ball"), in("a=b"));
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("a=b") + "\"}\n" +
                            R"({"op": "hide", "node": 7})"
                            "\n",
                        {});
  ASSERT_NE(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 0);
  std::filesystem::rename(in("a=b"), in("c=d"));
  const Outcome found =
      rebake_run("recover " + in("j") + " -o " + in("p.rebake") + " --source " + in("a=b=") + in("c=d"));
  EXPECT_EQ(found.code, 0) << found.text;
}

TEST_F(Cli, RecoverFindsTheMovedSourcesOfAProject) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" +
                            R"({"op": "save_project", "out": ")" + in("p.rebake") + R"("})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl")).code, 0);
  std::filesystem::rename(in("ball"), in("moved"));
  const Outcome gone = rebake_run("info " + in("p.rebake"));
  EXPECT_NE(gone.text.find("rebake recover P.rebake --source OLD=NEW"), std::string::npos) << gone.text;
  const std::string relink = "recover " + in("p.rebake") + " --source " + in("ball=") + in("moved") + " -o ";
  const Outcome found = rebake_run(relink + in("q.rebake"));
  EXPECT_EQ(found.code, 0) << found.text;
  EXPECT_EQ(rebake_run("info " + in("q.rebake")).code, 0);
  EXPECT_TRUE(std::filesystem::exists(in("p.rebake")));
  EXPECT_EQ(rebake_run(relink + in("p.rebake")).code, 1) << "the project exists already";
  EXPECT_EQ(rebake_run(relink + in("p.rebake --replace")).code, 0);
  EXPECT_EQ(rebake_run("info " + in("p.rebake")).code, 0);
}

TEST_F(Cli, ExportReportsReplacement) {
  EXPECT_EQ(rebake_run("export " + in("ball") + " -o " + in("out")).text.find("note: the existing folder was replaced"),
            std::string::npos);
  const Outcome again = rebake_run("export " + in("ball") + " -o " + in("out"));
  EXPECT_NE(again.text.find("note: the existing folder was replaced"), std::string::npos) << again.text;
}

// Projects do not store undone edits: a journal that contains nothing else stays.
TEST_F(Cli, RecoverKeepsAJournalOfUndoneEdits) {
  write_file_atomically(in("s.jsonl"),
                        R"({"op": "import", "path": ")" + in("ball") + R"("})" + "\n" + R"({"op": "undo"})" + "\n" +
                            R"({"op": "hide", "node": "nobody"})" + "\n",
                        {});
  ASSERT_EQ(rebake_run("run " + in("s.jsonl") + " --journal " + in("j")).code, 1);
  const Outcome undone = rebake_run("recover " + in("j") + " -o " + in("p.rebake"));
  EXPECT_EQ(undone.code, 1);
  EXPECT_NE(undone.text.find("contains only undone edits, so no project is"), std::string::npos) << undone.text;
  EXPECT_TRUE(std::filesystem::exists(in("j")));
  EXPECT_FALSE(std::filesystem::exists(in("p.rebake")));
  write_file_atomically(in("torn"), read_file(in("j")).substr(0, 60), {});
  const Outcome torn = rebake_run("recover " + in("torn") + " -o " + in("p.rebake"));
  EXPECT_NE(torn.text.find("contains no complete edit: the program ended"), std::string::npos) << torn.text;
  const Outcome twice = rebake_run("recover " + in("j") + " -o " + in("p.rebake --source a=b --source ./a=c"));
  EXPECT_NE(twice.text.find("contains no source"), std::string::npos) << twice.text;
}

}  // namespace
}  // namespace rebake::test
