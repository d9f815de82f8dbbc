#include <epoxy/gl.h>
#include <fmt/format.h>

#include "render/passes/occlusion.h"

namespace rebake {

namespace {

// Contents of frame_table in resolve.frag.
std::vector<float> frame_table(const FramePlan& plan) {
  std::vector<float> table;
  for (const DecodeFrame& frame : plan.frames) {
    const glm::mat3 rotation = to_glm(camera_to_fed(plan, frame));
    for (int column = 0; column < 3; ++column)
      table.insert(table.end(), {rotation[column].x, rotation[column].y, rotation[column].z, 0.0F});
    const glm::vec2 alpha = alpha_factors(frame.alpha_code);
    table.insert(table.end(), {static_cast<float>(frame.decoder), alpha.x, alpha.y, 0.0F});
  }
  return table;
}

void bind(int unit, GLenum target, unsigned texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, texture);
}

void execute(const PassInput& input) {
  const FramePlan& plan = input.plan;
  const bool has_frames = plan.runs(effects::node_frames), has_rays = plan.runs(effects::rotated_rays);
  const int side = plan.view.side();
  input.draw_to({Target::picture}, false);
  glViewport(0, 0, plan.view.width, plan.view.height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  restrict_to_covered(plan, 1);

  const gl::Program& shader = program(input.state, "rectangles.vert", "resolve.frag",
                                      fmt::format("#define SIDE {}\n#define WRITES_FRAME {}\n#define WRITES_RAY {}\n"
                                                  "#define RAY_PER_SAMPLE {}\n#define WRITES_LIGHT {}\n",
                                                  side, has_frames ? 1 : 0, has_rays ? 1 : 0,
                                                  plan.runs(effects::ray_per_sample) ? 1 : 0, light_level(plan)) +
                                          decoder_preamble(input));
  glUseProgram(shader.name());
  bind(0, GL_TEXTURE_2D, input.read(Target::features));
  set_uniform(shader, "features", 0);
  gl::Buffer table_buffer;
  gl::Texture table_texture;
  if (has_frames) {
    const std::vector<float> table = frame_table(plan);
    table_buffer = gl::make_buffer(GL_TEXTURE_BUFFER, table.data(), table.size() * sizeof(float));
    table_texture = gl::make_buffer_texture(table_buffer, GL_RGBA32F);
    bind(1, GL_TEXTURE_2D, input.read(Target::frames));
    bind(2, GL_TEXTURE_BUFFER, table_texture.name());
    set_uniform(shader, "frames", 1);
    set_uniform(shader, "frame_table", 2);
    set_uniform(shader, "decoder_count", static_cast<float>(plan.decoders.size()));
  } else {
    set_uniform(shader, "camera_to_fed", to_glm(camera_to_fed(plan, plan.frames.front())));
    set_uniform(shader, "alpha_code", alpha_factors(plan.frames.front().alpha_code));
  }
  if (has_rays) {
    bind(3, GL_TEXTURE_2D, input.read(Target::rays));
    set_uniform(shader, "rays", 3);
  }
  if (plan.runs(effects::light)) {
    bind(6, GL_TEXTURE_2D, input.read(Target::light_gain));
    set_uniform(shader, "light_gain", 6);
  }
  if (plan.runs(effects::light_offset)) {
    bind(7, GL_TEXTURE_2D, input.read(Target::light_offset));
    set_uniform(shader, "light_offset", 7);
  }
  bind_decoders(input, shader);
  set_ray_uniforms(shader, plan.view, side);
  set_uniform(shader, "background", glm::vec4(to_glm(plan.background), plan.options.transparent ? 0.0F : 1.0F));
  draw_rectangles(plan.view, shader, drawn_pixels(input));
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (facts.forward()) return Decision{false, "forward shading decodes while drawing"};
  return Decision{true, describe_decoder(facts.plan)};
}

std::optional<Decision> decide_compositing(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  const std::size_t count = facts.plan.decoders.size();
  if (count == 1) return Decision{false, "one decoder in view"};
  if (facts.forward()) return Decision{false, "at 1 sample per pixel, no pixel mixes decoders"};
  return Decision{true, fmt::format("{} decoders in view", count)};
}

// Width of a pixel divided by its distance along the view axis; 0 for orthographic cameras.
double pixel_span(const View& view) {
  return view.camera.orthographic() ? 0 : 2 * half_height(view.camera, 1) / view.height;
}

std::optional<Decision> decide_ray_per_sample(const FrameFacts& facts) {
  // Largest pixel width, divided by distance, for which one ray replaces those of all samples. The mean of unit vectors
  // spread by s differs from the unit vector of their mean position by O(s²): at most 4e-6 here.
  constexpr double widest_single_ray = 1.0 / 256;
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (facts.forward() || facts.plan.view.samples == 1) return Decision{false, "a pixel has one sample"};
  if (!facts.plan.uses_view_direction) return Decision{false, "no decoder in view depends on the view direction"};
  if (facts.plan.frames.size() > 1 || facts.rotated_draws > 0)
    return Decision{true, facts.rotated_draws > 0 ? "rotations may differ within a pixel"
                                                  : "samples of a pixel may be of different objects"};
  const double pixel = pixel_span(facts.plan.view);
  if (pixel > widest_single_ray) return Decision{true, fmt::format("a pixel spans {:.2g} of its distance", pixel)};
  return Decision{false, fmt::format("a pixel spans {:.2g} of its distance: one ray through the middle of its samples "
                                     "differs by less than {:.0e}",
                                     pixel, pixel * pixel / 4)};
}

constexpr Use reads[] = {{Target::features},
                         {Target::frames, &effects::node_frames},
                         {Target::rays, &effects::rotated_rays},
                         {Target::light_gain, &effects::light},
                         {Target::light_offset, &effects::light_offset}};
constexpr Use writes[] = {{Target::picture}};

}  // namespace

const Effect effects::decoder_compositing{"decoder compositing", Effect::Kind::colors, decide_compositing};
const Effect effects::ray_per_sample{"ray per sample", Effect::Kind::colors, decide_ray_per_sample};
const Effect effects::resolve{"resolve", Effect::Kind::colors, decide, execute, reads, writes};

}  // namespace rebake
