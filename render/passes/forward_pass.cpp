#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/passes/occlusion.h"

namespace rebake {

namespace {

void execute(const PassInput& input) {
  const FramePlan& plan = input.plan;
  input.draw_to({Target::picture}, true);
  begin_geometry(plan, 1);
  const std::string decoder = decoder_preamble(input);
  const auto use = [&](const Draw& draw) -> const gl::Program& {
    const DecodeFrame& frame = plan.frames[draw.frame];
    const gl::Program& shader =
        program(input.state, "geometry.vert", "forward.frag",
                fmt::format("#define TURNED_MESH {}\n", draw.set.soup.rotations() != nullptr ? 1 : 0) +
                    light_preamble(draw) + texel_preamble(input, draw) + decoder);
    glUseProgram(shader.name());
    set_uniform(shader, "camera_to_fed", to_glm(camera_to_fed(plan, frame)));
    set_uniform(shader, "alpha_code", alpha_factors(frame.alpha_code));
    set_uniform(shader, "decoder", static_cast<int>(frame.decoder));
    set_ray_uniforms(shader, plan.view, 1);
    bind_decoders(input, shader);
    return shader;
  };
  // Clears depth only: drawing again overwrites all colours that were drawn before.
  draw_sets(input, use, [&] {
    begin_clear(plan);
    clear_depth();
    end_clear();
  });
  end_geometry();
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (facts.forward()) return Decision{true, describe_draws(facts.plan) + "; " + describe_decoder(facts.plan)};
  return Decision{false, facts.plan.view.samples > 1
                             ? "features are averaged over a pixel's samples before they are decoded"
                             : "deferred shading decodes each pixel once"};
}

constexpr Use writes[] = {{Target::picture}, {Target::depth}};

}  // namespace

const Effect effects::forward{"forward", Effect::Kind::colors, decide, execute, {}, writes};

}  // namespace rebake
