// Scenes against photographs: pictures of the scene itself are equal, and only own files are replaced.
#include "editor/actions/compare_photographs.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"
#include "tests/support/script_fixture.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

class ComparePhotographs : public Script {
 protected:
  ComparePhotographs() {
    fs::create_directories(at("cap"));
    session.say = [&](const std::string& line) { said_ += line + "\n"; };
    run(import + R"({"op": "view", "name": "a", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0]}}
{"op": "view", "name": "b", "camera": {"eye": [3, 1, 4], "target": [0, 0, 0], "fov": 30}}
{"op": "export_views", "out": "{here}/cap/transforms.json", "width": 48, "height": 32}
{"op": "render", "view": "a", "out": "{here}/cap/a.png", "width": 48, "height": 32}
{"op": "render", "view": "b", "out": "{here}/cap/b.png", "width": 48, "height": 32})");
    said();
  }
  fs::path at(const std::string& name) const { return folder_.path() / name; }
  std::string said() { return std::exchange(said_, ""); }
  const std::string compare_ = R"({"op": "compare_photographs", "cameras": "{here}/cap/transforms.json")";

 private:
  std::string said_;
};

TEST_F(ComparePhotographs, PicturesOfTheSceneItselfAgree) {
  run(compare_ + R"(, "out": "{here}/out", "min_psnr": 45})");
  EXPECT_FALSE(session.below_requested_psnr);
  EXPECT_NE(said().find("mean of 2 photographs: "), std::string::npos);
  EXPECT_EQ(read_file(at("out/photographs.csv")).substr(0, 34), "photograph,pixels,PSNR dB,SSIM,FLI");
  for (const char* name : {"a.png", "b.png", "worst.png"}) EXPECT_TRUE(fs::exists(at("out") / name)) << name;
  // Again over its own files.
  run(R"({"op": "transform", "node": "ball", "translate": [1, 0, 0]})"
      "\n" +
      compare_ + R"(, "out": "{here}/out", "min_psnr": 45})");
  EXPECT_TRUE(session.below_requested_psnr);
}

TEST_F(ComparePhotographs, KeepsFilesOfOthersAndTheCapture) {
  expect_error(compare_ + R"(, "out": "{here}/cap"})", "a file of the capture");
  fs::create_directories(at("mine"));
  write_text(at("mine/photographs.csv"), "my table");
  expect_error(compare_ + R"(, "out": "{here}/mine"})", "is not a table of this comparison");
  EXPECT_EQ(read_file(at("mine/photographs.csv")), "my table");
  run(compare_ + R"(, "out": "{here}/out"})");
  const std::string first = read_file(at("out/photographs.csv"));
  write_text(at("mine/photographs.csv"), first + "my note\n");
  expect_error(compare_ + R"(, "out": "{here}/mine"})", "is not a table of this comparison");
  std::filesystem::create_directories(at("linked"));
  std::filesystem::create_symlink(at("out/photographs.csv"), at("linked/photographs.csv"));
  expect_error(compare_ + R"(, "out": "{here}/linked"})", "or is a link");
  EXPECT_EQ(read_file(at("out/photographs.csv")), first);
  fs::remove(at("cap/b.png"));
  run(compare_ + "}");
  EXPECT_NE(said().find("1 of 2 photographs missing, the first is \"b.png\""), std::string::npos);
  fs::remove(at("cap/a.png"));
  expect_error(compare_ + "}", "none of its photographs exists and shows something");
}

TEST_F(ComparePhotographs, CamerasOfOtherScaleAndWorldAreBroughtToTheScene) {
  // The same cameras, at half the scale and with another axis up.
  auto cameras = nlohmann::json::parse(read_file(at("cap/transforms.json")));
  for (auto& frame : cameras["frames"]) {
    auto& pose = frame["transform_matrix"];
    for (int row = 0; row < 3; ++row) pose[row][3] = pose[row][3].get<double>() / 2;
    // (x, y, z) of a file with z up is (x, z, −y) with y up.
    const auto second = pose[1];
    pose[1] = pose[2];
    for (int column = 0; column < 4; ++column) pose[2][column] = -second[column].get<double>();
  }
  write_text(at("cap/transforms.json"), cameras.dump());
  run(compare_ + R"(, "min_psnr": 45})");
  EXPECT_TRUE(session.below_requested_psnr);
  session.below_requested_psnr = false;
  run(compare_ + R"(, "min_psnr": 45, "scale": 2, "world": "y_up", "format": "transforms"})");
  EXPECT_FALSE(session.below_requested_psnr);
  expect_error(compare_ + R"(, "scale": 0})", "scale");
}

TEST_F(ComparePhotographs, RenderedPhotographsOfAnotherCaptureAreKept) {
  fs::create_directories(at("synthetic"));
  for (const char* name : {"transforms.json", "a.png", "b.png"})
    fs::copy_file(at("cap") / name, at("synthetic") / name);
  const auto before = folder_bytes(at("synthetic"));
  expect_error(compare_ + R"(, "out": "{here}/synthetic"})", "of the capture in its folder");
  EXPECT_EQ(folder_bytes(at("synthetic")), before);
}

}  // namespace
}  // namespace rebake::test
