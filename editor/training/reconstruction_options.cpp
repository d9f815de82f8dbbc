#include "editor/training/reconstruction_options.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/reconstruction/mlp_field.h"

namespace rebake {

void check(const ReconstructionOptions& options) {
  if (options.source.path.empty()) throw FieldError("photographs", "is empty");
  if (!(std::isfinite(options.source.scale) && options.source.scale > 0))
    throw FieldError("scale", "must be a number above 0");
  if (options.minutes && options.steps) throw FieldError("steps", "cannot be combined with minutes");
  if (options.minutes && !(*options.minutes > 0 && *options.minutes <= 10000))
    throw FieldError("minutes", "must lie between 0 and 10000");
  if (options.steps && (*options.steps < 1 || *options.steps > 10'000'000))
    throw FieldError("steps", "must lie between 1 and 10000000");
  if (options.side && (*options.side < 16 || *options.side > 256))
    throw FieldError("side", "must lie between 16 and 256 cells");
  if (options.near && !(std::isfinite(*options.near) && *options.near > 0))
    throw FieldError("near", "must be a number above 0");
  if (options.far && !(std::isfinite(*options.far) && *options.far > options.near.value_or(0)))
    throw FieldError("far", "must be a number above near");
  if (options.kind != CaptureKind::forward && (options.near || options.far))
    throw FieldError(options.near ? "near" : "far", "applies to forward captures only");
  if (options.seed < 0) throw FieldError("seed", "must be at least 0");
  if (options.held_out.every < 0 || options.held_out.every == 1)
    throw FieldError("hold_out", "must be 0 (none) or at least 2");
  if (options.width < 4 || options.width > 1024) throw FieldError("width", "must lie between 4 and 1024 neurons");
  if (options.octaves < 1 || options.octaves > 16) throw FieldError("octaves", "must lie between 1 and 16");
  if (options.layers < 1 || options.layers > 16) throw FieldError("layers", "must lie between 1 and 16");
  if (options.mlp) require_mlp_fields();
  if (options.samples < 1 || options.samples > 64) throw FieldError("samples", "must lie between 1 and 64");
}

nlohmann::json identity_of(const ReconstructionOptions& options, int side) {
  constexpr int recipe = 1;  // grows when the same options train otherwise
  nlohmann::json identity = {{"recipe", recipe},
                             {"side", side},
                             {"kind", static_cast<int>(options.kind)},
                             {"seed", options.seed},
                             {"exposures", options.gains},
                             {"four_rays", options.four_rays}};
  if (options.mlp) identity["networks"] = {options.width, options.octaves, options.layers};
  if (options.minutes) identity["minutes"] = *options.minutes;
  if (options.steps) identity["steps"] = *options.steps;
  if (options.near) identity["near"] = *options.near;
  if (options.far) identity["far"] = *options.far;
  return identity;
}

}  // namespace rebake
