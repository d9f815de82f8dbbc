#include <fmt/format.h>

#include "render/graph/effects.h"

namespace rebake {

namespace {

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

std::optional<Decision> decide(const FrameFacts& facts) {
  const FramePlan& plan = facts.plan;
  if (plan.texture_bytes == 0) return std::nullopt;
  const std::string textures = fmt::format("textures take {:.0f} MB at 8 bytes a texel", megabytes(plan.texture_bytes));
  if (plan.options.texels == RenderOptions::Texels::coded)
    return Decision{true, textures + ": those in use are coded in blocks without loss"};
  if (!facts.device.reads_coded_texels) return Decision{false, "this driver's buffers are too small"};
  if (plan.texture_bytes > coded_from) return Decision{false, "not wanted; " + textures};
  return Decision{false, fmt::format("{}, and coding pays above {:.0f}", textures, megabytes(coded_from))};
}

}  // namespace

const Effect effects::coded_texels{"coded texels", Effect::Kind::always, decide};

}  // namespace rebake
