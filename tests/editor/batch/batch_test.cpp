// Batches run one script over many scenes: failures are isolated, and finished scenes are skipped on resume.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "editor/batch/batch.h"
#include "editor/batch/batch_scenes.h"
#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "tests/support/light_pictures.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;
using Status = BatchResult::Status;

class Batch : public ::testing::Test {
 protected:
  Batch() {
    for (const char* name : {"a", "b", "c"})
      export_scene(scene_of(made_object({.columns = 8, .rows = 4, .seed = static_cast<unsigned>(name[0])})),
                   folder_.path() / "scenes" / name, {});
    write_text(folder_.path() / "s.jsonl",
               R"({"op": "select", "node": "scene", "box": {"min": [0, 0.5, 0], "max": [1, 1, 1]}, "frame": "bounds"})"
               "\n"
               R"({"op": "delete"})"
               "\n");
    options.script = folder_.path() / "s.jsonl";
    options.scenes = {(folder_.path() / "scenes/*").string()};
    options.out = folder_.path() / "out";
    options.program = REBAKE_PROGRAM;
  }
  std::map<std::string, Status> run() {
    std::map<std::string, Status> statuses;
    std::size_t reported = 0;
    for (const BatchResult& result : run_batch(options, {}, [&](const BatchResult&) { ++reported; })) {
      statuses[result.name] = result.status;
      messages[result.name] = result.message;
    }
    EXPECT_EQ(reported, statuses.size());
    return statuses;
  }
  TemporaryFolder folder_;
  BatchOptions options;
  std::map<std::string, std::string> messages;
};

TEST_F(Batch, ResultsMatchASingleRun) {
  options.jobs = 2;
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::done}, {"c", Status::done}}));
  const std::string alone = (folder_.path() / "alone").string();
  ASSERT_EQ(std::system(("\"" REBAKE_PROGRAM "\" run " + options.script.string() + " --scene " +
                         (folder_.path() / "scenes/b").string() + " --out " + alone + " 2>/dev/null")
                            .c_str()),
            0);
  EXPECT_EQ(folder_bytes(options.out / "b"), folder_bytes(alone));
  // Except the logs, which say that folders were replaced.
  const auto results = [&] {
    auto files = folder_bytes(options.out);
    std::erase_if(files, [](const auto& file) { return file.first.ends_with(".log"); });
    return files;
  };
  const auto once = results();
  run();
  EXPECT_EQ(results(), once) << "a second run gives the same bytes";
}

TEST_F(Batch, ResumeRemembersMissedPsnr) {
  export_scene(scene_of(made_object({.columns = 4, .rows = 2, .seed = 99})), folder_.path() / "other", {});
  write_text(options.script,
             R"({"op": "import", "path": ")" + (folder_.path() / "other").string() + R"("}
{"op": "transform", "node": "other", "translate": [3, 0, 0]}
{"op": "export", "out": ")" +
                 options.out.string() +
                 R"(/{name}", "plain": true, "width": 4, "way": "new", "psnr": 99, "seconds": 1, "picture_size": 32}
)");
  options.scenes = {(folder_.path() / "scenes/a").string()};
  for (const Status status : {Status::done, Status::skipped}) {
    const std::vector<BatchResult> results = run_batch(options, {}, [](const BatchResult&) {});
    ASSERT_EQ(results.size(), 1U);
    EXPECT_EQ(results[0].status, status) << results[0].message;
    EXPECT_TRUE(results[0].below_requested_psnr);
    EXPECT_NE(results[0].message.find("an export is below the requested psnr; the log"), std::string::npos);
    options.resume = true;
  }
}

TEST_F(Batch, FailuresAreIsolated) {
  fs::remove(folder_.path() / "scenes/b/mlp.json");
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::failed}, {"c", Status::done}}));
  EXPECT_NE(messages["b"].find("scenes/b"), std::string::npos) << messages["b"];
  EXPECT_FALSE(fs::exists(options.out / "b"));
}

