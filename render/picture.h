#pragma once

#include <map>
#include <memory>
#include <string>

#include "render/frame/plan.h"
#include "render/image.h"

namespace rebake {

/// Wall-clock milliseconds of one frame. Passes are timed by finishing each before the next begins.
struct FrameTimes {
  double frame_ms = 0;
  std::map<std::string, double> pass_ms;
};

/// Draws scenes without a window. Keeps what it uploaded for the next picture; not for use from several threads at
/// once.
class Renderer {
 public:
  /// Throws DeviceError where there is no OpenGL.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image render(const Scene& scene, const View& view, const RenderOptions& options = {});

  /// Draws a frame and leaves it on the GPU. With `each_pass`, waits for each pass and fills pass_ms; else the frame as
  /// a whole.
  FrameTimes time_frame(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass);

  std::string device() const;
  /// Most bytes held on the GPU at once so far.
  std::uint64_t peak_gpu_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
