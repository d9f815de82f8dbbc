#pragma once

#include <string>
#include <vector>

namespace rebake {

/// The decision whether a light effect runs, with its reason.
struct LightDecision {
  std::string kind;  ///< such as "cast shadow"
  std::string name;  ///< kind and objects: "cast shadow kettle→ficus"
  bool runs = false;
  double change = 0;       ///< bound of its change in display colours 0 … 1; an estimate if `estimated`
  double seconds = 0;      ///< tracing time if it runs: an equal share of the time of its object
  std::string why;         ///< the reason
  std::string took;        ///< wording of the tracing time if it runs, else empty
  bool estimated = false;  ///< `change` comes from sampled places (ChangeEstimate)
  /// Wording of the reason and the time.
  std::string words() const { return took.empty() ? why : why + ", " + took; }
};

/// Summary for users: running effects first; more than `most` similar decisions of one kind become one line.
std::vector<LightDecision> summarised(const std::vector<LightDecision>& decisions, std::size_t most = 8);

}  // namespace rebake
