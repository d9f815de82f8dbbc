// Equirectangular environment maps: orientation, extraction of suns, and files that are rejected.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/environment_map.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "tests/support/light_pictures.h"
#include "tests/support/made_scenes.h"
#include "tests/support/picture_files.h"
#include "tests/support/thorough.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;
using std::numbers::pi;

class LightPictureTest : public ::testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  LightPicture read(const std::string& name) const { return read_environment_map(path(name)); }
  TemporaryFolder folder_;
};

TEST_F(LightPictureTest, Orientation) {
  // A different colour around each of the six axes.
  const auto color = [](const Vec3& d) -> Radiance {
    Eigen::Index axis = 0;
    d.cwiseAbs().maxCoeff(&axis);
    return Radiance::Constant(d[axis] > 0 ? 0.2 : 0.1) + 0.5 * Radiance::Unit(axis);
  };
  write_light_picture(path("axes.exr"), 128, color);
  const LightPicture picture = read("axes.exr");
  EXPECT_TRUE(picture.light.suns.empty());
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 d = sign * Vec3::Unit(axis);
      EXPECT_LT((picture.light.sky.at(d) - color(d)).norm(), 1e-6) << d.transpose();
    }
}

TEST_F(LightPictureTest, SkyMatchesThePicture) {
  const auto blend = [](const Vec3& d) -> Radiance {
    return {0.5 + 0.4 * d.y(), 0.5 + 0.3 * d.x(), 0.5 - 0.2 * d.z()};
  };
  for (const int width : {64, 512, 288 * thorough}) {
    write_light_picture(path("blend.exr"), width, blend);
    const LightPicture picture = read("blend.exr");
    EXPECT_LT((picture.light.sky.mean() - Radiance::Constant(0.5)).norm(), 2e-3) << width;
    for (int k = 0; k < 200; ++k) {
      const Vec3 d = Vec3(std::sin(k * 1.3), std::cos(k * 2.1), std::sin(k * 0.7 + 1)).normalized();
      // Pixels of the smallest picture are 0.1 rad wide, texels of the sky map 0.05 rad.
      EXPECT_LT((picture.light.sky.at(d) - blend(d)).cwiseAbs().maxCoeff(), width == 64 ? 0.05 : 0.02) << width;
    }
  }
}

// Random rays would miss a disk of half a degree; a sun gets rays of its own.
TEST_F(LightPictureTest, BrightDiskBecomesASunOfEqualIrradiance) {
  // At the upper edge of the picture, in the middle, and across its seam.
  for (const auto& [towards, radius] : {std::pair(Vec3(0.02, 1, 0.01), 0.02), std::pair(Vec3(0.5, 0.8, 0.45), 0.01),
                                        std::pair(Vec3(0, 0.2, 1), 0.03)}) {
    const Vec3 direction = towards.normalized();
    const Radiance sky(0.2, 0.3, 0.5), disk(900, 800, 600);
    write_light_picture(path("sun.exr"), 2048,
                        [&](const Vec3& d) { return (d - direction).norm() < radius ? disk : sky; });
    const LightPicture picture = read("sun.exr");
    ASSERT_EQ(picture.light.suns.size(), 1U);
    const Sun& sun = picture.light.suns.front();
    EXPECT_LT((sun.direction - direction).norm(), 0.002);
    EXPECT_NEAR(sun.radius, radius, 0.1 * radius);
    // Irradiance / π of a disk of angular radius r is sin² r times its radiance.
    const Radiance sent = std::pow(std::sin(radius), 2) * disk;
    EXPECT_LT((sun.irradiance - sent).cwiseQuotient(sent).cwiseAbs().maxCoeff(), 0.04);
    EXPECT_LT((picture.light.sky.at(-direction) - sky).norm(), 1e-6);
    EXPECT_LT(picture.light.sky.brightest().maxCoeff(), 6);
    if (thorough == 1) break;
  }
}

