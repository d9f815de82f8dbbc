// `rebake render` and `rebake compare`.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "render/image.h"
#include "tests/support/cli_fixture.h"

namespace rebake::test {
namespace {

TEST_F(Cli, RenderCompareAndTiming) {
  const ProgramResult o =
      rebake_run("render " + in("ball") + " -o " + in("a.png") + " --size 64x48 --time 2 --plan --json");
  ASSERT_EQ(o.code, 0) << o.text;
  const auto report = nlohmann::json::parse(o.text);
  for (const char* key : {"min", "median", "max"}) EXPECT_GT(report.at("frame_ms").at(key).get<double>(), 0);
  EXPECT_TRUE(report.at("passes").contains("geometry"));
  EXPECT_FALSE(report.at("plan").empty());
  EXPECT_EQ(rebake_run("render " + in("ball") + " -o " + in("b.png") + " --size 64x48 --background 0,0,0").code, 0);
  EXPECT_EQ(rebake_run("compare " + in("a.png") + " " + in("a.png") + " --min-psnr 90").code, 0);
  EXPECT_EQ(rebake_run("compare " + in("a.png") + " " + in("b.png") + " --min-psnr 90").code, 3);
}

TEST_F(Cli, PlansTimesAndAuditsNeedNoPicture) {
  for (const char* what : {"--plan", "--time 1", "--audit"}) {
    const ProgramResult o = rebake_run("render " + in("ball") + " --size 16x16 --samples 1 " + what);
    EXPECT_EQ(o.code, 0) << what << ": " << o.text;
  }
}

TEST_F(Cli, CompareSaysThatOpacityIsNotCompared) {
  for (const int alpha : {255, 0}) {
    std::vector<std::uint8_t> pixels(16, 255);
    pixels[3] = static_cast<std::uint8_t>(alpha);
    write_text(in("b.png"), encode_png(2, 2, 4, pixels, 1));
    const ProgramResult o = rebake_run("compare " + in("b.png") + " " + in("b.png"));
    EXPECT_EQ(o.text.find("note: only colours are compared, not opacity") == std::string::npos, alpha == 255) << o.text;
  }
}

TEST_F(Cli, PicturesAreWrittenInTheFormatOfTheirName) {
  for (const auto& [name, start] : {std::pair("a.jpg", "\xff\xd8\xff"), {"a.webp", "RIFF"}, {"a.exr", "\x76\x2f"}}) {
    const ProgramResult o = rebake_run("render " + in("ball") + " -o " + in(name) + " --size 32x24 --samples 1");
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
  const ProgramResult o = rebake_run(render + " -o " + in("pictures"));
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

}  // namespace
}  // namespace rebake::test
