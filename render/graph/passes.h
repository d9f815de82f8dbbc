#pragma once

#include <map>
#include <optional>
#include <string>

#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/targets.h"

namespace rebake {

/// Programs by their full source, the most recently used ones: a decoder that comes back is not compiled again, and
/// those of decoders long gone do not pile up.
class ProgramCache {
 public:
  /// The program made of two shader files behind a preamble.
  const gl::Program& get(const std::string& vertex, const std::string& fragment, const std::string& preamble);
  std::size_t size() const { return entries_.size(); }
  /// How many were compiled so far.
  std::size_t made() const { return made_; }

 private:
  static constexpr std::size_t most = 64;
  struct Entry {
    gl::Program program;
    std::uint64_t used = 0;
  };
  std::map<std::string, Entry> entries_;
  std::uint64_t clock_ = 0;
  std::size_t made_ = 0;
};

/// Weights as literals, as text for shaders; made once for a set of decoders.
struct DecoderText {
  std::vector<std::shared_ptr<const Decoder>> decoders;
  RenderOptions::Precision precision = RenderOptions::Precision::full;
  std::string text;
};

/// Decoder weights on the GPU when they are fetched from buffers.
struct DecoderTables {
  std::vector<std::shared_ptr<const Decoder>> decoders;
  RenderOptions::Precision precision = RenderOptions::Precision::full;
  int widest_layer = 1;
  gl::Buffer weights_buffer, layout_buffer;
  gl::Texture weights, layout;
};

/// The selected faces of a texture set on the GPU.
struct SelectedFaces {
  std::shared_ptr<const TriangleSet> selection;
  TextureSet source;  ///< with the selection keeps the key's addresses alive
  gl::VertexArray array;
  gl::Buffer indices;
  std::size_t count = 0;
};
using SelectionKey = std::pair<MeshKey, const TriangleSet*>;

struct OcclusionState;

/// Lives as long as the renderer: shaders and buffers that frames share.
struct PassState {
  ProgramCache programs;
  DecoderText text;
  TargetPool targets;
  DecoderTables tables;
  std::map<SelectionKey, SelectedFaces> selected;
  gl::VertexArray empty_array;
  std::shared_ptr<OcclusionState> occlusion;  ///< what `occlusion` knows of earlier frames; null before its first
  OcclusionCounts occlusion_counts;           ///< of this frame, where it ran
};

/// What a pass is given.
struct PassInput {
  const FramePlan& plan;
  const GpuScene& gpu;
  PassState& state;
  const Effect& effect;

  /// The texture's name, 0 where nothing wrote it in this frame. Throws std::logic_error for one that the effect does
  /// not say it reads.
  unsigned read(Target target) const;
  /// From here on drawing goes there. Throws std::logic_error likewise.
  void draw_to(const std::vector<Target>& colors, bool depth) const;
};

}  // namespace rebake
