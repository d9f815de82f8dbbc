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

/// Choices between implementations of the renderer. All give the same picture up to rounding.
struct RenderOptions {
  enum class Weights {
    automatic,  ///< constants for up to 4 decoders with up to 4096 non-zero weights in total, otherwise buffer
    constants,  ///< weights are literals in the shader: fastest, but a new decoder costs a compilation
    buffer,     ///< weights are fetched from a buffer: one shader for decoders of any number and width
  };
  enum class Shading {
    automatic,  ///< forward at 1 sample per pixel with constant weights, otherwise deferred
    deferred,   ///< features are drawn to targets first, then decoded once per pixel
    forward,    ///< features are decoded while drawing; possible at 1 sample per pixel only
  };
  enum class Precision {
    full,  ///< decoder weights as 32-bit floats
    half,  ///< decoder weights rounded to 16-bit floats (11 significant bits)
  };
  enum class Arithmetic {
    scalars,      ///< constants: a sum of products per neuron, without those of zero weights
    all_scalars,  ///< the same with zero weights
    vectors,      ///< constants: products of 4×4 matrices and vectors, without matrices of zeros
    halves        ///< as scalars, in 16-bit floats; throws DeviceError if the driver does not compute them
  };
  enum class Occlusion {
    automatic,  ///< on if it is expected to pay, from the device and the last measured result
    on,         ///< two-pass occlusion culling
    off,        ///< all triangles in view are drawn
  };
  enum class Texels {
    automatic,  ///< coded if the scene's textures exceed 256 MiB
    plain,      ///< 8 bytes per texel: fastest
    coded,      ///< lossless blocks: about half the memory
  };
  Weights weights = Weights::automatic;
  Shading shading = Shading::automatic;
  Precision precision = Precision::full;
  Arithmetic arithmetic = Arithmetic::scalars;
  Occlusion occlusion = Occlusion::automatic;
  Texels texels = Texels::automatic;
  bool transparent = false;  ///< the background is transparent: pictures get an alpha channel
  bool everything = false;   ///< do not skip work that changes colours by less than `unseen`; for audits

  bool operator==(const RenderOptions&) const = default;
};

/// Largest change of display colours (0 … 1) by which a plan may skip work: an eighth of an 8-bit step.
inline constexpr double unseen = 0.125 / 255;

struct FramePlan;

/// Properties of the device and results of earlier frames that a plan depends on.
struct DeviceFacts {
  std::size_t min_culling_triangles = 20'000;  ///< number of triangles in view from which occlusion culling pays
  /// Share of the triangles in view that the last occlusion culling found visible, if too large for culling to pay;
  /// otherwise 0.
  double visible_share = 0;
  bool reads_coded_texels = true;    ///< whether buffer textures are large enough for coded texels
  const FramePlan* shown = nullptr;  ///< plan of the picture in the render targets; null if unknown
};

/// Whether a scene's texels are coded on the GPU. Hidden nodes count too, because their texels are resident.
bool uses_coded_texels(const Scene& scene, RenderOptions::Texels texels, const DeviceFacts& device = {});

/// Results of occlusion culling in a frame.
struct OcclusionCounts {
  /// Clusters of up to 64 faces: all; with visible triangles; in view but occluded; outside the frustum.
  std::size_t clusters = 0, clusters_drawn = 0, clusters_hidden = 0, clusters_out_of_view = 0;
  std::size_t triangles = 0, triangles_in_view = 0;  ///< all; in clusters that are in view
  std::size_t triangles_drawn = 0;                   ///< in both passes together
  std::size_t triangles_shown = 0;                   ///< not found to be occluded
  double milliseconds = 0;   ///< wall-clock time of the tests and of reading depth, without drawing
  bool drawn_again = false;  ///< all visible triangles, in scene order: many were missing, or depths were equal
  bool known = false;        ///< nothing has changed, so that results of an earlier frame were reused
};

/// How samples are decoded: the decoder, the orientation of view directions, and the coding of alpha. Nodes that agree
/// in all three share one.
struct DecodeFrame {
  std::size_t decoder = 0;  ///< index into FramePlan::decoders
  Mat3 world_to_decoder;    ///< rotates directions from world space into the space of the decoder
  AlphaCode alpha_code = AlphaCode::halved;
};

/// A texture set of a node to draw.
struct Draw {
  NodeId node = NodeId::none;
  TextureSet set;
  std::size_t frame = 0;  ///< index into FramePlan::frames
  Affine to_camera;       ///< object to camera space, composed in double precision
  Axes axes = Axes::y_up;
  std::shared_ptr<const TriangleSet> selection;  ///< flags of the whole object; null if nothing is selected
  std::size_t first_triangle = 0;                ///< number of the set's first triangle within the object
  std::shared_ptr<const LightMap> light;         ///< correction of colours; null for none
};

struct Effect;

/// An effect of a frame: whether it runs, and why.
struct PlannedPass {
  const Effect* effect;  ///< null for effects of Lighting, which are computed before the frame
  std::string name;
  bool runs = false;
  std::string why;
};

/// Plan of a frame: all that the renderer needs to know to draw it.
struct FramePlan {
  View view;
  RenderOptions options;      ///< with automatic choices resolved
  Color background{1, 1, 1};  ///< black if transparent
  std::vector<Draw> draws;
  std::vector<std::shared_ptr<const Decoder>> decoders;  ///< distinct decoders in view
  std::vector<DecodeFrame> frames;                       ///< distinct, in view
  std::vector<PlannedPass> passes;
  PixelRect covered;                ///< bounding rectangle of the pixels to draw
  bool kept = false;                ///< whether targets keep their contents outside `covered`
  double left_out = 0;              ///< bound of the change of display colours by skipped work, 0 … 2 · unseen
  double direction_change = 0;      ///< bound of the change of display colours by the view direction
  bool uses_view_direction = true;  ///< whether the view direction is fed to decoders
  std::string why_reduced_samples;  ///< reason if fewer samples are taken than the view asks for, otherwise empty
  std::size_t triangles = 0;        ///< of all draws
  std::uint64_t texture_bytes = 0;  ///< of all textures of the scene, at 8 bytes per texel
  bool overlays = false;            ///< whether `guides` are drawn
  Guides guides;

  bool runs(const Effect& effect) const;
};

/// Plans a frame. Pure. `guides`: overlays, null for none. `lighting`: corrections of colours, null for none. Throws
/// FieldError for an invalid view or option, EditError for a node with a singular transform.
FramePlan plan(const Scene& scene, const View& view, const RenderOptions& options = {}, const Guides* guides = nullptr,
               const Lighting* lighting = nullptr, const DeviceFacts& device = {});

/// One line per pass, such as "skipped   node frames     one decoder and orientation in view".
std::string describe(const std::vector<PlannedPass>& passes);

}  // namespace rebake
