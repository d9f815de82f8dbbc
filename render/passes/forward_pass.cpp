#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/passes/pass_support.h"

namespace rebake {

void execute_forward(const PassInput& input) {
  const FramePlan& plan = input.plan;
  glBindFramebuffer(GL_FRAMEBUFFER, input.state.targets.picture_buffer.name());
  begin_geometry(plan, 1);
  const std::string decoder = decoder_preamble(input);
  for (const Draw& draw : plan.draws) {
    const NodeFrame& frame = plan.frames[draw.frame];
    const gl::Program& shader =
        program(input.state, "geometry.vert", "forward.frag",
                fmt::format("#define TURNED_MESH {}\n", draw.set.soup.rotations() != nullptr ? 1 : 0) + decoder);
    glUseProgram(shader.name());
    set_uniform(shader, "camera_to_fed", to_glm(camera_to_fed(plan, frame)));
    set_uniform(shader, "alpha_code", alpha_factors(frame.alpha_code));
    set_uniform(shader, "decoder", static_cast<int>(frame.decoder));
    set_ray_uniforms(shader, plan.view, 1);
    bind_decoders(input, shader);
    draw_set(input, draw, shader);
  }
  end_geometry();
}

}  // namespace rebake
