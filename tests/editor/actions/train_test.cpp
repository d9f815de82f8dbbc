// Training from photographs of a ball: results, checkpoints and bad captures.
#include "editor/actions/train.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/cameras/transforms_json.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"
#include "render/image.h"
#include "tests/support/ball_photographs.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

constexpr int photograph_side = 24;

class Train : public Script {
 protected:
  Train() {
    session.say = [&](const std::string& line) { said_ += line + "\n"; };
  }
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  std::string said() { return std::exchange(said_, ""); }

  // Writes photographs of the ball, and their cameras to NAME.json of the folder `cap`. `gain`: per photograph, of its
  // bytes.
  void photograph(const std::string& name, int count, double phase = 0, double (*gain)(int) = nullptr) {
    fs::create_directories(at("cap"));
    std::vector<PhotoCamera> cameras;
    const std::vector<FitPhotograph> photographs = ball_photographs(count, photograph_side, phase);
    for (int k = 0; k < count; ++k) {
      const FitPhotograph& one = photographs[static_cast<std::size_t>(k)];
      Image image{one.width, one.height, one.rgb, {}};
      if (gain != nullptr)
        for (std::uint8_t& byte : image.rgb) byte = static_cast<std::uint8_t>(std::min(255.0, byte * gain(k)));
      const std::string file = fmt::format("{}{:02}.png", name, k);
      write_picture(image, at("cap") / file, {});
      cameras.push_back(photo_camera(one.camera, file, one.width, one.height));
    }
    write_text(at("cap") / (name + ".json"), transforms_text(from_y_up(std::move(cameras), WorldUp::z)));
  }
  nlohmann::json report(const std::string& folder) const {
    return nlohmann::json::parse(read_file(at(folder) / "rebake_training.json"));
  }
  // A training of two seconds.
  const std::string train_ =
      R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/out", "side": 24, "steps": 900)";

 private:
  std::string said_;
};

TEST_F(Train, WritesAFolderThatShowsThePhotographs) {
  photograph("transforms_train", 24);
  photograph("transforms_test", 5, 0.5);
  run(train_ + "}");
  const std::string words = said();
  EXPECT_NE(words.find("plan: nested boxes: none"), std::string::npos);
  EXPECT_NE(words.find("exposures agree: no gains"), std::string::npos);
  const nlohmann::json held_out = report("out")["held out"];
  EXPECT_EQ(held_out["photographs"], 5);
  const double psnr = held_out["PSNR dB"];
  EXPECT_GT(psnr, held_out["mean colour PSNR dB"].get<double>() + 3);
  EXPECT_GT(psnr, held_out["white picture PSNR dB"].get<double>() + 3);
  EXPECT_NEAR(psnr, held_out["before baking PSNR dB"], 0.5);
  EXPECT_FALSE(fs::exists(at("out.training")));
  // The folder is a scene like others, and is replaced by the next training.
  run(R"({"op": "import", "path": "{here}/out", "as": "ball"}
{"op": "transform", "node": "ball", "translate": [1, 0, 0]}
{"op": "export", "out": "{here}/moved"})");
  EXPECT_TRUE(fs::exists(at("moved/mlp.json")));
}

TEST_F(Train, GoesOnFromACheckpointWithTheSameBytes) {
  photograph("transforms_train", 16);
  const std::string few = R"({"op": "train", "photographs": "{here}/cap", "side": 16, "steps": 200, "out": "{here}/)";
  run(few + "whole\"}");
  // Stops in stage 1 and in stage 2.
  for (const int stop : {50, 170}) {
    int steps = 0;
    std::atomic<bool> cancel = false;
    session.progress = Progress(
        [&](std::string_view what, double) {
          if (what.starts_with("training") && ++steps == stop) cancel = true;
        },
        &cancel);
    EXPECT_THROW(run(few + "parts\"}"), Cancelled);
    EXPECT_NE(said().find("the same command goes on from there"), std::string::npos);
    session.progress = {};
  }
  EXPECT_FALSE(fs::exists(at("parts")));
  // Other options and damage are refused, and lose nothing.
  expect_error(R"({"op": "train", "photographs": "{here}/cap", "side": 16, "steps": 300, "out": "{here}/parts"})",
               "a training with other options");
  const std::string checkpoint = read_file(at("parts.training/rebake-checkpoint"));
  write_text(at("parts.training/rebake-checkpoint"), checkpoint.substr(0, checkpoint.size() - 1) + "x");
  expect_error(few + "parts\"}", "is damaged");
  write_text(at("parts.training/rebake-checkpoint"), checkpoint);
  said();
  run(few + "parts\"}");
  const std::string words = said();
  EXPECT_NE(words.find("goes on from step 2"), std::string::npos) << words;
  EXPECT_EQ(folder_hash(at("parts")), folder_hash(at("whole")));
}

