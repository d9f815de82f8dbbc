#include "mesh_ops/formats/images/environment_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/images/picture_codecs.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

using std::numbers::pi;

constexpr int largest_width = 32768;
constexpr int max_stored_width = 2048;  // wider images are reduced; pixels stay smaller than a sun

// Equirectangular radiance map, in rows from the top.
struct Panorama {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3f> pixels;

  Eigen::Vector3f& at(int x, int y) {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
  const Eigen::Vector3f& at(int x, int y) const { return const_cast<Panorama&>(*this).at(x, y); }
  // Solid angle of a pixel in row y, in steradians.
  double solid_angle(int y) const {
    return 2 * pi / width * (std::cos(pi * y / height) - std::cos(pi * (y + 1) / height));
  }
  Vec3 direction(int x, int y) const {
    const double down = pi * (y + 0.5) / height, right = 2 * pi * ((x + 0.5) / width - 0.5);
    return {std::sin(down) * std::sin(right), std::cos(down), -std::sin(down) * std::cos(right)};
  }
  const Eigen::Vector3f& towards(const Vec3& d) const {
    const double right = std::atan2(d.x(), -d.z()) / (2 * pi) + 0.5,
                 down = std::acos(std::clamp(d.y(), -1.0, 1.0)) / pi;
    return at(std::clamp(static_cast<int>(right * width), 0, width - 1),
              std::clamp(static_cast<int>(down * height), 0, height - 1));
  }
};

double luminance(const Eigen::Vector3f& c) {
  return static_cast<double>(0.2126F * c[0] + 0.7152F * c[1] + 0.0722F * c[2]);  // BT.709 weights
}

// Reads the image in strips of rows, and averages blocks of pixels if it is wider than max_stored_width.
Panorama read_panorama(const fs::path& path) {
  const auto input = open_picture(path);
  const PictureLayout& layout = input->layout();
  if (layout.part)
    throw FileError(path, fmt::format("contains only {}×{} pixels of an image of {}×{}; save the whole image",
                                      layout.width, layout.height, layout.whole_width, layout.whole_height));
  if (layout.width < 4)
    throw FileError(path,
                    fmt::format("is {}×{} pixels; an environment map has at least 4×2", layout.width, layout.height));
  if (layout.width % 2 != 0 || layout.width / 2 != layout.height)
    throw FileError(path, fmt::format("is {}×{} pixels; an environment map must be twice as wide as high", layout.width,
                                      layout.height));
  if (layout.width > largest_width)
    throw FileError(path, fmt::format("is {} pixels wide; at most {} can be read", layout.width, largest_width));
  const std::string& colors = layout.color_space;
  // Integer channels are display colours unless marked linear; floating-point channels are radiances unless marked
  // sRGB.
  const bool display = layout.floating
                           ? colors == "sRGB"
                           : colors.find("inear") == std::string::npos && colors.find("lin_") == std::string::npos;
  const int block = (layout.width + max_stored_width - 1) / max_stored_width, channels = std::min(3, layout.channels);
  Panorama result;
  result.width = layout.width / block;
  result.height = layout.height / block;
  result.pixels.assign(static_cast<std::size_t>(result.width) * static_cast<std::size_t>(result.height),
                       Eigen::Vector3f::Zero());
  const int rows_at_once = layout.rows_at_once > 1 ? layout.rows_at_once : block;
  std::vector<float> rows(static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(rows_at_once) *
                          static_cast<std::size_t>(channels));
  for (int first = 0; first < layout.height; first += rows_at_once) {
    const int count = std::min(rows_at_once, layout.height - first);
    if (!input->read(first, count, channels, rows.data()))
      throw FileError(path, "cannot be decoded, it may be truncated: " + picture_problem(input->error(), path));
    for (int y = first; y < first + count; ++y)
      for (int x = 0; x < result.width * block && y / block < result.height; ++x) {
        const float* pixel = &rows[(static_cast<std::size_t>(y - first) * static_cast<std::size_t>(layout.width) +
                                    static_cast<std::size_t>(x)) *
                                   static_cast<std::size_t>(channels)];
        Eigen::Vector3f color(pixel[0], pixel[channels >= 3 ? 1 : 0], pixel[channels >= 3 ? 2 : 0]);
        for (float& c : color) {
          if (!(c > 0)) c = 0;  // negative or NaN
          c = std::min(c, 1e6F);
          if (display) c = static_cast<float>(to_linear(static_cast<double>(c)));
        }
        result.at(x / block, y / block) += color / static_cast<float>(block * block);
      }
  }
  return result;
}

// Visits the pixels within `reach` radians of a direction: visit(color, direction, solid angle).
template <class Visit>
void for_each_near(Panorama& panorama, const Vec3& middle, double reach, Visit visit) {
  const double row = std::acos(std::clamp(middle.y(), -1.0, 1.0)) / pi * panorama.height,
               rows = reach / pi * panorama.height + 1;
  const int first = std::max(0, static_cast<int>(row - rows)),
            last = std::min(panorama.height - 1, static_cast<int>(row + rows));
  for (int y = first; y <= last; ++y)
    for (int x = 0; x < panorama.width; ++x)
      if (const Vec3 d = panorama.direction(x, y); d.dot(middle) > std::cos(reach))
        visit(panorama.at(x, y), d, panorama.solid_angle(y));
}

// Replaces very bright spots by suns: disks with the same irradiance.
std::vector<Sun> suns_of(Panorama& panorama) {
  constexpr std::size_t most = 4;
  constexpr int max_tried = 64;
  // Outshines, left: relative to the mean luminance. Reach: radians.
  constexpr double outshines = 30, left = 10, reach = 0.1;
  constexpr double worth = 0.005;  // share of all light below which a spot stays in the sky
  std::vector<Sun> suns;
  // Luminance per pixel; 0 for pixels that were already examined.
  std::vector<float> bright;
  double all = 0;
  for (int y = 0; y < panorama.height; ++y)
    for (int x = 0; x < panorama.width; ++x) {
      bright.push_back(static_cast<float>(luminance(panorama.at(x, y))));
      all += panorama.solid_angle(y) * luminance(panorama.at(x, y));
    }
  for (int tried = 0; tried < max_tried && suns.size() < most; ++tried) {
    const auto brightest = std::max_element(bright.begin(), bright.end());
    const auto number = static_cast<int>(brightest - bright.begin());
    const Vec3 middle = panorama.direction(number % panorama.width, number / panorama.width);
    // The mean excludes the spot itself, which could hide it.
    double near = 0;
    for_each_near(panorama, middle, reach,
                  [&](const Eigen::Vector3f& c, const Vec3&, double angle) { near += angle * luminance(c); });
    const double mean = (all - near) / (4 * pi);
    if (!(static_cast<double>(*brightest) > outshines * mean)) break;
    const auto excess = [&](const Eigen::Vector3f& c) { return std::max(0.0, luminance(c) - left * mean); };
    Sun sun;
    sun.direction = Vec3::Zero();
    double sent = 0, spread = 0;
    for_each_near(panorama, middle, reach, [&](const Eigen::Vector3f& c, const Vec3& d, double angle) {
      if (excess(c) == 0) return;
      sun.irradiance += c.cast<double>() * (angle / pi * excess(c) / luminance(c));
      sun.direction += angle * excess(c) * d;
      sent += angle * excess(c);
    });
    const bool kept = sent > worth * all;
    sun.direction.normalize();
    for_each_near(panorama, middle, reach, [&](Eigen::Vector3f& c, const Vec3& d, double angle) {
      bright[static_cast<std::size_t>(&c - panorama.pixels.data())] = 0;
      if (!kept || excess(c) == 0) return;
      spread += angle * excess(c) * (d - sun.direction).squaredNorm();
      c *= static_cast<float>(left * mean / luminance(c));
    });
    if (!kept) continue;
    // The mean squared distance of a uniform disk's points from its centre is half its squared radius.
    sun.radius = std::clamp(std::sqrt(2 * spread / sent), 0.002, reach);
    all -= sent;
    suns.push_back(sun);
  }
  return suns;
}

}  // namespace

LightPicture read_environment_map(const fs::path& path) {
  LightPicture result;
  result.path = path.string();
  result.content = hash_text(content_hash(read_file(path)));
  Panorama panorama = read_panorama(path);
  if (hash_text(content_hash(read_file(path))) != result.content)
    throw FileError(path, "changed while it was read; try again");
  result.light.suns = suns_of(panorama);
  constexpr int side = 64;
  const int finer = std::clamp(panorama.width / (2 * side), 2, 16);
  result.light.sky =
      SkyMap(side * finer, [&](const Vec3& d) { return panorama.towards(d).cast<double>(); }).coarser(finer);
  return result;
}

}  // namespace rebake