// Small lamps stay in the sky, a large one becomes a sun; the total light is preserved.
TEST_F(LightPictureTest, PreservesLightOfLamps) {
  int number = 0;
  double sum = 0, angles = 0;
  const Vec3 large = Vec3(1, 1, 0).normalized();
  write_light_picture(path("lamps.exr"), 1024, [&](const Vec3& d) {
    const double level = (d - large).norm() < 0.02 ? 300 : number % 4001 == 0 ? 200 : 0.1;
    const double angle = std::sqrt(1 - d.y() * d.y());
    ++number;
    sum += angle * level;
    angles += angle;
    return Radiance::Constant(level);
  });
  const LightPicture picture = read("lamps.exr");
  ASSERT_EQ(picture.light.suns.size(), 1U);
  EXPECT_LT((picture.light.suns[0].direction - large).norm(), 0.005);
  EXPECT_NEAR(picture.light.sky.mean()[0] + picture.light.suns[0].irradiance[0] / 4, sum / angles, 0.02 * sum / angles);
}

// A night sky: stars do not become suns, and thousands of candidates do not take long.
TEST_F(LightPictureTest, StarsDoNotBecomeSuns) {
  int number = 0;
  write_light_picture(path("stars.exr"), 512,
                      [&](const Vec3&) { return Radiance::Constant(++number % 97 == 0 ? 50 + number % 89 : 0.2); });
  const auto start = std::chrono::steady_clock::now();
  const LightPicture picture = read("stars.exr");
  // About 1 s (30 s with sanitizers on a busy machine); testing every star would take minutes.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(thorough > 1 ? 20 : 200));
  EXPECT_LE(picture.light.suns.size(), 4U);
  EXPECT_NEAR(picture.light.sky.mean()[0], 0.2 + 94.0 / 97, 0.15);
}

TEST_F(LightPictureTest, BytesAreDisplayColours) {
  write_light_picture(path("grey.png"), 64, [](const Vec3&) { return Radiance::Constant(to_display(0.2)); });
  EXPECT_LT((read("grey.png").light.sky.at({0, 1, 0}) - Radiance::Constant(0.2)).norm(), 0.005);
}

TEST_F(LightPictureTest, IgnoresAlpha) {
  std::vector<std::uint8_t> bytes;
  for (int k = 0; k < 32; ++k) bytes.insert(bytes.end(), {127, 127, 127, 100});
  write_text(path("through.png"), encode_png(8, 4, 4, bytes, 6));
  EXPECT_NEAR(read("through.png").light.sky.mean()[0], to_linear(127 / 255.0), 1e-4);
}

TEST_F(LightPictureTest, IntegersAreDisplayColoursFloatsAreRadiances) {
  for (const char* name : {"grey8.tif", "grey16.tif", "grey16.png"}) {
    const bool wide = std::string(name).find("16") != std::string::npos;
    write_picture(path(name), {8, 4, 1, wide ? "uint16" : "uint8"}, std::vector<float>(32, 0.5F));
    EXPECT_NEAR(read(name).light.sky.mean()[0], to_linear(0.5), 0.005) << name;
  }
  write_light_picture(path("half.exr"), 8, [](const Vec3&) { return Radiance::Constant(0.5); });
  EXPECT_NEAR(read("half.exr").light.sky.mean()[0], 0.5, 1e-6);
}

TEST_F(LightPictureTest, ReadsTiledFilesRejectsPartialOnes) {
  const std::vector<float> pixels(std::size_t{256} * 128 * 3, 0.25F);
  write_picture(path("part.exr"), {256, 128, 3, "float", 0, 256}, pixels);
  EXPECT_THROW(read("part.exr"), FileError);
  write_picture(path("tiled.exr"), {256, 128, 3, "float", 32}, pixels);
  EXPECT_NEAR(read("tiled.exr").light.sky.mean()[0], 0.25, 1e-6);
}