TEST_F(Batch, ResumeSkipsValidResults) {
  fs::rename(folder_.path() / "scenes/b/mlp.json", folder_.path() / "kept");
  run();
  fs::rename(folder_.path() / "kept", folder_.path() / "scenes/b/mlp.json");
  options.resume = true;
  EXPECT_EQ(run(),
            (std::map<std::string, Status>{{"a", Status::skipped}, {"b", Status::done}, {"c", Status::skipped}}));
  fs::remove_all(options.out / "a");
  std::ofstream(folder_.path() / "scenes/c/mlp.json", std::ios::app) << " ";
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::skipped}, {"c", Status::done}}));
  options.variables = {"unused=1"};
  EXPECT_EQ(run()["b"], Status::done) << "other variables may give another result";
}

TEST_F(Batch, ResumeKeepsEditedResults) {
  run();
  std::ofstream(options.out / "a/mlp.json", std::ios::app) << "\n\n";
  std::ofstream(folder_.path() / "scenes/a/mlp.json", std::ios::app) << " ";
  const auto edited = folder_bytes(options.out / "a");
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::failed);
  EXPECT_NE(messages["a"].find("was changed after the batch wrote it"), std::string::npos) << messages["a"];
  EXPECT_EQ(folder_bytes(options.out / "a"), edited);
  options.resume = false;
  EXPECT_EQ(run()["a"], Status::failed) << "also without resume";
  fs::remove_all(options.out / "a");
  EXPECT_EQ(run()["a"], Status::done);
}

// Camera files are inputs by their cameras only, but an edit of anything else in them must not be lost either.
TEST_F(Batch, EditedCameraFilesAreKept) {
  write_text(options.script, R"({"op": "view", "name": "v", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}}
{"op": "export_views", "out": ")" +
                                 options.out.string() +
                                 R"(/{name}.json"}
)");
  run();
  std::string cameras = read_file(options.out / "a.json");
  cameras.insert(cameras.find('{') + 1, "\"aabb_scale\": 16, ");
  write_text(options.out / "a.json", cameras);
  EXPECT_EQ(run()["a"], Status::failed);
  EXPECT_NE(messages["a"].find("was changed after the batch wrote it"), std::string::npos) << messages["a"];
  EXPECT_EQ(read_file(options.out / "a.json"), cameras);
}

// The variable {name} of a file is its name without the extension, for the batch and for its processes.
TEST_F(Batch, MeshFilesAreNamedWithoutTheirExtension) {
  fs::create_directories(folder_.path() / "m");
  const char* const mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  write_text(folder_.path() / "m/a.obj", mesh);
  write_text(folder_.path() / "m/b.obj", mesh);
  write_text(options.script, R"({"op": "save", "out": ")" + options.out.string() + R"(/{name}"}
)");
  options.scenes = {(folder_.path() / "m/*.obj").string()};
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::done}})) << messages["a"];
  EXPECT_TRUE(fs::exists(options.out / "a"));
  EXPECT_FALSE(fs::exists(options.out / "a.obj"));
}

// A batch or its process was killed after an export: the list that the process wrote so far tells its outputs.
TEST_F(Batch, OutputsOfAKilledRunAreKnown) {
  const std::string exported = R"({"op": "export", "out": ")" + options.out.string() + "/{name}\"}\n";
  write_text(options.script, exported);
  options.scenes = {(folder_.path() / "scenes/a").string()};
  const fs::path state = options.out / ".rebake-batch";
  const auto as_killed = [&] {
    options.resume = false;
    ASSERT_EQ(run()["a"], Status::done) << messages["a"];
    fs::remove(state / "a.done");
    write_text(state / "a.unfinished", "");
  };
  as_killed();
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done) << "an own result that nobody changed: " << messages["a"];
  as_killed();
  options.resume = true;
  std::ofstream(options.out / "a/mlp.json", std::ios::app) << "\n";
  EXPECT_EQ(run()["a"], Status::failed);
  EXPECT_NE(messages["a"].find("is not as the last run that ended well wrote it"), std::string::npos) << messages["a"];
  // Killed before it wrote anything; then a scene is made by hand.
  fs::remove(state / "a.files");
  write_text(state / "a.unfinished", "");
  const auto made = folder_bytes(options.out / "a");
  EXPECT_EQ(run()["a"], Status::failed) << "no run is known to have written it";
  EXPECT_EQ(folder_bytes(options.out / "a"), made);
  options.scenes.push_back((folder_.path() / "scenes/b").string());
  EXPECT_EQ(run()["b"], Status::done) << "other scenes go on";
}

