#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rebake {

/// What an effect of light changes, judged by places picked at random: no bound.
struct ChangeEstimate {
  /// `margin` times the largest change of a place looked at, in display colours, at most 1.
  double change = 0;
  std::size_t places = 0;  ///< looked at
  std::size_t of = 0;      ///< all

  static constexpr double margin = 2;
  static constexpr double confidence = 0.99;
  /// With that confidence at most this share of all places changes more than the largest one looked at: of a share p
  /// none is met by n picks with probability (1 − p)ⁿ. 0 where all were looked at.
  double share_beyond() const;
  /// "2048 of 9000 places were looked at: with 99 % confidence at most 0.22 % change more than half of that".
  std::string words() const;
};

/// `most` of the places that are not 0, picked at random but always the same (Floyd 1987); all where there are no more.
std::vector<std::size_t> picked_places(const std::vector<std::uint8_t>& places, std::size_t most);

}  // namespace rebake
