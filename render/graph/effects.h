#pragma once

#include <optional>
#include <span>
#include <string>

#include "render/graph/plan.h"

namespace rebake {

/// Render targets of a frame, which effects write and later effects read.
enum class Target {
  picture,       ///< RGBA8 per pixel
  features,      ///< RG32UI per sample: the 8 feature bytes
  frames,        ///< R16UI per sample: index into FramePlan::frames
  rays,          ///< RGBA32F per sample: view direction fed to the decoder if the triangle was rotated, otherwise 0
  depth,         ///< DEPTH_COMPONENT32F per sample
  light_gain,    ///< RGBA16F per sample: factor of linear light
  light_offset,  ///< RGBA16F per sample: linear light to add
  mask,          ///< R8 per pixel: strength of the selection, then of outlined nodes
};
inline constexpr std::size_t target_count = 8;

struct Effect;
struct PassInput;

/// Declares that an effect reads or writes a target.
struct Use {
  Target target;
  const Effect* where = nullptr;  ///< if set: only in frames in which this effect runs too
};

/// Input of Effect::decide: the frame as planned so far.
struct FrameFacts {
  const FramePlan& plan;  ///< complete except for its passes
  const DeviceFacts& device;
  /// Numbers of: draws with triangles rotated apart from their object; visible nodes out of view; nodes hidden by an
  /// edit.
  std::size_t rotated_draws = 0, culled = 0, hidden = 0;
  std::string why_partial_frame;  ///< reason why unchanged pixels are reused or not

  bool any_draw() const { return !plan.draws.empty(); }
  bool forward() const { return plan.options.shading == RenderOptions::Shading::forward; }
};

/// Whether an effect runs, and the reason in words.
struct Decision {
  bool runs = false;
  std::string why;
};

/// A render pass, or an optional part of one: its decision, its drawing, the targets that it reads and writes. Effects
/// are referred to by object, not by string, so that a misspelt name does not compile.
struct Effect {
  enum class Kind {
    colors,  ///< decodes colours; left out if triangles are inspected
    always,  ///< decided in every frame
    overlay  ///< decided only if guides are drawn
  };

  const char* name;  ///< in the plan and in FrameTimes
  Kind kind;
  std::optional<Decision> (*decide)(const FrameFacts& facts);  ///< nullopt: not worth a line in the plan
  void (*execute)(const PassInput& input) = nullptr;           ///< draws; null for a part of another pass
  std::span<const Use> reads{}, writes{};
};

namespace effects {
extern const Effect geometry, supersampling, view_direction, node_frames, rotated_rays, light, light_offset, highlights,
    decoder_compositing, ray_per_sample, resolve, forward, culling, occlusion, hidden_objects, kept_pixels,
    coded_texels, inspect, selection, outline, guides;
}

/// All effects, in the order in which they are listed and run.
std::span<const Effect* const> effect_table();

/// Size of a plan in words: "3 draws, 1200 triangles".
std::string describe_draws(const FramePlan& plan);
/// The decoders in words: "decoder 11-16-16-3, weights as constants".
std::string describe_decoder(const FramePlan& plan);
/// Size of textures in bytes above which texels are coded by default.
inline constexpr std::uint64_t min_coded_bytes = std::uint64_t{256} << 20;
inline constexpr const char* nothing_in_view = "nothing is in view";

}  // namespace rebake