TEST_F(Batch, EditedResultsInAMovedFolderAreKept) {
  write_text(options.script, R"({"op": "export", "out": ")" + options.out.string() + R"(/x-{name}"})");
  run();
  fs::rename(options.out, folder_.path() / "moved");
  options.out = folder_.path() / "moved";
  write_text(options.script, R"({"op": "export", "out": ")" + options.out.string() + R"(/x-{name}"})");
  std::ofstream(options.out / "x-a/mlp.json", std::ios::app) << "\n";
  EXPECT_EQ(run()["a"], Status::failed);
  EXPECT_EQ(messages["a"].find("was changed after the batch wrote it") == std::string::npos, false) << messages["a"];
}

TEST_F(Batch, OutputsOfAFailedFirstRunAreKnown) {
  const std::string line = R"({"op": "export", "out": ")" + options.out.string() + "/{name}\"}\n";
  write_text(options.script, line + "{\"op\": \"typo\"}\n");
  EXPECT_EQ(run()["a"], Status::failed);
  ASSERT_TRUE(fs::exists(options.out / "a/mlp.json"));
  std::ofstream(options.out / "a/mlp.json", std::ios::app) << "\n";
  const auto edited = folder_bytes(options.out / "a");
  write_text(options.script, line);
  for (const bool resume : {true, false}) {
    options.resume = resume;
    EXPECT_EQ(run()["a"], Status::failed);
    EXPECT_EQ(folder_bytes(options.out / "a"), edited);
  }
  EXPECT_EQ(run()["b"], Status::done);
}

TEST_F(Batch, ResumeKeepsResultsThatWereEditedAfterAFailedRun) {
  run();
  const std::string script = read_file(options.script);
  options.resume = true;
  write_text(options.script, R"({"op": "remove", "node": "none"})");
  EXPECT_EQ(run()["a"], Status::failed);
  std::ofstream(options.out / "a/mlp.json", std::ios::app) << "\n";
  const auto edited = folder_bytes(options.out / "a");
  write_text(options.script, script);
  const auto statuses = run();
  EXPECT_EQ(statuses.at("a"), Status::failed);
  EXPECT_EQ(statuses.at("b"), Status::done);
  EXPECT_EQ(folder_bytes(options.out / "a"), edited);
}

TEST_F(Batch, OwnResultsAreKnownWhereverTheyAre) {
  write_text(options.script, R"({"op": "export", "out": ")" + options.out.string() + R"(/{name}/inside"})");
  for (int twice = 0; twice < 2; ++twice) EXPECT_EQ(run()["a"], Status::done) << "exports below the result's folder";
  fs::remove_all(options.out);
  write_text(options.script, R"({"op": "select", "all": true})");
  run();
  fs::rename(options.out, folder_.path() / "moved");
  options.out = folder_.path() / "moved";
  EXPECT_EQ(run()["a"], Status::done) << "a folder that was moved";
  // As an earlier version left it when it was killed.
  fs::remove(options.out / ".rebake-batch/version-2");
  fs::remove(options.out / ".rebake-batch/a.done");
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done);
}

