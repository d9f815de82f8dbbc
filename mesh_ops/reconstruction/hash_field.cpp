#include "mesh_ops/reconstruction/hash_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace rebake {

namespace {

constexpr std::size_t points_per_task = 256;

FeatureNetwork start_network(std::size_t output_count, const HashFieldOptions& options, std::uint64_t seed) {
  FeatureNetwork network(2 * options.levels, options.hidden, options.hidden, output_count);
  randomise(network, seed);
  // The biases of the outputs, each followed by its weights.
  for (std::size_t o = 0; o < output_count; ++o)
    network.values[network.values.size() - (output_count - o) * (options.hidden + 1)] = options.bias;
  return network;
}

}  // namespace

HashField::HashField(std::size_t output_count, const HashFieldOptions& options, std::uint64_t seed)
    : grid_rate_(options.grid_rate), network_(start_network(output_count, options, seed)), table_steps_(0) {
  const std::size_t most = std::size_t{1} << options.log2_entries;
  for (std::size_t k = 0; k < options.levels; ++k) {
    const double place = options.levels < 2 ? 0 : static_cast<double>(k) / static_cast<double>(options.levels - 1);
    Level level{};
    level.side = static_cast<std::uint32_t>(
        std::lround(options.coarsest * std::pow(static_cast<double>(options.finest) / options.coarsest, place)));
    const std::uint64_t corners = std::uint64_t{level.side + 1} * (level.side + 1) * (level.side + 1);
    level.hashed = corners > most;
    level.entries = static_cast<std::uint32_t>(std::min<std::uint64_t>(corners, most));
    level.first = table_.size();
    table_.resize(table_.size() + 2 * std::size_t{level.entries});
    levels_.push_back(level);
  }
  SplitMix64 dice(seed + 1);
  for (float& value : table_) value = static_cast<float>((2 * dice.share() - 1) * 1e-4);
  table_gradient_.resize(table_.size());
  table_steps_ = GradientSteps(table_.size());
}

HashField::Corners HashField::corners_of(const Level& level, const FieldPoint& point) {
  Corners corners{};
  std::array<std::uint32_t, 3> cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float place = std::clamp(point[axis], 0.0F, 1.0F) * static_cast<float>(level.side);
    cell[axis] = std::min(static_cast<std::uint32_t>(place), level.side - 1);
    corners.share[axis] = place - static_cast<float>(cell[axis]);
  }
  const std::uint32_t row = level.side + 1;
  for (std::uint32_t k = 0; k < 8; ++k) {
    const std::uint32_t x = cell[0] + (k & 1), y = cell[1] + (k >> 1 & 1), z = cell[2] + (k >> 2);
    // Primes of the authors' code.
    const std::uint32_t entry =
        level.hashed ? (x ^ (y * 2654435761U) ^ (z * 805459861U)) & (level.entries - 1) : (z * row + y) * row + x;
    corners.at[k] = 2 * entry;
  }
  return corners;
}

namespace {

// Trilinear weights of the eight corners of a cell.
std::array<float, 8> weights_of(const std::array<float, 3>& share) {
  std::array<float, 8> weights{};
  for (std::size_t k = 0; k < 8; ++k)
    weights[k] = ((k & 1) != 0 ? share[0] : 1 - share[0]) * ((k >> 1 & 1) != 0 ? share[1] : 1 - share[1]) *
                 ((k >> 2) != 0 ? share[2] : 1 - share[2]);
  return weights;
}

}  // namespace

void HashField::encode(const std::vector<FieldPoint>& points, std::vector<float>& inputs) const {
  const std::size_t width = 2 * levels_.size();
  inputs.resize(points.size() * width);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), points_per_task), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p)
      for (std::size_t k = 0; k < levels_.size(); ++k) {
        const float* numbers = table_.data() + levels_[k].first;
        const Corners corners = corners_of(levels_[k], points[p]);
        const std::array<float, 8> weights = weights_of(corners.share);
        float first = 0, second = 0;
        for (std::size_t c = 0; c < 8; ++c) {
          first += weights[c] * numbers[corners.at[c]];
          second += weights[c] * numbers[corners.at[c] + 1];
        }
        inputs[p * width + 2 * k] = first;
        inputs[p * width + 2 * k + 1] = second;
      }
  });
}

void HashField::evaluate(const std::vector<FieldPoint>& points, std::vector<float>& values) const {
  std::vector<float> inputs;
  encode(points, inputs);
  network_.evaluate(inputs, values);
}

FieldPoint HashField::point_slope(const FieldPoint& point, const float* input_slopes) const {
  FieldPoint slope{};
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const float* numbers = table_.data() + levels_[k].first;
    const Corners corners = corners_of(levels_[k], point);
    std::array<float, 8> value{};
    for (std::size_t c = 0; c < 8; ++c)
      value[c] = input_slopes[2 * k] * numbers[corners.at[c]] + input_slopes[2 * k + 1] * numbers[corners.at[c] + 1];
    const auto& [x, y, z] = corners.share;
    const auto side = static_cast<float>(levels_[k].side);
    const auto mix = [](float a, float b, float share) { return a + share * (b - a); };
    slope[0] += side * mix(mix(value[1] - value[0], value[3] - value[2], y),
                           mix(value[5] - value[4], value[7] - value[6], y), z);
    slope[1] += side * mix(mix(value[2] - value[0], value[3] - value[1], x),
                           mix(value[6] - value[4], value[7] - value[5], x), z);
    slope[2] += side * mix(mix(value[4] - value[0], value[5] - value[1], x),
                           mix(value[6] - value[2], value[7] - value[3], x), y);
  }
  return slope;
}

void HashField::backpropagate(const std::vector<FieldPoint>& points, const std::vector<float>& slopes,
                              std::vector<FieldPoint>* point_slopes) {
  std::vector<float> inputs, input_slopes;
  encode(points, inputs);
  network_.backpropagate(inputs, slopes, &input_slopes);
  const std::size_t width = 2 * levels_.size();
  if (point_slopes != nullptr) {
    point_slopes->resize(points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), points_per_task), [&](const auto& range) {
      for (std::size_t p = range.begin(); p < range.end(); ++p)
        (*point_slopes)[p] = point_slope(points[p], &input_slopes[p * width]);
    });
  }
  // Levels are independent, so each is one task, which adds in the order of the points.
  tbb::parallel_for(std::size_t{0}, levels_.size(), [&](std::size_t k) {
    float* numbers = table_gradient_.data() + levels_[k].first;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const float first = input_slopes[p * width + 2 * k], second = input_slopes[p * width + 2 * k + 1];
      if (first == 0 && second == 0) continue;
      const Corners corners = corners_of(levels_[k], points[p]);
      const std::array<float, 8> weights = weights_of(corners.share);
      for (std::size_t c = 0; c < 8; ++c) {
        numbers[corners.at[c]] += weights[c] * first;
        numbers[corners.at[c] + 1] += weights[c] * second;
      }
    }
  });
}

void HashField::step(double rate) {
  table_steps_.step(table_, table_gradient_, grid_rate_ * rate, false);
  network_.step(rate);
}

void HashField::reset_optimiser() {
  table_steps_.reset();
  network_.reset_optimiser();
}

void HashField::save(std::string& bytes) const {
  put_numbers(bytes, table_);
  table_steps_.save(bytes);
  network_.save(bytes);
}

void HashField::load(std::string_view& bytes) {
  take_numbers(bytes, table_);
  table_steps_.load(bytes);
  network_.load(bytes);
}

}  // namespace rebake
