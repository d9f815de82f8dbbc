#pragma once

#include <cstdint>
#include <memory>

#include "editor/studies/representations/plenoctree.h"
#include "editor/studies/representations/snerg_scene.h"
#include "render/gl/context.h"
#include "render/gl/pixel_program.h"
#include "render/graph/render_view.h"
#include "render/image.h"

namespace rebake {

/// A volume on the GPU, drawn by marching a ray per sample of a pixel. Only pinhole cameras; planes do not clip.
class MarchedVolume {
 public:
  /// Uploads a volume. `context` must outlive the object. Throws DeviceError if the device cannot hold it.
  MarchedVolume(const SnergScene& scene, gl::Context& context);
  MarchedVolume(const PlenOctree& tree, gl::Context& context);
  ~MarchedVolume();
  MarchedVolume(const MarchedVolume&) = delete;
  MarchedVolume& operator=(const MarchedVolume&) = delete;

  /// Draws a picture and reads it back.
  Image picture(const View& view);
  /// Draws a picture without reading it back, and waits for it. Returns milliseconds of wall-clock time.
  double draw(const View& view);
  /// Memory of its textures and buffers.
  std::uint64_t gpu_bytes() const;

 private:
  void aim(const View& view);

  gl::Context& context_;
  std::unique_ptr<gl::PixelProgram> program_;
};

}  // namespace rebake