// The user may save a scene to the folder while the training runs.
TEST_F(Train, WhatAppearsInTheFolderDuringTheTrainingIsKept) {
  photograph("transforms_train", 12);
  int steps = 0;
  session.progress = Progress([&](std::string_view what, double) {
    if (what.starts_with("training") && ++steps == 20) fs::copy(at("ball"), at("out"));
  });
  const auto saved = folder_bytes(at("ball"));
  const std::string train =
      R"({"op": "train", "photographs": "{here}/cap", "side": 16, "steps": 100, "out": "{here}/out"})";
  expect_error(train, "was written by something else during the training");
  EXPECT_EQ(folder_bytes(at("out")), saved);
  EXPECT_TRUE(fs::exists(at("out.training"))) << "it can go on";
  // So is what replaces a scene that was there before.
  session.progress = Progress([&, done = false](std::string_view, double) mutable {
    if (std::exchange(done, true)) return;
    fs::remove_all(at("out"));
    fs::copy(at("other"), at("out"));
  });
  const auto other = folder_bytes(at("other"));
  expect_error(train, "was written by something else during the training");
  EXPECT_EQ(folder_bytes(at("out")), other);
  session.progress = {};
  // A folder that is there before the training is replaced, which is said before.
  said();
  run(train);
  const std::string words = said();
  EXPECT_LT(words.find("out exists already; its scene is replaced after the training"), words.find("stage"));
}

TEST_F(Train, ExposuresGetGainsWhereTheyDiffer) {
  REBAKE_ONLY_DEEP();
  photograph("transforms_train", 24, 0, [](int k) { return k % 2 == 0 ? 1.0 : 0.6; });
  run(train_ + R"(, "hold_out": 6})");
  const std::string words = said();
  EXPECT_NE(words.find("each photograph has a gain"), std::string::npos) << words;
  const nlohmann::json held_out = report("out")["held out"];
  EXPECT_GT(held_out["PSNR dB"].get<double>(), held_out["nearest photograph PSNR dB"].get<double>() + 6);
  EXPECT_GT(held_out["PSNR dB"].get<double>(), 17);  // 15 dB without gains
}

TEST_F(Train, UnequalSizesMissingPhotographsAndFewOnesAreSaid) {
  photograph("transforms", 3);
  // One photograph has another size, one is missing.
  write_picture({12, 12, std::vector<std::uint8_t>(3 * 144, 255), {}}, at("cap/transforms01.png"), {});
  fs::remove(at("cap/transforms02.png"));
  run(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/out", "side": 16, "steps": 100, "hold_out": 0})");
  const std::string words = said();
  EXPECT_NE(words.find("1 of 3 training photographs missing, the first is \"transforms02.png\""), std::string::npos);
  EXPECT_NE(words.find("no photograph is held out"), std::string::npos);
  EXPECT_TRUE(report("out")["held out"].is_null());
}

TEST_F(Train, BadInputIsRefusedBeforeAnythingIsWritten) {
  expect_error(train_ + "}", "does not exist");
  photograph("transforms_train", 4);
  expect_error(train_ + R"(, "minutes": 1})", "steps");
  expect_error(train_ + R"(, "seed": -1})", "seed");
  expect_error(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/cap"})", "cap");
  fs::create_directories(at("mine"));
  write_text(at("mine/letter.txt"), "dear");
  expect_error(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/mine"})", "letter.txt");
  nlohmann::json cameras = nlohmann::json::parse(read_file(at("cap/transforms_train.json")));
  cameras["frames"][1]["transform_matrix"][0][3] = "nan";
  write_text(at("cap/transforms_train.json"), cameras.dump());
  expect_error(train_ + "}", "transforms_train.json");
  photograph("transforms_train", 4);
  for (const auto& entry : fs::directory_iterator(at("cap")))
    if (entry.path().extension() == ".png") fs::remove(entry.path());
  expect_error(train_ + "}", "none of its photographs exists");
  EXPECT_FALSE(fs::exists(at("out")));
  EXPECT_FALSE(fs::exists(at("out.training")));
}

