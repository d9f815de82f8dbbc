#include <fmt/format.h>

#include "render/graph/effects.h"

namespace rebake {

namespace {

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

std::optional<Decision> decide(const FrameFacts& facts) {
  const FramePlan& plan = facts.plan;
  if (plan.texture_bytes == 0) return std::nullopt;
  const std::string textures =
      fmt::format("textures take {:.0f} MB at 8 bytes per texel", megabytes(plan.texture_bytes));
  if (plan.options.texels == RenderOptions::Texels::coded)
    return Decision{true, textures + "; stored in lossless blocks"};
  if (!facts.device.reads_coded_texels) return Decision{false, "the driver's buffer textures are too small"};
  if (plan.texture_bytes > min_coded_bytes) return Decision{false, "switched off; " + textures};
  return Decision{false, fmt::format("{}; coding pays above {:.0f} MB", textures, megabytes(min_coded_bytes))};
}

}  // namespace

const Effect effects::coded_texels{"coded texels", Effect::Kind::always, decide};

}  // namespace rebake