TEST_F(Batch, ScenesThatChangeDuringTheRunAreNotDone) {
  // The script writes beside the scene's own files.
  write_text(options.script, R"({"op": "render", "out": "{path}/feat0_picture.png", "width": 8, "height": 8})"
                             "\n");
  options.scenes = {(folder_.path() / "scenes/a").string()};
  options.resume = true;
  run();
  EXPECT_FALSE(fs::exists(options.out / ".rebake-batch/a.done"));
}

TEST_F(Batch, ResumeNoticesAnotherWorkingFolder) {
  run();
  options.resume = true;
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  const auto statuses = run();
  fs::current_path(before);
  EXPECT_EQ(statuses.at("a"), Status::done) << "paths of the script start elsewhere";
}

TEST_F(Batch, KeepsScenesThatNoBatchWrote) {
  std::filesystem::create_directories(options.out);
  std::filesystem::copy(folder_.path() / "scenes/b", options.out / "a");
  const auto before = folder_bytes(options.out);
  EXPECT_THROW(run(), FieldError);
  EXPECT_EQ(folder_bytes(options.out), before);
  std::filesystem::remove_all(options.out / "a");
  // Nor a scene at the place of one that a batch tried to write, or wrote elsewhere.
  const std::string script = read_file(options.script);
  for (const std::string& line :
       {std::string(R"({"op": "remove", "node": "none"})"),
        R"({"op": "export", "out": ")" + (folder_.path() / "else").string() + R"(/{name}"})"}) {
    write_text(options.script, line);
    run();
    std::filesystem::copy(folder_.path() / "scenes/b", options.out / "a");
    write_text(options.script, script);
    const auto made = folder_bytes(options.out / "a");
    try {
      EXPECT_EQ(run()["a"], Status::failed) << line;
    } catch (const FieldError&) {
      // The whole batch is refused if no run of the scene is left unfinished.
    }
    EXPECT_EQ(folder_bytes(options.out / "a"), made) << line;
    std::filesystem::remove_all(options.out / "a");
  }
  std::filesystem::create_directory_symlink(folder_.path() / "elsewhere", options.out / "a");
  EXPECT_THROW(run(), FieldError);
}

TEST_F(Batch, ShardsShareTheScenes) {
  options.shards = 2;
  std::map<std::string, Status> both = run();
  const std::size_t first = both.size();
  options.shard = 2;
  both.merge(run());
  EXPECT_EQ(both, (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::done}, {"c", Status::done}}));
  // A scene's shard depends on its own name only: new scenes do not move others to another shard.
  fs::rename(folder_.path() / "scenes/a", folder_.path() / "scenes/0");
  options.resume = true;
  options.shard = 1;
  std::map<std::string, Status> again = run();
  options.shard = 2;
  again.merge(run());
  EXPECT_EQ(again, (std::map<std::string, Status>{{"0", Status::done}, {"b", Status::skipped}, {"c", Status::skipped}}))
      << first;
}

TEST_F(Batch, ResumeChecksTheEnvironmentMap) {
  const auto sky = folder_.path() / "sky.exr";
  write_light_picture(sky, 16, [](const Vec3&) { return Radiance(1, 1, 1); });
  write_text(options.script, R"({"op": "light", "source": "picture", "picture": "{sky}"})");
  options.variables = {"sky=" + sky.string()};
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done);
  EXPECT_EQ(run()["a"], Status::skipped);
  write_light_picture(sky, 16, [](const Vec3&) { return Radiance(1, 1, 0); });
  EXPECT_EQ(run()["a"], Status::done);
}

