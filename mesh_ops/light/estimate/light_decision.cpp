#include "mesh_ops/light/estimate/light_decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace rebake {

std::vector<LightDecision> summarised(const std::vector<LightDecision>& decisions, std::size_t most) {
  // Decisions with a bound or an estimate are grouped regardless of their wording, which contains it.
  const auto reason = [](const LightDecision& one) {
    return std::tuple(!one.runs, one.kind, one.change > 0 ? std::string() : one.why);
  };
  std::map<decltype(reason(decisions.front())), std::vector<const LightDecision*>> alike;
  for (const LightDecision& one : decisions) alike[reason(one)].push_back(&one);
  std::vector<LightDecision> result;
  for (const LightDecision& one : decisions) {
    const std::vector<const LightDecision*>& those = alike[reason(one)];
    if (those.size() <= most) {
      result.push_back(one);
      continue;
    }
    if (&one != those.front()) continue;
    LightDecision sum{one.kind, fmt::format("{} {}{}", those.size(), one.kind, one.kind.ends_with('s') ? "" : "s"),
                      one.runs, 0,
                      0,        one.why,
                      "",       one.estimated};
    double changes = 0;
    const LightDecision* largest = those.front();
    for (const LightDecision* other : those) {
      if (other->change > largest->change) largest = other;
      changes += other->change;
      sum.seconds += other->seconds;
    }
    sum.change = largest->change;
    if (one.runs && one.change > 0)
      sum.why = fmt::format("{} changes most, by {} {:.3g} of 255", largest->name,
                            largest->estimated ? "about" : "up to", largest->change * 255);
    else if (one.change > 0)
      sum.why = fmt::format("{} {:.3g} of 255 each, {:.3g} together", one.estimated ? "about" : "up to",
                            largest->change * 255, changes * 255);
    if (sum.seconds > 0) sum.took = fmt::format("took {:.2f} s", sum.seconds);
    result.push_back(std::move(sum));
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const LightDecision& a, const LightDecision& b) { return a.runs && !b.runs; });
  return result;
}

}  // namespace rebake
