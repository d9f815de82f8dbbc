#pragma once

#include <string>
#include <vector>

namespace rebake {

/// The decision whether a light effect runs, with its reason.
struct LightDecision {
  std::string kind;  ///< such as "cast shadow"
  std::string name;  ///< kind and objects: "cast shadow kettle→ficus"
  bool runs = false;
  double change = 0;   ///< bound of its change in display colours 0 … 1; an estimate if `estimated`
  double seconds = 0;  ///< tracing time if it runs: its share of the time of its object
  std::string why;
  std::string took;        ///< wording of that time if it runs, and of other uses of it
  bool estimated = false;  ///< `change` comes from sampled places (ChangeEstimate)
  /// Reason and time.
  std::string words() const { return took.empty() ? why : why + ", " + took; }
};

/// Summary for people: running effects first; more than `most` equal decisions of one kind become one line.
std::vector<LightDecision> summed_up(const std::vector<LightDecision>& decisions, std::size_t most = 8);

}  // namespace rebake