TEST_F(Batch, ResumeChecksInputsAndOutputs) {
  export_scene(scene_of(made_object({.columns = 8, .rows = 4, .seed = 9})), folder_.path() / "more", {});
  write_text(options.script, R"({"op": "import", "path": "{also}", "as": "more"})");
  options.variables = {"also=" + (folder_.path() / "more").string()};
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done);
  EXPECT_EQ(run()["a"], Status::skipped);
  std::ofstream(folder_.path() / "more/mlp.json", std::ios::app) << " ";
  EXPECT_EQ(run()["a"], Status::done) << "an imported scene has changed";
  EXPECT_EQ(run()["a"], Status::skipped);
  for (const auto& file : fs::recursive_directory_iterator(options.out / "a"))
    if (file.path().extension() == ".png") fs::resize_file(file.path(), 100);
  EXPECT_EQ(run(),
            (std::map<std::string, Status>{{"a", Status::failed}, {"b", Status::skipped}, {"c", Status::skipped}}))
      << "a result that is not as it was written is reported";
  fs::remove_all(options.out / "a");
  EXPECT_EQ(run()["a"], Status::done);
}

TEST_F(Batch, ResumeChecksPagesFilmsAndWhatTheyRead) {
  options.scenes = {(folder_.path() / "scenes/a").string()};
  export_scene(scene_of(made_object({.columns = 8, .rows = 4, .seed = 9})), folder_.path() / "before", {});
  write_text(
      options.script,
      R"({"op": "publish", "out": "{to}/page", "before": "{to}/before"})"
      "\n"
      R"({"op": "film", "out": "{to}/film", "path": "turntable", "width": 8, "height": 8, "fps": 2, "seconds": 1})");
  options.variables = {"to=" + folder_.path().string()};
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done) << messages["a"];
  EXPECT_EQ(run()["a"], Status::skipped);
  std::ofstream(folder_.path() / "before/mlp.json", std::ios::app) << " ";
  EXPECT_EQ(run()["a"], Status::done) << "the scene before the edits has changed";
  fs::remove_all(folder_.path() / "page");
  fs::remove_all(folder_.path() / "film");
  EXPECT_EQ(run()["a"], Status::done) << "results are gone";
  std::ofstream(folder_.path() / "page/index.html", std::ios::app) << "<p>mine</p>";
  EXPECT_EQ(run()["a"], Status::failed) << "the page was edited";
  fs::remove_all(folder_.path() / "page");
  EXPECT_EQ(run()["a"], Status::done);
  fs::remove(folder_.path() / "film/00000.png");
  EXPECT_EQ(run()["a"], Status::failed) << "a picture is gone";
}

TEST_F(Batch, ShardsDetectACommonOutputFolder) {
  write_text(options.script, R"({"op": "export", "out": "{to}/same"})");
  options.variables = {"to=" + folder_.path().string()};
  std::size_t done = 0, failed = 0;
  options.shards = 3;
  for (options.shard = 1; options.shard <= 3; ++options.shard)
    for (const auto& [name, status] : run()) ++(status == Status::done ? done : failed);
  EXPECT_EQ(done, 1U);
  EXPECT_EQ(failed, 2U);
  // Again with a single shard: the folder is no longer as its owner wrote it, and belongs to no other scene.
  options.shards = options.shard = 1;
  for (const auto& [name, status] : run()) EXPECT_EQ(status, Status::failed) << name;
}

// A script that exports onto another input scene would replace it before it is processed.
TEST_F(Batch, RejectsExportsOverInputScenes) {
  const auto before = folder_bytes(folder_.path() / "scenes");
  write_text(options.script, R"({"op": "export", "out": "{to}/b"})");
  options.variables = {"to=" + (folder_.path() / "scenes").string()};
  for (const auto& [name, status] : run()) EXPECT_EQ(status, Status::failed) << name;
  EXPECT_EQ(folder_bytes(folder_.path() / "scenes"), before);
  options.report = folder_.path() / "scenes/b/mlp.json";
  EXPECT_THROW(batch_scenes(options), FileError);
  options.report = options.script;
  EXPECT_THROW(batch_scenes(options), FieldError);
  options.report.clear();
  options.out = folder_.path() / "scenes/a/out";
  EXPECT_THROW(batch_scenes(options), FileError);
}

