#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/passes/pass_support.h"

namespace rebake {

namespace {

std::vector<float> frame_table(const FramePlan& plan) {
  std::vector<float> table;
  for (const NodeFrame& frame : plan.frames) {
    const glm::mat3 rotation = to_glm(camera_to_fed(plan, frame));
    for (int column = 0; column < 3; ++column)
      table.insert(table.end(), {rotation[column].x, rotation[column].y, rotation[column].z, 0.0F});
    const glm::vec2 alpha = alpha_factors(frame.alpha_code);
    table.insert(table.end(), {static_cast<float>(frame.decoder), alpha.x, alpha.y, 0.0F});
  }
  return table;
}

void bind(int unit, GLenum target, const gl::Texture& texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, texture.name());
}

}  // namespace

void execute_resolve(const PassInput& input) {
  const FramePlan& plan = input.plan;
  const FrameTargets& targets = input.state.targets;
  glBindFramebuffer(GL_FRAMEBUFFER, targets.picture_buffer.name());
  glViewport(0, 0, plan.view.width, plan.view.height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_SCISSOR_TEST);
  glScissor(plan.covered.left, plan.view.height - plan.covered.bottom, plan.covered.right - plan.covered.left,
            plan.covered.bottom - plan.covered.top);

  const gl::Program& shader = program(input.state, "fullscreen.vert", "resolve.frag",
                                      fmt::format("#define SIDE {}\n#define WRITES_FRAME {}\n#define WRITES_RAY {}\n"
                                                  "#define RAY_PER_SAMPLE {}\n",
                                                  targets.side, targets.has_frames ? 1 : 0, targets.has_rays ? 1 : 0,
                                                  plan.runs("ray per sample") ? 1 : 0) +
                                          decoder_preamble(input));
  glUseProgram(shader.name());
  bind(0, GL_TEXTURE_2D, targets.features);
  set_uniform(shader, "features", 0);
  gl::Buffer table_buffer;
  gl::Texture table_texture;
  if (targets.has_frames) {
    const std::vector<float> table = frame_table(plan);
    table_buffer = gl::make_buffer(GL_TEXTURE_BUFFER, table.data(), table.size() * sizeof(float));
    table_texture = gl::make_buffer_texture(table_buffer);
    bind(1, GL_TEXTURE_2D, targets.frames);
    bind(2, GL_TEXTURE_BUFFER, table_texture);
    set_uniform(shader, "frames", 1);
    set_uniform(shader, "frame_table", 2);
    set_uniform(shader, "decoder_count", static_cast<float>(plan.decoders.size()));
  } else {
    set_uniform(shader, "camera_to_fed", to_glm(camera_to_fed(plan, plan.frames.front())));
    set_uniform(shader, "alpha_code", alpha_factors(plan.frames.front().alpha_code));
  }
  if (targets.has_rays) {
    bind(3, GL_TEXTURE_2D, targets.rays);
    set_uniform(shader, "rays", 3);
  }
  bind_decoders(input, shader);
  set_ray_uniforms(shader, plan.view, targets.side);
  const Color& b = plan.background;
  set_uniform(shader, "background", glm::vec3(b.x(), b.y(), b.z()));
  glBindVertexArray(input.state.empty_array.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

}  // namespace rebake
