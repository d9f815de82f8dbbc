#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rebake {

/// Estimate (not a bound) of the change of colours by a light effect, from randomly sampled places.
struct ChangeEstimate {
  /// `margin` times the largest sampled change, in display colours, at most 1.
  double change = 0;
  std::size_t places = 0;  ///< number of sampled places
  std::size_t of = 0;      ///< total number of places

  static constexpr double margin = 2;
  static constexpr double confidence = 0.99;
  /// With this confidence, at most this share of all places changes more than the largest sampled change: n samples
  /// miss a share p with probability (1 − p)ⁿ. 0 if all places were sampled.
  double share_beyond() const;
  /// Wording for users: number of samples, confidence and share_beyond().
  std::string words() const;
};

/// Indices of up to `most` of the non-zero places, sampled with a fixed seed (Floyd 1987); all of them if there are
/// fewer.
std::vector<std::size_t> sample_places(const std::vector<std::uint8_t>& places, std::size_t most);

}  // namespace rebake
