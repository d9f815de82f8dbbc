#include "editor/training/training_judgement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "editor/actions/views.h"

namespace rebake {

double decibels_of(double mean_squared_error) { return std::min(-10 * std::log10(mean_squared_error), 100.0); }

namespace {

// Mean squared error of a photograph against colours 0 … 255: `color(x, y, channel)`.
template <class ColorAt>
double squared_error(const Photograph& photograph, const ColorAt& color) {
  const Image& image = photograph.image;
  double sum = 0;
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::size_t p =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x);
      if (photograph.valid[p] == 0) continue;
      ++count;
      for (std::size_t c = 0; c < 3; ++c) {
        const double off = (image.rgb[3 * p + c] - color(x, y, c)) / 255;
        sum += off * off / 3;
      }
    }
  return sum / static_cast<double>(std::max<std::size_t>(1, count));
}

// The training photograph whose camera is most similar: distance in units of that to the point looked at, plus angle.
const FitPhotograph& nearest_to(const Camera& camera, const std::vector<FitPhotograph>& photographs) {
  const Vec3 axis = (camera.target - camera.eye).normalized();
  const double unit = std::max((camera.target - camera.eye).norm(), std::numeric_limits<double>::min());
  return *std::min_element(photographs.begin(), photographs.end(), [&](const FitPhotograph& a, const FitPhotograph& b) {
    const auto distance = [&](const FitPhotograph& one) {
      const Vec3 other = (one.camera.target - one.camera.eye).normalized();
      return (one.camera.eye - camera.eye).norm() / unit + std::acos(std::clamp(axis.dot(other), -1.0, 1.0));
    };
    return distance(a) < distance(b);
  });
}

}  // namespace

TrainingBaselines baselines(const std::vector<FitPhotograph>& training, const std::vector<Photograph>& held_out) {
  std::array<double, 3> sums{};
  double count = 0;
  for (const FitPhotograph& one : training)
    for (std::size_t p = 0; p < one.valid.size(); ++p)
      if (one.valid[p] != 0) {
        ++count;
        for (std::size_t c = 0; c < 3; ++c) sums[c] += one.rgb[3 * p + c];
      }
  TrainingBaselines result;
  const double share = 1.0 / static_cast<double>(held_out.size());
  for (const Photograph& photograph : held_out) {
    result.mean_color_db +=
        share * decibels_of(squared_error(photograph, [&](int, int, std::size_t c) { return sums[c] / count; }));
    result.white_db += share * decibels_of(squared_error(photograph, [&](int, int, std::size_t) { return 255.0; }));
    const FitPhotograph& nearest = nearest_to(photograph.camera, training);
    result.nearest_photograph_db +=
        share * decibels_of(squared_error(photograph, [&](int x, int y, std::size_t c) {
          const int column = x * nearest.width / photograph.image.width,
                    row = y * nearest.height / photograph.image.height;
          return static_cast<double>(nearest.rgb[3 * static_cast<std::size_t>(row * nearest.width + column) + c]);
        }));
  }
  return result;
}

double held_out_psnr(const Reconstruction& training, const Capture& capture, const Progress& progress) {
  std::vector<FitPhotograph> photographs;
  for (const Photograph& photograph : capture.held_out) photographs.push_back(for_fit(photograph));
  const TrainingViews views(std::move(photographs), training.plan().to_unit, trained_axes);
  // Of large photographs, every few rows and columns are enough.
  constexpr double most_pixels = 1e6;
  double pixels = 0;
  for (const FitPhotograph& one : views.photographs()) pixels += static_cast<double>(one.valid.size());
  const int every = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / most_pixels))));
  double sum = 0;
  for (std::size_t k = 0; k < capture.held_out.size(); ++k) {
    progress.at("comparing held-out photographs",
                static_cast<double>(k) / static_cast<double>(capture.held_out.size()));
    sum += decibels_of(training.error_of(views, k, nullptr, every, progress)) /
           static_cast<double>(capture.held_out.size());
  }
  return sum;
}

MeanErrors held_out_errors(Renderer& renderer, const Scene& scene, const Capture& capture, bool gain,
                           const Progress& progress) {
  MeanErrors mean;
  const double share = 1.0 / static_cast<double>(capture.held_out.size());
  for (std::size_t k = 0; k < capture.held_out.size(); ++k) {
    progress.at("comparing held-out photographs", static_cast<double>(k) * share);
    const Photograph& photograph = capture.held_out[k];
    Image picture = renderer.render(
        scene, resolve_view(scene, photograph.camera, "", photograph.image.width, photograph.image.height, 4));
    if (gain) picture = with_gain(picture, exposure_gain(photograph, picture));
    const PhotographErrors errors = errors_against(photograph, picture);
    mean.psnr_db += share * errors.psnr_db;
    mean.ssim += share * errors.ssim;
    mean.flip += share * errors.flip;
  }
  return mean;
}

Image trained_picture(const Reconstruction& training, const FitPhotograph& photograph, const Progress& progress) {
  const TrainingViews views({photograph}, training.plan().to_unit, trained_axes);
  std::vector<float> colors;
  training.error_of(views, 0, &colors, 1, progress);
  Image image{photograph.width, photograph.height, {}, {}};
  for (const float color : colors)
    image.rgb.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(color, 0.0F, 1.0F))));
  return image;
}

FitPhotograph reduced(const FitPhotograph& photograph, int most) {
  const int larger = std::max(photograph.width, photograph.height);
  if (larger <= most) return photograph;
  FitPhotograph small = photograph;
  small.width = std::max(1, photograph.width * most / larger);
  small.height = std::max(1, photograph.height * most / larger);
  small.rgb.clear();
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      const int column = x * photograph.width / small.width, row = y * photograph.height / small.height;
      const auto at = 3 * static_cast<std::ptrdiff_t>(row * photograph.width + column);
      small.rgb.insert(small.rgb.end(), photograph.rgb.begin() + at, photograph.rgb.begin() + at + 3);
    }
  small.valid.assign(small.rgb.size() / 3, 1);
  return small;
}

}  // namespace rebake
