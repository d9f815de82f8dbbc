#include "render/photograph.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/cameras/mask_images.h"
#include "mesh_ops/formats/cameras/photographs.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/compare.h"
#include "render/flip.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

std::size_t at(int x, int y, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

// Intrinsics for pictures of another size.
PhotoCamera scaled_to(PhotoCamera camera, int width, int height) {
  if (camera.width > 0 && camera.height > 0) {
    const Vec2 scale(static_cast<double>(width) / camera.width, static_cast<double>(height) / camera.height);
    camera.focal = camera.focal.cwiseProduct(scale);
    camera.center = camera.center.cwiseProduct(scale);
  }
  camera.width = width;
  camera.height = height;
  return camera;
}

bool needs_resampling(const PhotoCamera& camera) {
  const Vec2 middle(camera.width / 2.0, camera.height / 2.0);
  constexpr double of_a_pixel = 1e-6;
  return !camera.distortion.none() || (camera.center - middle).cwiseAbs().maxCoeff() > of_a_pixel ||
         std::abs(camera.focal.x() / camera.focal.y() - 1) > of_a_pixel / camera.width;
}

// A colour of a photograph between its pixels, and whether all four pixels are valid.
struct Sample {
  std::array<double, 3> rgb{};
  bool valid = false;
};
Sample sampled(const Image& image, const std::vector<std::uint8_t>& valid, const Vec2& place) {
  const double x = place.x() - 0.5, y = place.y() - 0.5;
  const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  if (!(x >= -0.5 && y >= -0.5 && x <= image.width - 0.5 && y <= image.height - 0.5)) return {};
  Sample sample;
  sample.valid = true;
  for (int corner = 0; corner < 4; ++corner) {
    const int px = std::clamp(left + corner % 2, 0, image.width - 1),
              py = std::clamp(top + corner / 2, 0, image.height - 1);
    const double weight = (corner % 2 == 1 ? x - left : left + 1 - x) * (corner / 2 == 1 ? y - top : top + 1 - y);
    const std::size_t p = at(px, py, image.width);
    sample.valid = sample.valid && (weight == 0 || valid[p] != 0);
    for (std::size_t c = 0; c < 3; ++c) sample.rgb[c] += weight * image.rgb[3 * p + c];
  }
  return sample;
}

// The photograph as a view with square pixels, in which the vertical focal length and the height stay.
void resample(const PhotoCamera& camera, Photograph& photograph) {
  const int height = camera.height,
            width = std::max(1, static_cast<int>(std::lround(camera.width * camera.focal.y() / camera.focal.x())));
  Image image{width, height, {}, {}};
  std::vector<std::uint8_t> valid;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec3 direction((x + 0.5 - width / 2.0) / camera.focal.y(), -(y + 0.5 - height / 2.0) / camera.focal.y(),
                           -1);
      const auto place = pixel_of(camera, camera.eye + camera.axes * direction);
      const Sample sample = place ? sampled(photograph.image, photograph.valid, *place) : Sample{};
      for (const double c : sample.rgb) image.rgb.push_back(static_cast<std::uint8_t>(std::lround(c)));
      valid.push_back(sample.valid ? 1 : 0);
    }
  photograph.image = std::move(image);
  photograph.valid = std::move(valid);
  photograph.resampled = true;
}

void leave_out_masked(const PhotoCamera& camera, const fs::path& folder, Photograph& photograph) {
  const fs::path file = mask_files({camera}, folder, {}).front();
  if (file.empty()) {
    if (!camera.mask.empty()) throw FileError(folder / camera.mask, "does not exist; the camera file names this mask");
    return;
  }
  const LabelImage mask = read_mask(file);
  // A mask may have another size than its photograph.
  const int width = photograph.image.width, height = photograph.image.height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (mask.labels[at(static_cast<int>(std::int64_t{x} * mask.width / width),
                         static_cast<int>(std::int64_t{y} * mask.height / height), mask.width)] == 0)
        photograph.valid[at(x, y, width)] = 0;
}

}  // namespace

Photograph read_photograph(const PhotoCamera& camera, const Camera& view, const fs::path& folder,
                           const Vec3& background) {
  const fs::path file = photograph_at(folder, camera.name);
  if (file.empty()) throw FileError(folder / camera.name, "does not exist; the camera file names this photograph");
  Photograph photograph{camera.name, view, read_image(file, AlphaChannel::keep), {}, false};
  Image& image = photograph.image;
  photograph.valid.assign(image.rgb.size() / 3, 1);
  leave_out_masked(camera, folder, photograph);
  for (std::size_t p = 0; p < image.alpha.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      const double alpha = image.alpha[p] / 255.0;
      image.rgb[3 * p + c] = static_cast<std::uint8_t>(
          std::lround(alpha * image.rgb[3 * p + c] + (1 - alpha) * 255 * background[static_cast<Eigen::Index>(c)]));
    }
  image.alpha.clear();
  const PhotoCamera scaled = scaled_to(camera, image.width, image.height);
  check(scaled);
  photograph.camera.fov_degrees = 2 * std::atan(scaled.height / (2 * scaled.focal.y())) * 180 / std::numbers::pi;
  if (needs_resampling(scaled)) resample(scaled, photograph);
  return photograph;
}

