#pragma once

#include <optional>
#include <span>
#include <string>

#include "render/graph/plan.h"

namespace rebake {

/// Buffers of a frame that effects pass on to each other.
enum class Target {
  picture,       ///< RGBA8, a pixel
  features,      ///< RG32UI, a sample's 8 feature bytes
  frames,        ///< R16UI, a sample's index into FramePlan::frames
  rays,          ///< RGBA32F, a sample's fed direction where its triangle was turned, else 0
  depth,         ///< a sample's depth
  light_gain,    ///< RGBA16F, a sample's factor of linear light
  light_offset,  ///< RGBA16F, what is added to it
  mask,          ///< R8, a pixel's selected triangles, then those of outlined nodes
};
inline constexpr std::size_t target_count = 8;

struct Effect;
struct PassInput;

/// That an effect reads or writes a target; with `where` only in frames in which that one runs too.
struct Use {
  Target target;
  const Effect* where = nullptr;
};

/// What a frame is made of, as far as it is planned.
struct FrameFacts {
  const FramePlan& plan;  ///< all but its passes
  const DeviceFacts& device;
  std::size_t turned_draws = 0, culled = 0, hidden = 0;
  std::string why_kept;  ///< or why not

  bool any_draw() const { return !plan.draws.empty(); }
  bool forward() const { return plan.options.shading == RenderOptions::Shading::forward; }
};

struct Decision {
  bool runs = false;
  std::string why;
};

/// A pass, or an optional part of one: when it runs and why, what it reads and writes. Each is an object of its own, so
/// that a name which does not exist does not compile.
struct Effect {
  /// What it is there for: inspecting leaves out what decodes colours, and a plain picture has no overlays.
  enum class Kind { colors, always, overlay };

  const char* name;
  Kind kind;
  std::optional<Decision> (*decide)(const FrameFacts& facts);  ///< nothing where it is not worth a word
  void (*execute)(const PassInput& input) = nullptr;           ///< null for a part of another
  std::span<const Use> reads{}, writes{};
};

namespace effects {
extern const Effect geometry, supersampling, view_direction, node_frames, turned_rays, light, light_offset, highlights,
    decoder_compositing, ray_per_sample, resolve, forward, culling, occlusion, hidden_objects, kept_pixels,
    coded_texels, inspect, selection, outline, guides;
}

/// All of them, in the order in which they are said and run.
std::span<const Effect* const> effect_table();

/// "3 draws".
std::string plural(std::size_t count, const std::string& one, const std::string& many);
/// What is drawn, in words.
std::string drawn_words(const FramePlan& plan);
/// How it is decoded, in words. Something is drawn.
std::string decoder_words(const FramePlan& plan);
/// Bytes of textures above which texels are coded.
inline constexpr std::uint64_t coded_from = std::uint64_t{256} << 20;
inline constexpr const char* nothing_in_view = "nothing is in view";

}  // namespace rebake
