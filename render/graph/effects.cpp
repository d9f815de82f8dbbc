#include "render/graph/effects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>

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
  std::vector<std::string> sizes;
  for (const auto& decoder : plan.decoders) {
    if (decoder->rule == ColorRule::diffuse) continue;
    const std::string size = decoder->rule == ColorRule::network
                                 ? fmt::format("11-{}-{}-3", decoder->hidden0(), decoder->hidden1())
                                 : fmt::format("6-{}-3 added to a diffuse colour", decoder->hidden1());
    if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(size);
  }
  if (sizes.empty()) return "colours are read from the textures";
  return fmt::format("{} {}, weights as {}", sizes.size() == 1 ? "decoder" : "decoders", fmt::join(sizes, " and "),
                     plan.options.weights == RenderOptions::Weights::constants ? "constants" : "a buffer");
}

}  // namespace rebake
