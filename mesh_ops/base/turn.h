#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "mesh_ops/base/types.h"

namespace rebake {

/// How a Turn lies in its bytes: three fields of 53 bits, in each a flag, and above it a part as steps from −√½ to √½.
struct TurnBits {
  using Words = std::array<std::uint32_t, 5>;
  using Fields = std::array<std::uint64_t, 3>;
  static constexpr std::size_t field = 53;
  static constexpr std::int64_t steps = (std::int64_t{1} << 51) - 1;  ///< from 0 to √½

  static constexpr Words packed(const Fields& fields) {
    Words words{};
    for (std::size_t bit = 0; bit < 3 * field; ++bit)
      if ((fields[bit / field] >> (bit % field) & 1) != 0) words[bit / 32] |= std::uint32_t{1} << (bit % 32);
    return words;
  }
  static Fields unpacked(const Words& words);
};

/// An orthogonal matrix in 20 bytes: a unit quaternion by its three smaller parts in 52 bits each, which of the four is
/// the largest, and whether the matrix mirrors: whether it is −1 times a rotation. Within 2e-15 of the matrix it was
/// made of,
/// where that is orthogonal; what maps axes onto axes (identity, quarter turns, mirrors) is exact.
class Turn {
 public:
  static constexpr std::size_t size = 20;

  Turn() = default;  ///< identity
  /// `orthogonal` within 1e-6; finite.
  explicit Turn(const Mat3& orthogonal);
  /// Of bytes(); all values of them are turns.
  explicit Turn(std::span<const std::uint8_t, size> bytes);

  Mat3 matrix() const;
  std::array<std::uint8_t, size> bytes() const;  ///< the same on every machine
  bool is_identity() const { return *this == Turn(); }
  bool operator==(const Turn&) const = default;

 private:
  static constexpr TurnBits::Words identity =
      TurnBits::packed({2 * TurnBits::steps, 2 * TurnBits::steps, 2 * TurnBits::steps});

  TurnBits::Words words_ = identity;
};

}  // namespace rebake
