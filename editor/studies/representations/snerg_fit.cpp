#include "editor/studies/representations/snerg_fit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "editor/studies/representations/cell_adam.h"
#include "editor/studies/representations/snerg_network.h"
#include "editor/studies/representations/snerg_pack.h"
#include "editor/studies/representations/voxel_cells.h"

namespace rebake {

namespace {

constexpr float darkest = 1.0F / 255;  // light at which a ray ends
constexpr int margin = 2;
using Values = SnergValues;

// A sample of a ray: corners of the cell around it, and interpolated values.
struct Sample {
  std::array<std::int32_t, 8> corner;
  std::array<float, 8> weight;
  Values value;
  float light;  // that reaches it
};

class Fit {
 public:
  Fit(const TruthRays& rays, int resolution)
      : rays_(rays),
        cells_(cells_around(rays.hits, resolution, margin, false)),
        adam_(cells_.count(), std::vector<float>(snerg_channels, 0.01F)),
        most_seen_(cells_.count(), 0) {
    const std::vector<std::array<float, 3>> colors = mean_colors(cells_, rays.hits, rays.hit_colors);
    std::mt19937 random(1);
    for (std::size_t cell = 0; cell < cells_.count(); ++cell) {
      const bool surface = cells_.surface[cell] != 0;
      float* value = adam_.values(cell);
      for (std::size_t c = 0; c < snerg_channels; ++c)
        value[c] = c == snerg_alpha ? (surface ? 0.5F : 0.05F)
                   : c < 3          ? (surface ? 0.5F : 0.05F) * colors[cell][c]
                                    : (surface ? 0.25F : 0.025F) * static_cast<float>(random() % 1024) / 1024;
    }
  }

  void pass(int number, const Progress& progress) {
    const std::size_t batch = batch_size(rays_.rays.size());
    for (std::size_t begin = 0; begin < rays_.rays.size(); begin += batch) {
      progress.at("fitting a SNeRG grid", static_cast<double>(begin) / static_cast<double>(rays_.rays.size()));
      const std::size_t end = std::min(begin + batch, rays_.rays.size());
      const std::size_t per_lane = (end - begin + CellAdam::lanes - 1) / CellAdam::lanes;
      tbb::parallel_for(std::size_t{0}, CellAdam::lanes, [&](std::size_t lane) {
        std::vector<Sample> samples;
        for (std::size_t k = begin + lane * per_lane; k < std::min(end, begin + (lane + 1) * per_lane); ++k)
          learn(rays_.rays[k], lane, samples);
      });
      const double rate = fit_rate(number + static_cast<double>(begin) / static_cast<double>(rays_.rays.size()));
      adam_.step(end - begin, rate, [](float* values) {
        // Premultiplied values are at most the opacity.
        values[snerg_alpha] = std::clamp(values[snerg_alpha], 0.0F, 1.0F);
        for (std::size_t c = 0; c < snerg_alpha; ++c) values[c] = std::clamp(values[c], 0.0F, values[snerg_alpha]);
      });
      network_.step(end - begin, rate);
    }
  }

  // The published form, whose network is tuned to the quantised grid, as the paper's is.
  SnergScene packed(int passes, const Progress& progress) {
    most_seen_.assign(cells_.count(), 0);
    mark_seen();
    std::vector<Values> exact(cells_.count());
    for (std::size_t cell = 0; cell < cells_.count(); ++cell) {
      float* value = adam_.values(cell);
      std::copy_n(value, snerg_channels, exact[cell].begin());
      for (std::size_t c = 0; c < snerg_channels; ++c)
        value[c] = most_seen_[cell] >= least_seen ? std::round(value[c] * 255) / 255 : 0;
    }
    const SnergNetwork tuned = tuned_network(passes, progress);
    SnergScene scene = pack_snerg(
        cells_, [&](std::size_t cell) { return most_seen_[cell] >= least_seen ? adam_.values(cell) : nullptr; },
        tuned.decoder());
    for (std::size_t cell = 0; cell < cells_.count(); ++cell)
      std::copy_n(exact[cell].begin(), snerg_channels, adam_.values(cell));
    return scene;
  }

  // The state between two passes.
  std::string save() const {
    std::string bytes;
    adam_.save(bytes);
    network_.save(bytes);
    return bytes;
  }
  void load(std::string_view bytes) {
    adam_.load(bytes);
    network_.load(bytes);
  }

 private:
  static constexpr float least_seen = 0.005F;  // the paper's threshold of visibility

