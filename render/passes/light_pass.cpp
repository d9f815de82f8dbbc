#include "mesh_ops/base/counted.h"
#include "render/passes/pass_support.h"

namespace rebake {

namespace {

std::size_t lit_draws(const FramePlan& plan, bool (*counts)(const LightMap&)) {
  std::size_t lit = 0;
  for (const Draw& draw : plan.draws) lit += draw.light && counts(*draw.light) ? 1 : 0;
  return lit;
}
std::size_t lit_draws(const FramePlan& plan) {
  return lit_draws(plan, [](const LightMap&) { return true; });
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  const std::size_t lit = lit_draws(facts.plan);
  if (lit == 0) return Decision{false, "no light changes in view"};
  return Decision{true, "light changes in " + counted(lit, "draw")};
}

std::optional<Decision> decide_offset(const FrameFacts& facts) {
  if (!facts.any_draw() || lit_draws(facts.plan) == 0) return std::nullopt;
  const std::size_t dark = lit_draws(facts.plan, [](const LightMap&map) { return !map.offset.empty(); }),
                    glossy = lit_draws(facts.plan, [](const LightMap&map) { return map.gloss != nullptr; });
  if (dark > 0) return Decision{true, "surfaces baked in the dark are lit in " + counted(dark, "draw")};
  if (glossy > 0) return Decision{true, "highlights need an additive term"};
  return Decision{false, "gains suffice: nothing was baked in the dark"};
}

std::optional<Decision> decide_highlights(const FrameFacts& facts) {
  if (!facts.any_draw() || lit_draws(facts.plan) == 0) return std::nullopt;
  const std::size_t glossy = lit_draws(facts.plan, [](const LightMap& map) { return map.gloss != nullptr; });
  if (glossy == 0) return Decision{false, "no rotated surface is specular"};
  return Decision{true, "specular reflections rotate in " + counted(glossy, "draw")};
}

}  // namespace

const Effect effects::light{"light", Effect::Kind::colors, decide};
const Effect effects::light_offset{"light added", Effect::Kind::colors, decide_offset};
const Effect effects::highlights{"highlights", Effect::Kind::colors, decide_highlights};

}  // namespace rebake
