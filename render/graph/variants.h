#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"

namespace rebake {

/// What a frame's programs for colours are made of: frames of one variant use the same programs.
struct ProgramVariant {
  std::vector<std::shared_ptr<const Decoder>> decoders;  ///< whose weights are in the text; none where they are fetched
  std::string flags;
  bool operator==(const ProgramVariant&) const = default;
};
ProgramVariant variant_of(const FramePlan& plan);

/// Frames that together want the programs which views of a scene may want, so that these can be made before the camera
/// turns there: small pictures, at the given view's samples and at 1, of nodes that stand for all that are drawn like
/// them. Each holds some of the scene's nodes; frames of one variant come once. Of scenes of many kinds of nodes only
/// those of all together, of each alone and of pairs. Pure.
struct FrameToCome {
  Scene scene;
  View view;
};
std::vector<FrameToCome> frames_to_come(const Scene& scene, const View& view, const RenderOptions& options,
                                        const Lighting* lighting);

}  // namespace rebake