  // The samples of a ray, in steps of one voxel, as the published viewer takes them.
  float march(const TruthRay& ray, std::vector<Sample>& samples) const {
    samples.clear();
    const Eigen::Vector3f origin = (ray.origin - cells_.min.cast<float>()) / static_cast<float>(cells_.voxel);
    const Eigen::Vector3f inverse = ray.direction.cwiseInverse();
    const auto range = [&](const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
      const Eigen::Vector3f a = (low - origin).cwiseProduct(inverse), b = (high - origin).cwiseProduct(inverse);
      return std::pair{a.cwiseMin(b).maxCoeff(), a.cwiseMax(b).minCoeff()};
    };
    const Eigen::Vector3f size(static_cast<float>(cells_.size[0]), static_cast<float>(cells_.size[1]),
                               static_cast<float>(cells_.size[2]));
    const auto [enter, leave] = range(Eigen::Vector3f::Zero(), size);
    float light = 1;
    const auto blocks = cells_.blocks();
    for (float t = std::max(0.0F, enter) + 0.5F; t < leave && light > darkest;) {
      const Eigen::Vector3f at = origin + t * ray.direction;
      std::array<int, 3> block{};
      for (std::size_t a = 0; a < 3; ++a)
        block[a] = std::clamp(static_cast<int>(at[static_cast<Eigen::Index>(a)]) / VoxelCells::block, 0, blocks[a] - 1);
      if (cells_.block_used[static_cast<std::size_t>((block[2] * blocks[1] + block[1]) * blocks[0] + block[0])] == 0) {
        const Eigen::Vector3f low =
            static_cast<float>(VoxelCells::block) *
            Eigen::Vector3f(static_cast<float>(block[0]), static_cast<float>(block[1]), static_cast<float>(block[2]));
        t = 0.5F + std::max(t, range(low, low.array() + static_cast<float>(VoxelCells::block)).second);
        continue;
      }
      Sample sample;
      if (interpolate(at, sample)) {
        sample.light = light;
        light *= 1 - sample.value[snerg_alpha];
        samples.push_back(sample);
      }
      t += 1;
    }
    return light;
  }

  // Trilinear interpolation; false if all corners are empty.
  bool interpolate(const Eigen::Vector3f& at, Sample& sample) const {
    const Eigen::Vector3f shifted = at.array() - 0.5F, floor = shifted.array().floor(), f = shifted - floor;
    const int x = static_cast<int>(floor.x()), y = static_cast<int>(floor.y()), z = static_cast<int>(floor.z());
    bool any = false;
    for (std::size_t k = 0; k < 8; ++k) {
      const bool right = (k & 1) != 0, up = (k & 2) != 0, back = (k & 4) != 0;
      sample.corner[k] = cells_.number_at(x + right, y + up, z + back);
      sample.weight[k] = (right ? f.x() : 1 - f.x()) * (up ? f.y() : 1 - f.y()) * (back ? f.z() : 1 - f.z());
      any = any || sample.corner[k] >= 0;
    }
    if (!any) return false;
    Values sums{};  // local, so that compilers vectorise the inner loop
    for (std::size_t k = 0; k < 8; ++k) {
      if (sample.corner[k] < 0) continue;
      const float weight = sample.weight[k];
      const float* value = adam_.values(static_cast<std::size_t>(sample.corner[k]));
      for (std::size_t c = 0; c < snerg_channels; ++c) sums[c] += weight * value[c];
    }
    sample.value = sums;
    return true;
  }

  // Colour over white, and features, of a ray's samples. `rest`: light that is left.
  static std::array<float, 7> sum_of(const std::vector<Sample>& samples, float rest) {
    std::array<float, 7> sum{};
    for (const Sample& sample : samples)
      for (std::size_t c = 0; c < 7; ++c) sum[c] += sample.light * sample.value[c];
    for (std::size_t c = 0; c < 3; ++c) sum[c] += rest;
    return sum;
  }

  // Gradient of a ray's squared error by its colour.
  static std::array<float, 3> error_of(const TruthRay& ray, const std::array<float, 7>& sum,
                                       const std::array<float, 3>& added) {
    std::array<float, 3> error{};
    for (std::size_t c = 0; c < 3; ++c) {
      error[c] = 2 * (sum[c] + added[c] - ray.color[c]);
      if (ray.color[c] >= 1) error[c] = std::min(error[c], 0.0F);  // colours are clamped
    }
    return error;
  }

