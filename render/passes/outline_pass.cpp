#include <algorithm>

#include "mesh_ops/base/counted.h"
#include "render/passes/pass_support.h"

namespace rebake {

namespace {

bool outlined(const FramePlan& plan, const Draw& draw) {
  const std::vector<NodeId>& nodes = plan.guides.outlined;
  return std::find(nodes.begin(), nodes.end(), draw.node) != nodes.end();
}

void execute(const PassInput& input) {
  begin_mask(input);
  for (const Draw& draw : input.plan.draws)
    if (outlined(input.plan, draw)) draw_set(input, draw, use_mask(input, draw));
  end_mask();
  draw_by_mask(input, "outline.frag");
}

std::optional<Decision> decide(const FrameFacts& facts) {
  const FramePlan& plan = facts.plan;
  const auto drawn = static_cast<std::size_t>(
      std::count_if(plan.draws.begin(), plan.draws.end(), [&](const Draw& draw) { return outlined(plan, draw); }));
  if (plan.guides.outlined.empty()) return Decision{false, "no node is picked"};
  if (drawn == 0) return Decision{false, "no picked node is in view"};
  return Decision{true, counted(drawn, "draw is", "draws are") + " of picked nodes"};
}

constexpr Use reads[] = {{Target::depth}, {Target::mask}};
constexpr Use writes[] = {{Target::mask}, {Target::picture}};

}  // namespace

const Effect effects::outline{"outline", Effect::Kind::overlay, decide, execute, reads, writes};

}  // namespace rebake
