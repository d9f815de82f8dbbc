#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"

namespace rebake {

/// Key of the shader programs that draw a frame's colours: frames with equal keys use the same programs.
struct ProgramVariant {
  std::vector<std::shared_ptr<const Decoder>> decoders;  ///< with weights as literals; empty if weights are fetched
  std::string flags;                                     ///< options, samples, effects that run, and kinds of draws
  bool operator==(const ProgramVariant&) const = default;
};
ProgramVariant variant_of(const FramePlan& plan);

/// A small frame of some of a scene's nodes, drawn off screen to compile programs before a camera needs them.
struct PrecompileFrame {
  Scene scene;
  View view;
};
/// Frames that together use all programs that views of a scene may need: one per ProgramVariant, most likely ones
/// first. Combines representatives of similar nodes, at the samples of `view` and at 1: all combinations of up to 5
/// representatives; of more only all together, each alone, and pairs. Pure.
std::vector<PrecompileFrame> precompile_frames(const Scene& scene, const View& view, const RenderOptions& options,
                                               const Lighting* lighting);

}  // namespace rebake
