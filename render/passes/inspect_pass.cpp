#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/passes/pass_support.h"

namespace rebake {

namespace {

// Distinct hues for consecutive numbers, by the golden angle.
glm::vec3 color_of(std::size_t number) {
  const double hue = std::fmod(static_cast<double>(number) * 0.381966, 1.0) * 6;
  const auto channel = [&](double offset) {
    return static_cast<float>(0.35 + 0.6 * std::clamp(std::abs(std::fmod(hue + offset, 6.0) - 3) - 1, 0.0, 1.0));
  };
  return {channel(0), channel(4), channel(2)};
}

void execute(const PassInput& input) {
  const Guides& guides = input.plan.guides;
  input.draw_to({Target::picture}, true);
  begin_geometry(input.plan, 1);
  begin_clear(input.plan);
  clear_depth();
  end_clear();
  if (guides.inspect == Guides::Inspect::wireframe) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  if (guides.inspect == Guides::Inspect::overdraw) {
    const float black[4] = {0, 0, 0, 1};
    glDisable(GL_SCISSOR_TEST);
    glClearBufferfv(GL_COLOR, 0, black);
    glEnable(GL_SCISSOR_TEST);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
  }
  for (const Draw& draw : input.plan.draws) {
    const gl::Program& shader =
        program(input.state, "geometry.vert", "inspect.frag",
                fmt::format("#define TURNED_MESH 0\n#define LIT_MESH 0\n#define GLOSSY_MESH 0\n#define INSPECT {}\n",
                            static_cast<int>(guides.inspect)) +
                    texel_preamble(input, draw));
    glUseProgram(shader.name());
    set_uniform(shader, "channel", guides.channel);
    set_uniform(shader, "set_color", color_of(static_cast<std::size_t>(draw.node) + draw.first_triangle));
    draw_set(input, draw, shader);
  }
  glDisable(GL_BLEND);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  end_geometry();
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (facts.plan.guides.inspect == Guides::Inspect::none) return Decision{false, "the view shows colours"};
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  return Decision{true, "a debug view is on"};
}

constexpr Use writes[] = {{Target::picture}, {Target::depth}};

}  // namespace

const Effect effects::inspect{"inspect", Effect::Kind::overlay, decide, execute, {}, writes};

}  // namespace rebake