TEST_F(Batch, RejectsExportsOverImportsOfOtherScenes) {
  const auto other = [&](const std::string& name) { return folder_.path() / "others" / name; };
  for (const char* name : {"a", "b", "c"}) export_scene(scene_of(made_object()), other(name), {});
  const auto before = folder_bytes(folder_.path() / "others");
  write_text(options.script, R"({"op": "import", "path": "{to}/{name}"})"
                             "\n"
                             R"({"op": "export", "out": "{to}/c"})");
  options.variables = {"to=" + (folder_.path() / "others").string()};
  for (const auto& [name, status] : run()) EXPECT_EQ(status, Status::failed) << name;
  EXPECT_NE(messages["a"].find("a source of this scene"), std::string::npos) << messages["a"];
  EXPECT_EQ(folder_bytes(folder_.path() / "others"), before);
  // Writing next to a folder that all scenes read is allowed, also the second time.
  write_text(options.script, R"({"op": "import", "path": "{to}/a"})"
                             "\n"
                             R"({"op": "export", "out": "{to}/new/{name}"})");
  for (int twice = 0; twice < 2; ++twice)
    for (const auto& [name, status] : run()) EXPECT_EQ(status, Status::done) << name << ": " << messages[name];
}

TEST_F(Batch, RejectsReportOverInputFile) {
  write_text(folder_.path() / "cage-of-a.obj", "v 0 0 0\n");
  write_text(options.script, R"({"op": "cage", "mesh": "{to}/cage-of-{name}.obj"})");
  options.variables = {"to=" + folder_.path().string()};
  options.report = folder_.path() / "cage-of-a.obj";
  EXPECT_THROW(batch_scenes(options), FileError);
}

TEST_F(Batch, ScriptsDoNotWriteToTheReport) {
  options.report = options.out / "report.jsonl";
  write_text(options.script, fmt::format(R"({{"op": "export", "plain": true, "out": "{}/{{name}}", "report": "{}"}})",
                                         options.out.string(), options.report.string()));
  for (const auto& [name, status] : run()) EXPECT_EQ(status, Status::failed) << name;
  EXPECT_NE(messages["a"].find("the report of the batch"), std::string::npos) << messages["a"];
  EXPECT_FALSE(fs::exists(options.report));
}

TEST_F(Batch, ResumeNoticesAddedMasks) {
  fs::create_directories(folder_.path() / "shoot/masks");
  const std::string pose = "[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]";
  write_text(folder_.path() / "shoot/transforms.json",
             R"({"camera_angle_x": 0.7, "w": 2, "h": 2, "frames": [{"file_path": "p0.png", "transform_matrix": )" +
                 pose + R"(}, {"file_path": "p1.png", "transform_matrix": )" + pose + "}]}");
  const std::string mask = encode_png(2, 2, 3, std::vector<std::uint8_t>(12, 255), 1);
  write_text(folder_.path() / "shoot/masks/p0.png", mask);
  write_text(options.script, R"({"op": "select_masks", "path": ")" + (folder_.path() / "shoot").string() + R"("})");
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::done) << messages["a"];
  EXPECT_EQ(run()["a"], Status::skipped);
  write_text(folder_.path() / "shoot/masks/p1.png", mask);
  EXPECT_EQ(run()["a"], Status::done) << messages["a"];
}

TEST_F(Batch, TwoBatchesDoNotProcessOneSceneAtOnce) {
  fs::create_directories(options.out / ".rebake-batch");
  {
    const FileLock other(options.out / ".rebake-batch/a.lock");
    ASSERT_TRUE(other.held());
    EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::failed}, {"b", Status::done}, {"c", Status::done}}));
    EXPECT_NE(messages["a"].find("another batch is processing this scene"), std::string::npos) << messages["a"];
  }
  EXPECT_EQ(run()["a"], Status::done);
}

