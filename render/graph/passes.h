#pragma once

#include <map>
#include <optional>
#include <string>

#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/targets.h"

namespace rebake {

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
  Soup source;  ///< with the selection keeps the key's addresses alive
  gl::VertexArray array;
  gl::Buffer indices;
  std::size_t count = 0;
};
using SelectionKey = std::pair<MeshKey, const TriangleSet*>;

struct OcclusionState;

/// Lives as long as the renderer: shaders and buffers that frames share.
struct PassState {
  std::map<std::string, gl::Program> programs;  ///< by their full source
  TargetPool targets;
  DecoderTables tables;
  std::map<SelectionKey, SelectedFaces> selected;
  gl::VertexArray empty_array;
  std::shared_ptr<OcclusionState> occlusion;  ///< what `occlusion` knows of the last frame; null before its first
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
