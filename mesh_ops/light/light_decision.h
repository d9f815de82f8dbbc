#pragma once

#include <string>
#include <vector>

namespace rebake {

/// Whether an effect of light was worked out, and why.
struct LightDecision {
  std::string kind;  ///< such as "cast shadow"
  std::string name;  ///< the kind and whose: "cast shadow kettle→ficus"
  bool runs = false;
  double change = 0;   ///< what it changes, in display colours 0 … 1: at most, or with `estimated` about
  double seconds = 0;  ///< of tracing, where it runs: its share of its object's
  std::string why;
  std::string took;        ///< where it runs: that time, and what else it was for
  bool estimated = false;  ///< its change, by some places alone (ChangeEstimate)
  /// Why, and how long it took.
  std::string words() const { return took.empty() ? why : why + ", " + took; }
};

/// For people: what runs first, and of more than `most` of one kind that were decided alike one line.
std::vector<LightDecision> summed_up(const std::vector<LightDecision>& decisions, std::size_t most = 8);

}  // namespace rebake