// Links in place of the batch's own files are replaced; their targets are not written to.
TEST_F(Batch, OwnFilesDoNotFollowLinks) {
  run();
  write_text(folder_.path() / "precious", "kept");
  fs::remove_all(options.out / "a");
  for (const char* file : {"a.log", "a.files", "a.done", "a.unfinished"}) {
    fs::remove(options.out / ".rebake-batch" / file);
    fs::create_symlink(folder_.path() / "precious", options.out / ".rebake-batch" / file);
  }
  EXPECT_EQ(run()["a"], Status::done);
  EXPECT_EQ(read_file(folder_.path() / "precious"), "kept");
}

TEST_F(Batch, HandlesLineBreaksAndReportNamesInSceneNames) {
  fs::rename(folder_.path() / "scenes/a", folder_.path() / "scenes/a\nb");
  EXPECT_EQ(run()["a\nb"], Status::done);
  options.resume = true;
  EXPECT_EQ(run()["a\nb"], Status::skipped);
  fs::rename(folder_.path() / "scenes/a\nb", folder_.path() / "scenes/report.jsonl");
  options.report = options.out / "report.jsonl";
  EXPECT_THROW(batch_scenes(options), FieldError);
}

TEST_F(Batch, ScriptsMayExportThemselves) {
  write_text(options.script, R"({"op": "export", "out": "{to}/{name}-own"})");
  options.variables = {"to=" + folder_.path().string()};
  run();
  EXPECT_TRUE(fs::exists(folder_.path() / "a-own/mlp.json"));
  EXPECT_FALSE(fs::exists(options.out / "a"));
  options.resume = true;
  EXPECT_EQ(run()["a"], Status::skipped);
  fs::remove_all(folder_.path() / "a-own");
  EXPECT_EQ(run()["a"], Status::done) << "the result was deleted";
  EXPECT_TRUE(fs::exists(folder_.path() / "a-own/mlp.json"));
}

TEST_F(Batch, UnwritableReportStopsTheBatch) {
  run();
  options.resume = true;
  std::size_t reports = 0;
  const auto refuse = [&](const BatchResult&) {
    ++reports;
    throw FileError("report.jsonl", "cannot be written");
  };
  EXPECT_THROW(run_batch(options, {}, refuse), FileError);
  EXPECT_EQ(reports, 1U);
}

TEST_F(Batch, RejectsOneOutputForTwoScenes) {
  write_text(options.script, R"({"op": "export", "out": "{to}/same"})");
  options.variables = {"to=" + folder_.path().string()};
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::failed}, {"c", Status::failed}}));
  EXPECT_NE(messages["b"].find("is also written for a"), std::string::npos) << messages["b"];
}

TEST_F(Batch, RejectsOneProjectForTwoScenes) {
  write_text(options.script, R"({"op": "save_project", "out": "{to}/same.rebake"})");
  options.variables = {"to=" + folder_.path().string()};
  EXPECT_EQ(run(), (std::map<std::string, Status>{{"a", Status::done}, {"b", Status::failed}, {"c", Status::failed}}));
  EXPECT_NE(messages["b"].find("is also written for a"), std::string::npos) << messages["b"];
}

TEST_F(Batch, RejectsOutputOverScenes) {
  options.out = folder_.path() / "scenes";
  EXPECT_THROW(batch_scenes(options), FieldError);
  // A results folder or a plain file among the scenes is not taken for a scene.
  options.out = folder_.path() / "scenes/results";
  write_text(folder_.path() / "scenes/README.md", "scenes");
  run();
  EXPECT_EQ(run().size(), 3U);
}

TEST_F(Batch, RejectsEmptyPatternsAndDuplicateNames) {
  options.scenes = {"/no/such/*"};
  EXPECT_THROW(batch_scenes(options), FieldError);
  fs::create_directories(folder_.path() / "more/a");
  options.scenes = {(folder_.path() / "{scenes,more}/*").string()};
  EXPECT_THROW(batch_scenes(options), FieldError);
}

}  // namespace
}  // namespace rebake::test