PhotographErrors errors_against(const Photograph& photograph, const Image& picture) {
  const Image& image = photograph.image;
  if (picture.width != image.width || picture.height != image.height)
    throw Error(fmt::format("the picture has {}×{} pixels, but the photograph {}×{}", picture.width, picture.height,
                            image.width, image.height));
  // Invalid pixels show the same in both, so that they have no influence on their neighbours.
  Image drawn = picture;
  PhotographErrors errors;
  double squares = 0;
  for (std::size_t p = 0; p < photograph.valid.size(); ++p)
    for (std::size_t c = 0; c < 3; ++c) {
      if (photograph.valid[p] == 0) drawn.rgb[3 * p + c] = image.rgb[3 * p + c];
      const double d = int{drawn.rgb[3 * p + c]} - int{image.rgb[3 * p + c]};
      squares += d * d;
    }
  errors.pixels = static_cast<std::size_t>(std::count(photograph.valid.begin(), photograph.valid.end(), 1));
  if (errors.pixels == 0) throw Error("\"" + photograph.name + "\" has no pixel that counts: its mask leaves out all");
  const double pixels = static_cast<double>(errors.pixels);
  errors.psnr_db =
      squares == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(255.0 * 255.0 * 3 * pixels / squares);
  errors.map = flip_map(image, drawn);
  const std::vector<double> similarity = ssim_map(image, drawn);
  double ssim = 0, flip = 0;
  for (std::size_t p = 0; p < errors.map.size(); ++p) {
    if (photograph.valid[p] == 0) {
      errors.map[p] = 0;
      continue;
    }
    ssim += similarity[p];
    flip += errors.map[p];
  }
  errors.ssim = ssim / pixels;
  errors.flip = flip / pixels;
  return errors;
}

namespace {

// Whether a channel is so bright that the sensor may have clipped it.
bool is_clipped(const Image& image, std::size_t pixel) {
  constexpr std::uint8_t bright = 250;
  return std::any_of(&image.rgb[3 * pixel], &image.rgb[3 * pixel] + 3, [](std::uint8_t v) { return v >= bright; });
}

}  // namespace

Vec3 exposure_gain(const Photograph& photograph, const Image& picture) {
  Vec3 products = Vec3::Zero(), squares = Vec3::Zero();
  for (std::size_t p = 0; p < photograph.valid.size(); ++p) {
    if (photograph.valid[p] == 0 || is_clipped(photograph.image, p) || is_clipped(picture, p)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const double own = to_linear(picture.rgb[3 * p + c] / 255.0),
                   wanted = to_linear(photograph.image.rgb[3 * p + c] / 255.0);
      products[static_cast<Eigen::Index>(c)] += own * wanted;
      squares[static_cast<Eigen::Index>(c)] += own * own;
    }
  }
  Vec3 gain(1, 1, 1);
  for (int c = 0; c < 3; ++c)
    if (squares[c] > 0) gain[c] = products[c] / squares[c];
  return gain;
}

void leave_out_clipped(Photograph& photograph) {
  for (std::size_t p = 0; p < photograph.valid.size(); ++p)
    if (is_clipped(photograph.image, p)) photograph.valid[p] = 0;
}

Image with_gain(const Image& picture, const Vec3& gain) {
  Image result = picture;
  std::array<std::array<std::uint8_t, 256>, 3> table{};
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t v = 0; v < 256; ++v)
      table[c][v] = static_cast<std::uint8_t>(std::lround(
          255 * to_display(std::clamp(gain[static_cast<Eigen::Index>(c)] * to_linear(static_cast<double>(v) / 255), 0.0,
                                      1.0))));
  for (std::size_t k = 0; k < result.rgb.size(); ++k) result.rgb[k] = table[k % 3][result.rgb[k]];
  return result;
}

Image error_colors(const std::vector<double>& errors, int width, int height) {
  constexpr std::array<std::array<double, 3>, 5> stops{
      {{0, 0, 4}, {81, 18, 124}, {183, 55, 121}, {252, 137, 97}, {252, 253, 191}}};
  Image image{width, height, {}, {}};
  for (const double error : errors) {
    const double place = std::clamp(error, 0.0, 1.0) * (stops.size() - 1);
    const auto first = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    for (std::size_t c = 0; c < 3; ++c)
      image.rgb.push_back(static_cast<std::uint8_t>(
          std::lround(std::lerp(stops[first][c], stops[first + 1][c], place - static_cast<double>(first)))));
  }
  return image;
}

}  // namespace rebake
