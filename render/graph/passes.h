#pragma once

#include <map>
#include <optional>
#include <string>

#include "render/gl/objects.h"
#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/plan.h"

namespace rebake {

/// Buffers of one frame; those that the plan does not call for stay empty.
struct FrameTargets {
  int width = 0, height = 0, side = 1;  ///< picture size and samples along a pixel's side
  bool has_features = false, has_frames = false, has_rays = false;
  gl::Texture picture;   ///< RGBA8
  gl::Texture features;  ///< RG32UI, a sample's 8 feature bytes
  gl::Texture frames;    ///< R16UI, index into FramePlan::frames
  gl::Texture rays;      ///< RGBA32F, fed direction of turned triangles, else 0
  gl::Texture depth;
  gl::Texture mask;  ///< R8, selected triangles
  gl::Framebuffer mask_buffer;
  gl::Framebuffer overlay_buffer;  ///< picture without depth
  gl::Framebuffer sample_buffer;   ///< features, frames, rays and depth
  gl::Framebuffer picture_buffer;  ///< picture, and depth for forward shading
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
  Soup source;  ///< with the selection keeps the key's addresses alive
  gl::VertexArray array;
  gl::Buffer indices;
  std::size_t count = 0;
};
using SelectionKey = std::pair<MeshKey, const TriangleSet*>;

/// Lives as long as the renderer: shaders and buffers that frames share.
struct PassState {
  std::map<std::string, gl::Program> programs;  ///< by their full source
  FrameTargets targets;
  DecoderTables tables;
  std::map<SelectionKey, SelectedFaces> selected;
  gl::VertexArray empty_array;
};

/// What a pass is given.
struct PassInput {
  const FramePlan& plan;
  const GpuScene& gpu;
  PassState& state;
};

/// A pass that the plan can call for by name.
struct Pass {
  const char* name;
  void (*execute)(const PassInput&);
};

void execute_geometry(const PassInput& input);
void execute_resolve(const PassInput& input);
void execute_forward(const PassInput& input);
void execute_inspect(const PassInput& input);
void execute_selection(const PassInput& input);
void execute_guides(const PassInput& input);

/// In the order in which they run.
inline constexpr Pass pass_table[] = {
    {"geometry", execute_geometry}, {"resolve", execute_resolve},     {"forward", execute_forward},
    {"inspect", execute_inspect},   {"selection", execute_selection}, {"guides", execute_guides},
};

}  // namespace rebake
