#include "mesh_ops/base/counted.h"
#include "render/graph/effects.h"

namespace rebake {

namespace {

std::optional<Decision> decide(const FrameFacts& facts) {
  const std::string in_object = "clusters of triangles out of view are culled";
  if (facts.culled > 0)
    return Decision{true, counted(facts.culled, "object is", "objects are") + " out of view and not drawn" +
                              (facts.any_draw() ? "; of the others, " + in_object : "")};
  if (facts.any_draw()) return Decision{true, in_object};
  return Decision{false, "no object is shown"};
}

std::optional<Decision> decide_hidden(const FrameFacts& facts) {
  if (facts.hidden == 0) return std::nullopt;
  return Decision{false, counted(facts.hidden, "is", "are") + " hidden by an edit"};
}

}  // namespace

const Effect effects::culling{"culling", Effect::Kind::always, decide};
const Effect effects::hidden_objects{"hidden objects", Effect::Kind::always, decide_hidden};

}  // namespace rebake