  // The network after two more passes with the grid as it is.
  SnergNetwork tuned_network(int passes, const Progress& progress) const {
    constexpr int tuning_passes = 2;
    const std::size_t count = rays_.rays.size(), batch = batch_size(count);
    // Rays that meet nothing have no light to lose.
    std::vector<std::pair<std::array<float, 7>, float>> sums(count);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count), [&](const tbb::blocked_range<std::size_t>& range) {
      std::vector<Sample> samples;
      for (std::size_t k = range.begin(); k < range.end(); ++k) {
        const float rest = march(rays_.rays[k], samples);
        sums[k] = {sum_of(samples, rest), rest};
      }
    });
    SnergNetwork network = network_;
    for (std::size_t first = 0; first < tuning_passes * count; first += batch) {
      const double done = static_cast<double>(first) / static_cast<double>(tuning_passes * count);
      progress.at("tuning the network of a SNeRG grid", done);
      const std::size_t per_lane = (batch + CellAdam::lanes - 1) / CellAdam::lanes;
      tbb::parallel_for(std::size_t{0}, CellAdam::lanes, [&](std::size_t lane) {
        SnergNetwork::Pass pass;
        for (std::size_t k = first + lane * per_lane; k < first + std::min(batch, (lane + 1) * per_lane); ++k) {
          const auto& [sum, rest] = sums[k % count];
          const TruthRay& ray = rays_.rays[k % count];
          if (rest > 1 - darkest) continue;
          const std::array<float, 3> added = network.forward(ray.direction, sum, pass);
          network.backward(lane, pass, error_of(ray, sum, added));
        }
      });
      network.step(batch, std::pow(10, -done) / std::sqrt(1.0 + passes));
    }
    return network;
  }

  // Adds the gradient of a ray's squared error.
  void learn(const TruthRay& ray, std::size_t lane, std::vector<Sample>& samples) {
    const float rest = march(ray, samples);
    if (samples.empty()) return;
    const std::array<float, 7> sum = sum_of(samples, rest);
    SnergNetwork::Pass pass;
    const bool decodes = rest <= 1 - darkest;  // as the viewer does
    const std::array<float, 3> added = decodes ? network_.forward(ray.direction, sum, pass) : std::array<float, 3>{};
    const std::array<float, 3> error = error_of(ray, sum, added);
    std::array<float, 7> slope = decodes ? network_.backward(lane, pass, error) : std::array<float, 7>{};
    for (std::size_t c = 0; c < 3; ++c) slope[c] += error[c];
    // What light that passes a sample adds to the loss, from the last sample on.
    float behind = slope[0] + slope[1] + slope[2];
    for (auto sample = samples.rbegin(); sample != samples.rend(); ++sample) {
      float own = 0;
      for (std::size_t c = 0; c < 7; ++c) own += slope[c] * sample->value[c];
      Values by_value;
      std::copy(slope.begin(), slope.end(), by_value.begin());
      by_value[snerg_alpha] = -behind;
      for (std::size_t k = 0; k < 8; ++k) {
        if (sample->corner[k] < 0) continue;
        float* gradient = adam_.gradient(lane, static_cast<std::size_t>(sample->corner[k]));
        const float share = sample->weight[k] * sample->light;
        for (std::size_t c = 0; c < snerg_channels; ++c) gradient[c] += share * by_value[c];
      }
      behind = own + (1 - sample->value[snerg_alpha]) * behind;
    }
  }

  // The largest share of a ray's light that each cell contributes.
  void mark_seen() {
    std::array<std::vector<float>, CellAdam::lanes> seen;
    const std::size_t per_lane = (rays_.rays.size() + CellAdam::lanes - 1) / CellAdam::lanes;
    tbb::parallel_for(std::size_t{0}, CellAdam::lanes, [&](std::size_t lane) {
      seen[lane].assign(cells_.count(), 0);
      std::vector<Sample> samples;
      for (std::size_t k = lane * per_lane; k < std::min(rays_.rays.size(), (lane + 1) * per_lane); ++k) {
        march(rays_.rays[k], samples);
        for (const Sample& sample : samples)
          for (std::size_t c = 0; c < 8; ++c)
            if (sample.corner[c] >= 0) {
              float& most = seen[lane][static_cast<std::size_t>(sample.corner[c])];
              most = std::max(most, sample.light * sample.value[snerg_alpha]);
            }
      }
    });
    for (const auto& lane : seen)
      for (std::size_t cell = 0; cell < lane.size(); ++cell) most_seen_[cell] = std::max(most_seen_[cell], lane[cell]);
  }

  const TruthRays& rays_;
  VoxelCells cells_;
  CellAdam adam_;
  SnergNetwork network_;
  std::vector<float> most_seen_;
};

}  // namespace

SnergScene fit_snerg(const TruthRays& rays, int resolution, const std::function<bool(int, const SnergScene&)>& goes_on,
                     const Progress& progress, const FitCheckpoints& checkpoints) {
  Fit fit(rays, resolution);
  return run_fit(fit, goes_on, progress, checkpoints);
}

}  // namespace rebake
