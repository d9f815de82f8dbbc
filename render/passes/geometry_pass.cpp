#include <epoxy/gl.h>
#include <fmt/format.h>

#include "mesh_ops/base/counted.h"
#include "render/passes/occlusion.h"

namespace rebake {

namespace {

void execute(const PassInput& input) {
  const bool has_frames = input.plan.runs(effects::node_frames), has_rays = input.plan.runs(effects::rotated_rays);
  std::vector<Target> colors{Target::features};
  if (has_frames) colors.push_back(Target::frames);
  if (has_rays) colors.push_back(Target::rays);
  const int light = light_level(input.plan), gain_target = static_cast<int>(colors.size());
  if (light > 0) colors.push_back(Target::light_gain);
  if (light > 1) colors.push_back(Target::light_offset);
  input.draw_to(colors, true);
  begin_geometry(input.plan, input.plan.view.side());
  const int frame_target = 1, ray_target = has_frames ? 2 : 1;
  const auto clear = [&] {
    begin_clear(input.plan);
    const GLuint nothing[4] = {};
    glClearBufferuiv(GL_COLOR, 0, nothing);
    if (has_rays) {
      const float no_ray[4] = {};
      glClearBufferfv(GL_COLOR, ray_target, no_ray);
    }
    clear_depth();
    end_clear();
  };
  const auto use = [&](const Draw& draw) -> const gl::Program& {
    const gl::Program& shader =
        program(input.state, "geometry.vert", "geometry.frag",
                fmt::format("#define TURNED_MESH {}\n#define WRITES_FRAME {}\n#define WRITES_RAY {}\n#define "
                            "FRAME_TARGET {}\n#define RAY_TARGET {}\n",
                            draw.set.soup.rotations() != nullptr ? 1 : 0, has_frames ? 1 : 0, has_rays ? 1 : 0,
                            frame_target, ray_target) +
                    light_preamble(draw) + texel_preamble(input, draw) +
                    fmt::format("#define WRITES_LIGHT {}\n#define GAIN_TARGET {}\n#define OFFSET_TARGET {}\n", light,
                                gain_target, gain_target + 1));
    glUseProgram(shader.name());
    set_uniform(shader, "frame", static_cast<unsigned>(draw.frame));
    return shader;
  };
  draw_sets(input, use, clear);
  end_geometry();
}

std::optional<Decision> decide(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (facts.forward()) return Decision{false, "forward shading decodes while drawing"};
  return Decision{true, describe_draws(facts.plan)};
}

std::optional<Decision> decide_supersampling(const FrameFacts& facts) {
  const View& view = facts.plan.view;
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (!facts.plan.why_reduced_samples.empty()) return Decision{false, facts.plan.why_reduced_samples};
  if (view.samples == 1) return Decision{false, "1 sample per pixel is requested"};
  return Decision{true, fmt::format("{} samples per pixel: render targets of {}×{}", view.samples,
                                    view.width * view.side(), view.height * view.side())};
}

std::optional<Decision> decide_view_direction(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  const double change = facts.plan.direction_change;
  if (!facts.plan.uses_view_direction)
    return Decision{false, change == 0 ? "no decoder in view depends on it"
                                       : fmt::format("changes colours by at most {:.2g} of 255", change * 255)};
  return Decision{true, "colours depend on it"};
}

std::optional<Decision> decide_node_frames(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  const std::size_t count = facts.plan.frames.size();
  if (count == 1) return Decision{false, "one decoder and orientation in view"};
  return Decision{true, fmt::format("{} decoders, orientations or alpha codes in view", count)};
}

std::optional<Decision> decide_rotated_rays(const FrameFacts& facts) {
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (!facts.plan.uses_view_direction) return Decision{false, "no decoder in view depends on the view direction"};
  if (facts.rotated_draws == 0) return Decision{false, "no triangle was rotated relative to its object"};
  return Decision{true, counted(facts.rotated_draws, "draw has", "draws have") + " rotated triangles"};
}

constexpr Use writes[] = {{Target::features},
                          {Target::frames, &effects::node_frames},
                          {Target::rays, &effects::rotated_rays},
                          {Target::light_gain, &effects::light},
                          {Target::light_offset, &effects::light_offset},
                          {Target::depth}};

}  // namespace

const Effect effects::geometry{"geometry", Effect::Kind::colors, decide, execute, {}, writes};
const Effect effects::supersampling{"supersampling", Effect::Kind::colors, decide_supersampling};
const Effect effects::view_direction{"view direction", Effect::Kind::colors, decide_view_direction};
const Effect effects::node_frames{"node frames", Effect::Kind::colors, decide_node_frames};
const Effect effects::rotated_rays{"turned rays", Effect::Kind::colors, decide_rotated_rays};

}  // namespace rebake
