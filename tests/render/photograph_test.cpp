// Photographs as views: lens distortion, masks, alpha, other sizes; errors over what counts.
#include "render/photograph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

class PhotographTest : public ::testing::Test {
 protected:
  static Image gradient(int width, int height) {
    Image image{width, height, {}, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        for (const int value : {255 * x / width, 255 * y / height, 128})
          image.rgb.push_back(static_cast<std::uint8_t>(value));
    return image;
  }
  static PhotoCamera camera(int width, int height) {
    PhotoCamera made;
    made.name = "a.png";
    made.width = width;
    made.height = height;
    made.focal = {width * 1.0, width * 1.0};
    made.center = {width / 2.0, height / 2.0};
    return made;
  }
  Photograph read(const PhotoCamera& made, const Vec3& background = {1, 1, 1}) const {
    return read_photograph(made, Camera{}, folder_.path(), background);
  }
  TemporaryFolder folder_;
};

TEST_F(PhotographTest, PlainOnesAreTheFileItself) {
  write_picture(gradient(40, 30), folder_.path() / "a.png", {});
  const Photograph photograph = read(camera(40, 30));
  EXPECT_EQ(photograph.image, gradient(40, 30));
  EXPECT_FALSE(photograph.resampled);
  EXPECT_NEAR(photograph.camera.fov_degrees, 2 * std::atan(0.5 * 30 / 40) * 180 / M_PI, 1e-12);
  // A file of half the size that the cameras state.
  PhotoCamera twice = camera(80, 60);
  EXPECT_EQ(read(twice).image, gradient(40, 30));
  EXPECT_NEAR(read(twice).camera.fov_degrees, photograph.camera.fov_degrees, 1e-12);
}

// With a known distortion, each pixel of the view has the colour of the distorted place in the photograph.
TEST_F(PhotographTest, DistortionAndCentresAreResampled) {
  const int width = 200, height = 160;
  write_picture(gradient(width, height), folder_.path() / "a.png", {});
  PhotoCamera made = camera(width, height);
  made.distortion.radial = {0.1, -0.02, 0, 0};
  made.center += Vec2(7.3, -4.6);
  const Photograph photograph = read(made);
  EXPECT_TRUE(photograph.resampled);
  std::size_t compared = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto p = static_cast<std::size_t>(y * width + x);
      const Vec2 at((x + 0.5 - width / 2.0) / width, (y + 0.5 - height / 2.0) / width);
      const double r2 = at.squaredNorm();
      const Vec2 place = made.center + width * at * (1 + 0.1 * r2 - 0.02 * r2 * r2);
      const bool inside = place.x() > 0.5 && place.y() > 0.5 && place.x() < width - 0.5 && place.y() < height - 0.5;
      EXPECT_TRUE(!inside || photograph.valid[p] == 1);
      if (!inside || photograph.valid[p] == 0) continue;
      ++compared;
      EXPECT_NEAR(photograph.image.rgb[3 * p], 255 * (place.x() - 0.5) / width, 1.6);
      EXPECT_NEAR(photograph.image.rgb[3 * p + 1], 255 * (place.y() - 0.5) / height, 1.6);
    }
  EXPECT_GT(compared, 25000U);
  EXPECT_LT(compared, static_cast<std::size_t>(width * height));
}

TEST_F(PhotographTest, MasksAndTransparencyDecideWhatCounts) {
  Image image = gradient(40, 30);
  image.alpha.assign(1200, 255);
  image.alpha[0] = 0;
  write_picture(image, folder_.path() / "a.png", {});
  Image mask{20, 15, std::vector<std::uint8_t>(900, 255), {}};
  for (std::size_t k = 0; k < 3 * 20; ++k) mask.rgb[k] = 0;  // two rows of the photograph
  write_picture(mask, folder_.path() / "mask.png", {});
  PhotoCamera made = camera(40, 30);
  made.mask = "mask.png";
  const Photograph photograph = read(made, {0.2, 0.4, 0.6});
  EXPECT_EQ(photograph.image.rgb[0], 51);
  EXPECT_EQ(photograph.image.rgb[2], 153);
  EXPECT_EQ(photograph.valid[79], 0);
  EXPECT_EQ(photograph.valid[80], 1);
  // Errors in the part that is left out have no influence.
  Image drawn = photograph.image;
  for (std::size_t k = 0; k < 3 * 80; ++k) drawn.rgb[k] ^= 255;
  const PhotographErrors none = errors_against(photograph, drawn);
  EXPECT_EQ(none.pixels, 1120U);
  EXPECT_EQ(none.psnr_db, std::numeric_limits<double>::infinity());
  EXPECT_EQ(none.flip, 0);
  EXPECT_DOUBLE_EQ(none.ssim, 1);
  drawn.rgb[3 * 600] ^= 10;
  const int d = int{drawn.rgb[3 * 600]} - int{photograph.image.rgb[3 * 600]};
  EXPECT_NEAR(errors_against(photograph, drawn).psnr_db, 10 * std::log10(255.0 * 255 * 3 * 1120 / (d * d)), 1e-9);
}

TEST_F(PhotographTest, GainsOfExposureAreFound) {
  write_picture(gradient(40, 30), folder_.path() / "a.png", {});
  const Photograph photograph = read(camera(40, 30));
  const Image darker = with_gain(photograph.image, {0.5, 0.7, 0.9});
  const Vec3 gain = exposure_gain(photograph, darker);
  EXPECT_NEAR(gain.x(), 1 / 0.5, 0.02);
  EXPECT_NEAR(gain.y(), 1 / 0.7, 0.02);
  EXPECT_NEAR(gain.z(), 1 / 0.9, 0.02);
  EXPECT_GT(errors_against(photograph, with_gain(darker, gain)).psnr_db, 45);
}

// White backgrounds are white at any exposure.
TEST_F(PhotographTest, ClippedPixelsDoNotCountForExposure) {
  Image image = gradient(40, 30);
  for (std::size_t k = 0; k < image.rgb.size() / 2; ++k) image.rgb[k] = 255;
  write_picture(with_gain(image, {2, 2, 2}), folder_.path() / "a.png", {});
  Photograph photograph = read(camera(40, 30));
  const Vec3 gain = exposure_gain(photograph, image);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(gain[c], 2, 0.05);
  leave_out_clipped(photograph);
  EXPECT_EQ(photograph.valid[0], 0);
  EXPECT_EQ(photograph.valid[20 * 40 + 5], 1);
}

TEST_F(PhotographTest, SaysWhatIsWrong) {
  EXPECT_THROW(read(camera(40, 30)), FileError) << "no file";
  write_picture(gradient(40, 30), folder_.path() / "a.png", {});
  PhotoCamera unmasked = camera(40, 30);
  unmasked.mask = "none.png";
  EXPECT_THROW(read(unmasked), FileError) << "its mask is missing";
  PhotoCamera bad = camera(40, 30);
  bad.focal.x() = std::nan("");
  EXPECT_THROW(read(bad), FieldError);
  Photograph photograph = read(camera(40, 30));
  EXPECT_THROW(errors_against(photograph, gradient(20, 30)), Error);
  photograph.valid.assign(1200, 0);
  EXPECT_THROW(errors_against(photograph, gradient(40, 30)), Error);
}

}  // namespace
}  // namespace rebake::test
