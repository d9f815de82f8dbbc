#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/light/lighting.h"
#include "mesh_ops/scene/scene.h"
#include "render/graph/guides.h"
#include "render/graph/pixel_rect.h"

namespace rebake {

/// How the renderer does what can be done in several ways. All ways give the same picture, but for rounding.
struct RenderOptions {
  enum class Weights {
    automatic,  ///< constants for up to 4 decoders of at most 4096 weights (but 0) together, else buffer
    constants,  ///< decoder weights are literals in the shader: fastest, a new decoder costs a compilation
    buffer,     ///< decoder weights are fetched: any number and width of decoders with one shader
  };
  enum class Shading {
    automatic,  ///< forward at 1 sample with constant weights, where it is faster; else deferred
    deferred,   ///< features are drawn first and decoded once a pixel
    forward,    ///< features are decoded while drawing; the rule allows it at 1 sample only
  };
  enum class Precision {
    full,  ///< decoder weights as 32-bit floats
    half,  ///< decoder weights rounded to 16-bit floats (11 significant bits)
  };
  enum class Occlusion {
    automatic,  ///< where it pays, as far as the device and the last look tell
    on,         ///< hidden triangles are looked for and left out
    off,        ///< all triangles in view are drawn
  };
  enum class Texels {
    automatic,  ///< coded where a scene's textures take more than 256 MiB
    plain,      ///< 8 bytes each: fastest
    coded,      ///< in blocks, without loss: about half the memory
  };
  Weights weights = Weights::automatic;
  Shading shading = Shading::automatic;
  Precision precision = Precision::full;
  Occlusion occlusion = Occlusion::automatic;
  Texels texels = Texels::automatic;
  bool everything = false;  ///< also what changes less than `unseen`: to audit

  bool operator==(const RenderOptions&) const = default;
};

/// A change of display colours (0 … 1) that a plan may make to leave work out: an eighth of a step of 8 bits.
inline constexpr double unseen = 0.125 / 255;

struct FramePlan;

/// What a plan is to know of where it is carried out.
struct DeviceFacts {
  std::size_t occlusion_from = 20'000;  ///< triangles in view from which looking for hidden ones pays
  /// Where the last look found that too little is hidden: the share of triangles in view that showed; else 0.
  double shown_share = 0;
  bool reads_coded_texels = true;    ///< whether its buffers are large enough for coded texels
  const FramePlan* shown = nullptr;  ///< what its targets hold; null where that is not known
};

/// Whether a scene's texels are coded on the GPU, which holds those of all its nodes, shown or not.
bool codes_texels(const Scene& scene, RenderOptions::Texels texels, const DeviceFacts& device = {});

/// What looking for hidden triangles found in a frame.
struct OcclusionCounts {
  std::size_t clusters = 0, clusters_drawn = 0, clusters_hidden = 0, clusters_out_of_view = 0;
  std::size_t triangles = 0, triangles_in_view = 0;
  std::size_t triangles_drawn = 0;  ///< at first, and those that were found missing
  std::size_t triangles_shown = 0;  ///< that were not found to be hidden
  double milliseconds = 0;          ///< that deciding took
  bool drawn_again = false;         ///< in the scene's order: much was missing, or samples were equally near
  bool known = false;               ///< nothing has moved since the last frame: it was not looked again
};

/// How the samples of some nodes feed a decoder. Nodes that agree share one.
struct NodeFrame {
  std::size_t decoder = 0;  ///< index into FramePlan::decoders
  Mat3 world_to_fed;        ///< turns world directions into what the decoder is fed
  AlphaCode alpha_code = AlphaCode::halved;
};

/// One texture set of one node.
struct Draw {
  NodeId node = NodeId::none;
  TextureSet set;
  std::size_t frame = 0;  ///< index into FramePlan::frames
  Affine to_camera;       ///< object to camera space, composed in double
  Axes axes = Axes::y_up;
  std::shared_ptr<const TriangleSet> selection;  ///< of the whole object; null when nothing is selected
  std::size_t first_triangle = 0;                ///< the set's, in the object's numbering
  std::shared_ptr<const LightMap> light;         ///< null where no light changes it
};

struct Effect;

/// A pass or an optional part of one, and why it runs or not.
struct PlannedPass {
  const Effect* effect;  ///< null for what was worked out before the frame: light
  std::string name;
  bool runs = false;
  std::string why;
};

/// Everything that the GPU is to do for one picture.
struct FramePlan {
  View view;
  RenderOptions options;  ///< with automatic choices made
  Color background{1, 1, 1};
  std::vector<Draw> draws;
  std::vector<std::shared_ptr<const Decoder>> decoders;  ///< distinct weights in view
  std::vector<NodeFrame> frames;
  std::vector<PlannedPass> passes;
  PixelRect covered;            ///< of the picture nothing is drawn outside it
  bool kept = false;            ///< what the targets hold outside it stays
  double left_out = 0;          ///< display colours change at most by so much by what is left out: 0 … 2 · unseen
  double direction_change = 0;  ///< a bound of what the view direction changes
  bool sees_direction = true;   ///< decoders are fed the view direction
  std::string why_one_sample;   ///< where fewer samples are taken than the view asks for
  std::size_t triangles = 0;
  std::uint64_t texture_bytes = 0;  ///< of the scene's textures, in view or not, at 8 bytes a texel
  bool overlays = false;            ///< guides are wanted
  Guides guides;

  bool runs(const Effect& effect) const;
};

/// Pure. `guides`: what an editor wants over the picture, null for the picture alone. `lighting`: what light does to
/// its colours, null for nothing. Throws FieldError for a view or
/// option that cannot be carried out, EditError for a node whose transform is singular.
FramePlan plan(const Scene& scene, const View& view, const RenderOptions& options = {}, const Guides* guides = nullptr,
               const Lighting* lighting = nullptr, const DeviceFacts& device = {});

/// One line each, e.g. "left out  node frames     one decoder and orientation in view".
std::string describe(const std::vector<PlannedPass>& passes);

}  // namespace rebake
