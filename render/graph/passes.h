#pragma once

#include <map>
#include <optional>
#include <string>

#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/targets.h"

namespace rebake {

/// LRU cache of up to 64 shader programs, keyed by file names and preamble (which contains constant decoder weights).
class ProgramCache {
 public:
  /// The program of two files in shaders/ with a common preamble; compiled on a cache miss. Throws DeviceError.
  const gl::Program& get(const std::string& vertex, const std::string& fragment, const std::string& preamble);
  std::size_t size() const { return entries_.size(); }
  /// Number of compiled programs so far, evicted ones included.
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

/// Cached GLSL text of the current decoders with weights as literals.
struct DecoderText {
  std::vector<std::shared_ptr<const Decoder>> decoders;
  RenderOptions::Precision precision = RenderOptions::Precision::full;
  RenderOptions::Arithmetic arithmetic = RenderOptions::Arithmetic::scalars;
  std::string text;
};

/// Weights of the current decoders in GPU buffers, for RenderOptions::Weights::buffer.
struct DecoderTables {
  std::vector<std::shared_ptr<const Decoder>> decoders;
  RenderOptions::Precision precision = RenderOptions::Precision::full;
  int widest_layer = 1;  ///< largest hidden width
  gl::Buffer weights_buffer, layout_buffer;
  gl::Texture weights, layout;
};

/// Index buffer of the selected faces of a texture set.
struct SelectedFaces {
  std::shared_ptr<const TriangleSet> selection;
  TextureSet source;  ///< with `selection`, keeps alive the arrays whose addresses are in the key
  gl::VertexArray array;
  gl::Buffer indices;
  std::size_t count = 0;  ///< number of indices
};
/// Identity of SelectedFaces: mesh, and address of the selection.
using SelectionKey = std::pair<MeshKey, const TriangleSet*>;

struct OcclusionState;

/// Data that passes share and keep between frames; one per renderer.
struct PassState {
  ProgramCache programs;
  DecoderText text;
  TargetPool targets;
  DecoderTables tables;
  std::map<SelectionKey, SelectedFaces> selected;
  gl::VertexArray empty_array;                ///< for draw calls without vertex attributes
  std::shared_ptr<OcclusionState> occlusion;  ///< visibility in earlier frames; null before the first culled frame
  OcclusionCounts occlusion_counts;           ///< of the last frame with occlusion culling
};

/// Arguments of Effect::execute.
struct PassInput {
  const FramePlan& plan;
  const GpuScene& gpu;
  PassState& state;
  const Effect& effect;

  /// OpenGL name of a target's texture; 0 if no effect writes it in this frame. Throws std::logic_error if the effect
  /// does not declare the target in Effect::reads.
  unsigned read(Target target) const;
  /// Binds these targets for drawing, with the depth target if `depth`. Throws std::logic_error if the effect does not
  /// declare them in Effect::writes.
  void draw_to(const std::vector<Target>& colors, bool depth) const;
};

}  // namespace rebake
