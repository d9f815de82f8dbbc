#include "render/graph/effects.h"

namespace rebake {

namespace {

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  return Decision{facts.plan.kept, facts.why_partial_frame};
}

}  // namespace

const Effect effects::kept_pixels{"kept pixels", Effect::Kind::always, decide};

}  // namespace rebake
