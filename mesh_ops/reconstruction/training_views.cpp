#include "mesh_ops/reconstruction/training_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/scene/scene_light.h"

namespace rebake {

TrainingViews::TrainingViews(std::vector<FitPhotograph> photographs, const Affine& to_unit, Axes axes)
    : photographs_(std::move(photographs)), to_unit_(to_unit), axes_(axes_matrix(axes)) {
  for (const FitPhotograph& photograph : photographs_) {
    to_scene_.emplace_back(world_to_camera(photograph.camera).transpose());
    focal_.push_back(photograph.height / (2 * std::tan(photograph.camera.fov_degrees * std::numbers::pi / 360)));
  }
  colors_.resize(photographs_.size());
  for (std::size_t k = 0; k < photographs_.size(); ++k) set_gain(k, Vec3::Ones());
  std::size_t total = 0;
  for (const FitPhotograph& photograph : photographs_) {
    std::vector<std::uint32_t>& valid = valid_.emplace_back();
    for (std::uint32_t p = 0; p < photograph.valid.size(); ++p)
      if (photograph.valid[p] != 0) valid.push_back(p);
    ends_.push_back(total += valid.size());
    if (valid.size() == photograph.valid.size()) valid = {};
  }
  if (total == 0) throw Error("no pixel of the photographs counts: masks leave out all");
}

TrainingViews::Pixel TrainingViews::pick(SplitMix64& dice) const {
  const std::size_t number = dice.below(ends_.back());
  const auto photograph =
      static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), number) - ends_.begin());
  std::size_t pixel = number - (photograph == 0 ? 0 : ends_[photograph - 1]);
  if (!valid_[photograph].empty()) pixel = valid_[photograph][pixel];
  const auto width = static_cast<std::size_t>(photographs_[photograph].width);
  return {photograph, static_cast<int>(pixel % width), static_cast<int>(pixel / width)};
}

TrainingRay TrainingViews::ray(std::size_t photograph, double x, double y) const {
  const FitPhotograph& one = photographs_[photograph];
  const Vec3 direction = to_scene_[photograph] * Vec3((x - one.width / 2.0) / focal_[photograph],
                                                      -(y - one.height / 2.0) / focal_[photograph], -1);
  const Vec3 fed = axes_ * direction.normalized();
  return {to_unit_ * one.camera.eye,
          to_unit_.linear() * direction,
          {static_cast<float>(fed.x()), static_cast<float>(fed.y()), static_cast<float>(fed.z())}};
}

Vec3 TrainingViews::color(const Pixel& pixel) const {
  const FitPhotograph& one = photographs_[pixel.photograph];
  const std::uint8_t* at = &one.rgb[3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(one.width) +
                                         static_cast<std::size_t>(pixel.x))];
  const auto& table = colors_[pixel.photograph];
  return {table[0][at[0]], table[1][at[1]], table[2][at[2]]};
}

Vec3 TrainingViews::raw_color(const Pixel& pixel) const {
  const FitPhotograph& one = photographs_[pixel.photograph];
  const std::uint8_t* at = &one.rgb[3 * (static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(one.width) +
                                         static_cast<std::size_t>(pixel.x))];
  return Vec3(at[0], at[1], at[2]) / 255;
}

double TrainingViews::mean_brightness() const {
  double sum = 0;
  for (const FitPhotograph& one : photographs_)
    for (std::size_t p = 0; p < one.valid.size(); ++p)
      if (one.valid[p] != 0) sum += (one.rgb[3 * p] + one.rgb[3 * p + 1] + one.rgb[3 * p + 2]) / (3 * 255.0);
  return sum / static_cast<double>(ends_.back());
}

void TrainingViews::set_gain(std::size_t photograph, const Vec3& gain) {
  for (std::size_t channel = 0; channel < 3; ++channel)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const double value = static_cast<double>(byte) / 255, factor = gain[static_cast<Eigen::Index>(channel)];
      colors_[photograph][channel][byte] = factor == 1 ? value : to_display(std::min(1.0, to_linear(value) / factor));
    }
}

}  // namespace rebake
