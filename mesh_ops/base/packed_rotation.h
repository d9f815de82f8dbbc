#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Bit layout of a PackedRotation: three fields of 53 bits. Bit 0 of a field is a flag; the bits above it are a
/// quaternion component, as a number of steps from −√½.
struct PackedRotationBits {
  using Words = std::array<std::uint32_t, 5>;
  using Fields = std::array<std::uint64_t, 3>;
  static constexpr std::size_t field = 53;                            ///< bits per field
  static constexpr std::int64_t steps = (std::int64_t{1} << 51) - 1;  ///< number of steps from 0 to √½

  static constexpr Words packed(const Fields& fields) {
    Words words{};
    for (std::size_t bit = 0; bit < 3 * field; ++bit)
      if ((fields[bit / field] >> (bit % field) & 1) != 0) words[bit / 32] |= std::uint32_t{1} << (bit % 32);
    return words;
  }
  static Fields unpacked(const Words& words);
};

/// A 3 × 3 orthogonal matrix in 20 bytes: the three smaller components of a unit quaternion in 52 bits each, the index
/// of the largest, and a flag for a reflection (the matrix is −1 times a rotation). Error at most 2e-15 for an
/// orthogonal matrix. Matrices that permute the axes, up to sign, are exact (identity, quarter turns, mirrors).
class PackedRotation {
 public:
  static constexpr std::size_t size = 20;

  PackedRotation() = default;  ///< identity
  /// `orthogonal` must be finite, and orthogonal within 1e-6.
  explicit PackedRotation(const Mat3& orthogonal);
  /// Inverse of bytes(); every sequence of bytes is valid.
  explicit PackedRotation(std::span<const std::uint8_t, size> bytes);

  Mat3 matrix() const;
  std::array<std::uint8_t, size> bytes() const;  ///< little-endian; the same on every machine
  bool is_identity() const { return *this == PackedRotation(); }
  bool operator==(const PackedRotation&) const = default;

 private:
  static constexpr PackedRotationBits::Words identity = PackedRotationBits::packed(
      {2 * PackedRotationBits::steps, 2 * PackedRotationBits::steps, 2 * PackedRotationBits::steps});

  PackedRotationBits::Words words_ = identity;
};

}  // namespace rebake
