#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/passes/pass_support.h"

namespace rebake {

void execute_geometry(const PassInput& input) {
  const FrameTargets& targets = input.state.targets;
  glBindFramebuffer(GL_FRAMEBUFFER, targets.sample_buffer.name());
  begin_geometry(input.plan, targets.side);
  const GLuint nothing[4] = {};
  glClearBufferuiv(GL_COLOR, 0, nothing);
  const int frame_target = 1, ray_target = targets.has_frames ? 2 : 1;
  if (targets.has_rays) {
    const float no_ray[4] = {};
    glClearBufferfv(GL_COLOR, ray_target, no_ray);
  }
  for (const Draw& draw : input.plan.draws) {
    const gl::Program& shader =
        program(input.state, "geometry.vert", "geometry.frag",
                fmt::format("#define TURNED_MESH {}\n#define WRITES_FRAME {}\n#define WRITES_RAY {}\n#define "
                            "FRAME_TARGET {}\n#define RAY_TARGET {}\n",
                            draw.set.soup.rotations() != nullptr ? 1 : 0, targets.has_frames ? 1 : 0,
                            targets.has_rays ? 1 : 0, frame_target, ray_target));
    glUseProgram(shader.name());
    set_uniform(shader, "frame", static_cast<unsigned>(draw.frame));
    draw_set(input, draw, shader);
  }
  end_geometry();
}

}  // namespace rebake
