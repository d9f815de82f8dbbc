#include "render/graph/effects.h"

#include <fmt/format.h>

#include "mesh_ops/base/counted.h"

namespace rebake {

namespace {

constexpr const Effect* table[] = {
    &effects::geometry,       &effects::supersampling, &effects::view_direction,
    &effects::node_frames,    &effects::rotated_rays,  &effects::light,
    &effects::light_offset,   &effects::highlights,    &effects::decoder_compositing,
    &effects::ray_per_sample, &effects::resolve,       &effects::forward,
    &effects::culling,        &effects::occlusion,     &effects::hidden_objects,
    &effects::kept_pixels,    &effects::coded_texels,  &effects::inspect,
    &effects::selection,      &effects::outline,       &effects::guides,
};

}  // namespace

std::span<const Effect* const> effect_table() { return table; }

std::string describe_draws(const FramePlan& plan) {
  return fmt::format("{}, {}", counted(plan.draws.size(), "draw"), counted(plan.triangles, "triangle"));
}

std::string describe_decoder(const FramePlan& plan) {
  const Decoder& d = *plan.decoders.front();
  if (d.rule == ColorRule::diffuse && plan.decoders.size() == 1) return "colours are read from the textures";
  return fmt::format("decoder 11-{}-{}-3, weights as {}", d.hidden0(), d.hidden1(),
                     plan.options.weights == RenderOptions::Weights::constants ? "constants" : "a buffer");
}

}  // namespace rebake
