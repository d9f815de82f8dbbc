#include <epoxy/gl.h>

#include <algorithm>

#include "render/passes/pass_support.h"

namespace rebake {

namespace {

bool outlined(const FramePlan& plan, const Draw& draw) {
  const std::vector<NodeId>& nodes = plan.guides.outlined;
  return std::find(nodes.begin(), nodes.end(), draw.node) != nodes.end();
}

void execute(const PassInput& input) {
  input.draw_to({Target::mask}, false);
  begin_overlay(input.plan);
  const float nothing[4] = {};
  glClearBufferfv(GL_COLOR, 0, nothing);
  glEnable(GL_BLEND);
  glBlendEquation(GL_MAX);
  const gl::Program& mask = program(input.state, "geometry.vert", "selection_mask.frag", "#define TURNED_MESH 0\n");
  glUseProgram(mask.name());
  bind_scene_depth(input, mask);
  for (const Draw& draw : input.plan.draws)
    if (outlined(input.plan, draw)) draw_set(input, draw, mask);
  glBlendEquation(GL_FUNC_ADD);
  end_geometry();

  input.draw_to({Target::picture}, false);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const gl::Program& line = program(input.state, "fullscreen.vert", "outline.frag", "");
  glUseProgram(line.name());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, input.read(Target::mask));
  set_uniform(line, "mask", 0);
  glBindVertexArray(input.state.empty_array.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
  glDisable(GL_BLEND);
}

std::optional<Decision> decide(const FrameFacts& facts) {
  const FramePlan& plan = facts.plan;
  const auto drawn = static_cast<std::size_t>(
      std::count_if(plan.draws.begin(), plan.draws.end(), [&](const Draw& draw) { return outlined(plan, draw); }));
  if (plan.guides.outlined.empty()) return Decision{false, "no node is picked"};
  if (drawn == 0) return Decision{false, "no picked node is in view"};
  return Decision{true, plural(drawn, "draw is", "draws are") + " of picked nodes"};
}

constexpr Use reads[] = {{Target::depth}, {Target::mask}};
constexpr Use writes[] = {{Target::mask}, {Target::picture}};

}  // namespace

const Effect effects::outline{"outline", Effect::Kind::overlay, decide, execute, reads, writes};

}  // namespace rebake