TEST_F(Train, WhatOthersPutAmongTheFilesOfATrainingIsKept) {
  photograph("transforms_train", 8);
  const auto capture = folder_hash(at("cap"));
  fs::create_symlink("fast", at("out.training"));
  fs::create_directories(at("fast"));
  int steps = 0;
  session.progress = Progress([&](std::string_view what, double) {
    if (!what.starts_with("training") || ++steps != 20) return;
    fs::remove(at("fast/rebake-preview.png"));
    fs::create_symlink(at("cap/transforms_train00.png"), at("fast/rebake-preview.png"));
    write_text(at("fast/rebake-progress.csv"), "my own table");
  });
  run(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/out", "side": 16, "steps": 300})");
  EXPECT_EQ(folder_hash(at("cap")), capture);
  EXPECT_EQ(read_file(at("fast/rebake-progress.csv")), "my own table");
  EXPECT_TRUE(fs::is_symlink(at("fast/rebake-preview.png")));
  EXPECT_TRUE(fs::is_symlink(at("out.training")));
  const std::string words = said();
  EXPECT_NE(words.find("rebake-progress.csv: is not what the training wrote there"), std::string::npos) << words;
}

TEST_F(Train, CheckpointsThatCannotBeWrittenDoNotStopIt) {
  photograph("transforms_train", 8);
  // Files of others in the folder are not touched.
  fs::create_directories(at("mine.training"));
  write_text(at("mine.training/preview.png"), "mine");
  expect_error(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/mine", "side": 16, "steps": 100})",
               "preview.png");
  EXPECT_EQ(read_file(at("mine.training/preview.png")), "mine");
  // Links lead to files of others, and a capture may have names like those of a training.
  const auto photograph_bytes = folder_hash(at("cap"));
  for (const char* name : {"rebake-preview.png", "rebake-progress.csv", "rebake-checkpoint"}) {
    fs::create_directories(at("linked.training"));
    fs::create_symlink(at("cap/transforms_train.json"), at("linked.training") / fs::path(name));
    expect_error(
        R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/linked", "side": 16, "steps": 100, "fresh": true})",
        name);
    fs::remove(at("linked.training") / fs::path(name));
    fs::create_hard_link(at("cap/transforms_train.json"), at("linked.training") / fs::path(name));
    expect_error(
        R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/linked", "side": 16, "steps": 100, "fresh": true})",
        name);
    fs::remove(at("linked.training") / fs::path(name));
  }
  write_text(at("linked.training/rebake-transforms.json"), "{}");
  expect_error(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/linked", "side": 16, "steps": 100})",
               "rebake-transforms.json");
  // Nor files of their names that another program made.
  for (const char* name : {"rebake-preview.png", "rebake-progress.csv", "rebake-checkpoint"}) {
    fs::create_directories(at("named.training"));
    write_text(at("named.training") / fs::path(name), "mine");
    expect_error(
        R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/named", "side": 16, "steps": 100, "fresh": true})",
        name);
    EXPECT_EQ(read_file(at("named.training") / fs::path(name)), "mine");
    fs::remove(at("named.training") / fs::path(name));
  }
  fs::copy(at("cap/transforms_train00.png"), at("named.training/rebake-preview.png"));
  write_text(at("named.training/rebake-preview.png"), read_file(at("named.training/rebake-preview.png")) + "retouched");
  expect_error(
      R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/named", "side": 16, "steps": 100, "fresh": true})",
      "rebake-preview.png");
  EXPECT_EQ(folder_hash(at("cap")), photograph_bytes);
  fs::create_directories(at("out.training/rebake-checkpoint"));  // a folder where the file should be
  run(R"({"op": "train", "photographs": "{here}/cap", "out": "{here}/out", "side": 16, "steps": 100, "fresh": true})");
  EXPECT_NE(said().find("the checkpoint could not be written"), std::string::npos);
  EXPECT_TRUE(fs::exists(at("out/mlp.json")));
}

}  // namespace
}  // namespace rebake::test