TEST_F(LightPictureTest, ReadsBlackAndNonFinitePixels) {
  write_light_picture(path("black.exr"), 64, [](const Vec3&) { return Radiance::Zero(); });
  EXPECT_TRUE(read("black.exr").light.sky.black());
  const double none = std::numeric_limits<double>::quiet_NaN();
  write_light_picture(path("none.exr"), 64, [&](const Vec3& d) -> Radiance {
    return d.y() > 0 ? Radiance(1, 1, 1) : Radiance(none, -1, std::numeric_limits<double>::infinity());
  });
  const LightPicture picture = read("none.exr");
  EXPECT_TRUE(picture.light.sky.mean().allFinite());
  EXPECT_GE(picture.light.sky.mean().minCoeff(), 0);
}

TEST_F(LightPictureTest, RejectsOtherFilesByName) {
  write_text(path("text.exr"), "not a picture");
  write_light_picture(path("whole.exr"), 64, [](const Vec3& d) { return Radiance(d.cwiseAbs()); });
  const std::string bytes = read_file(path("whole.exr"));
  write_text(path("cut.exr"), bytes.substr(0, bytes.size() / 2));
  write_picture(path("square.png"), {8, 8, 3}, std::vector<float>(192));
  for (const char* name : {"text.exr", "cut.exr", "square.png", "missing.exr", "."}) try {
      read(name);
      ADD_FAILURE() << name << " was read";
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find(path(name).string()), std::string::npos) << error.what();
    }
}

// JPEG decoders fill in missing data without an error.
TEST_F(LightPictureTest, RejectsTruncatedFilesInOneLine) {
  for (const char* name : {"a.jpg", "a.png", "a.exr", "a.tif"}) {
    const bool floating = std::string(name) == "a.exr";
    std::vector<float> pixels(std::size_t{64} * 32 * 3);
    for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<float>(k * 37 % 101) / 101;
    write_picture(path(name), {64, 32, 3, floating ? "float" : "uint8"}, pixels);
    EXPECT_NO_THROW(read(name)) << name;
    const std::string bytes = read_file(path(name));
    for (const double share : {0.05, 0.5, 0.95}) {
      const std::string cut = std::string("cut_") + name;
      write_text(path(cut), bytes.substr(0, static_cast<std::size_t>(share * static_cast<double>(bytes.size()))));
      try {
        read(cut);
        ADD_FAILURE() << cut << " was read";
      } catch (const FileError& error) {
        const std::string text = error.what(), file = path(cut).string();
        EXPECT_EQ(text.find(file), text.rfind(file)) << "the path must occur once: " << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        EXPECT_EQ(text.find_last_of(".)("), text.rfind('.', text.find(": ")))
            << "no brackets or full stops may be left: " << text;
      }
    }
  }
}

TEST_F(LightPictureTest, EmbeddedThumbnailDoesNotEndTheJpeg) {
  std::vector<float> pixels(std::size_t{64} * 32 * 3, 0.5F);
  write_picture(path("a.jpg"), {64, 32, 3}, pixels);
  std::string bytes = read_file(path("a.jpg"));
  const std::string thumbnail = "\xff\xd8\xff\xda thumbnail \xff\xd9";
  bytes.insert(2, std::string("\xff\xe1\x00", 3) + static_cast<char>(thumbnail.size() + 2) + thumbnail);
  write_text(path("whole.jpg"), bytes + "a maker's own data, of which some \xff\xda looks like a scan");
  EXPECT_NO_THROW(read("whole.jpg"));
  write_text(path("cut.jpg"), bytes.substr(0, bytes.size() - 2));
  EXPECT_THROW(read("cut.jpg"), FileError);
}

TEST_F(LightPictureTest, RejectsTooSmallPictures) {
  write_picture(path("tiny.png"), {2, 1, 3}, std::vector<float>(6));
  try {
    read("tiny.png");
    ADD_FAILURE();
  } catch (const FileError& error) {
    EXPECT_NE(std::string(error.what()).find("at least 4×2"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace rebake::test
