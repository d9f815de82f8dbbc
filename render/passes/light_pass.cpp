#include "render/passes/pass_support.h"

namespace rebake {

namespace {

std::size_t lit_draws(const FramePlan& plan, bool with_offset) {
  std::size_t lit = 0;
  for (const Draw& draw : plan.draws) lit += draw.light && !(with_offset && draw.light->offset.empty()) ? 1 : 0;
  return lit;
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  const std::size_t lit = lit_draws(facts.plan, false);
  if (lit == 0) return Decision{false, "no light changes in view"};
  return Decision{true, "light changes in " + plural(lit, "draw", "draws")};
}

std::optional<Decision> decide_offset(const FrameFacts& facts) {
  if (!facts.any_draw() || lit_draws(facts.plan, false) == 0) return std::nullopt;
  const std::size_t lit = lit_draws(facts.plan, true);
  if (lit == 0) return Decision{false, "factors do: nothing was baked in the dark"};
  return Decision{true, "something baked in the dark is lit in " + plural(lit, "draw", "draws")};
}

}  // namespace

const Effect effects::light{"light", Effect::Kind::colors, decide};
const Effect effects::light_offset{"light in the dark", Effect::Kind::colors, decide_offset};

}  // namespace rebake
