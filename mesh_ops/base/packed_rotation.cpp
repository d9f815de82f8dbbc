#include "mesh_ops/base/packed_rotation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rebake {

namespace {

// Bound of the magnitude of all components except the largest.
constexpr double farthest = std::numbers::sqrt2 / 2;
constexpr std::int64_t steps = PackedRotationBits::steps;

}  // namespace

PackedRotation::PackedRotation(const Mat3& orthogonal) {
  const bool mirrors = orthogonal.determinant() < 0;
  const Eigen::Quaterniond q = Eigen::Quaterniond(mirrors ? Mat3(-orthogonal) : orthogonal).normalized();
  const std::array<double, 4> parts{q.w(), q.x(), q.y(), q.z()};
  const auto largest = static_cast<std::size_t>(
      std::max_element(parts.begin(), parts.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      parts.begin());
  const double sign = parts[largest] < 0 ? -1 : 1;
  const std::array<bool, 3> flags{(largest & 1) != 0, (largest & 2) != 0, mirrors};
  PackedRotationBits::Fields fields{};
  for (std::size_t k = 0, field = 0; k < 4; ++k) {
    if (k == largest) continue;
    const double share = std::clamp(sign * parts[k] / farthest, -1.0, 1.0);
    fields[field] = static_cast<std::uint64_t>(std::llround(share * static_cast<double>(steps)) + steps) << 1 |
                    (flags[field] ? 1U : 0U);
    ++field;
  }
  words_ = PackedRotationBits::packed(fields);
}

PackedRotation::PackedRotation(std::span<const std::uint8_t, size> bytes) : words_{} {
  for (std::size_t k = 0; k < size; ++k) words_[k / 4] |= std::uint32_t{bytes[k]} << (8 * (k % 4));
}

std::array<std::uint8_t, PackedRotation::size> PackedRotation::bytes() const {
  std::array<std::uint8_t, size> bytes{};
  for (std::size_t k = 0; k < size; ++k) bytes[k] = static_cast<std::uint8_t>(words_[k / 4] >> (8 * (k % 4)));
  return bytes;
}

PackedRotationBits::Fields PackedRotationBits::unpacked(const Words& words) {
  const auto bits = [&](std::size_t first) {
    // Collects the bits from the two or three words that contain them.
    std::uint64_t value = 0;
    for (std::size_t w = first / 32; w < words.size() && w * 32 < first + field; ++w) {
      const std::uint64_t word = words[w];
      value |= w * 32 >= first ? word << (w * 32 - first) : word >> (first - w * 32);
    }
    return value & ((std::uint64_t{1} << field) - 1);
  };
  return {bits(0), bits(field), bits(2 * field)};
}

Mat3 PackedRotation::matrix() const {
  if (is_identity()) return Mat3::Identity();
  std::array<double, 3> small{};
  std::array<bool, 3> flags{};
  double squares = 0;
  const PackedRotationBits::Fields held = PackedRotationBits::unpacked(words_);
  for (std::size_t k = 0; k < 3; ++k) {
    flags[k] = (held[k] & 1) != 0;
    const std::int64_t whole = std::min(static_cast<std::int64_t>(held[k] >> 1), 2 * steps) - steps;
    small[k] = static_cast<double>(whole) / static_cast<double>(steps) * farthest;
    squares += small[k] * small[k];
  }
  const std::size_t largest = (flags[0] ? 1U : 0U) + (flags[1] ? 2U : 0U);
  std::array<double, 4> parts{};
  parts[largest] = std::sqrt(std::max(0.0, 1 - squares));
  for (std::size_t k = 0, field = 0; k < 4; ++k)
    if (k != largest) parts[k] = small[field++];
  Mat3 matrix = Eigen::Quaterniond(parts[0], parts[1], parts[2], parts[3]).normalized().toRotationMatrix();
  // Snaps to a rotation that permutes the axes if the matrix is within rounding of one.
  if (const Mat3 rounded = matrix.array().round(); (matrix - rounded).cwiseAbs().maxCoeff() < 2e-15) matrix = rounded;
  return flags[2] ? Mat3(-matrix) : matrix;
}

}  // namespace rebake
