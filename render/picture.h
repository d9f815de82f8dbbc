#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"
#include "render/image.h"

namespace rebake {

/// Wall-clock times of one frame in milliseconds. If passes are timed, the GPU finishes each before the next begins.
struct FrameTimes {
  double frame_ms = 0;
  std::map<std::string, double> pass_ms;  ///< by Effect::name; empty unless passes were timed
};

namespace gl {
class Context;
}

/// Renders scenes with OpenGL. GPU data stay resident between pictures. Not thread-safe, except for prepare().
class Renderer {
 public:
  /// Renders in a headless context. Throws DeviceError if OpenGL is not available.
  Renderer();
  /// Renders in the given context, such as that of a window, and creates all OpenGL objects there.
  explicit Renderer(std::unique_ptr<gl::Context> context);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws a picture and reads it back. `lighting`: corrections of colours, null for none.
  Image render(const Scene& scene, const View& view, const RenderOptions& options = {},
               const Lighting* lighting = nullptr);

  /// Compiles programs in advance that other views of this scene may need, because a driver may take 0.1 s per program.
  /// Each call draws one small frame off screen. Returns false if all programs are compiled.
  bool compile_next_program(const Scene& scene, const View& view, const RenderOptions& options,
                            const Lighting* lighting);
  /// Number of frames that had to compile a program while they were drawn.
  std::size_t compile_stall_count() const;

  /// Prepares uploads of the next picture of a scene on the CPU, so that it is drawn sooner. Callable from any thread.
  void prepare(const Scene& scene);

  /// Uploads a slice of the data of a scene that is not drawn yet, for about `milliseconds`. The current scene stays
  /// resident. Returns the uploaded share, 0 … 1; 1 also if the GPU cannot hold both scenes. Drawing the new scene
  /// uploads the rest at once.
  double upload_slice(const Scene& scene, double milliseconds);
  /// Evicts the data uploaded by upload_slice(), if that scene will not be drawn.
  void evict_staged();

  /// Draws a frame without reading it back. `each_pass`: time each pass (fills pass_ms), otherwise the frame as a
  /// whole.
  FrameTimes time_frame(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass,
                        const Lighting* lighting = nullptr);

  /// A picture in a texture, for display.
  struct Shown {
    unsigned texture;  ///< OpenGL name: RGBA8, size of the view, bottom row first; valid until the next picture
    FrameTimes times;
    std::vector<PlannedPass> passes;
    bool kept = false;  ///< only changed pixels were drawn
  };
  /// Draws a picture with `guides` over it and leaves it on the GPU. `each_pass` as in time_frame().
  Shown show(const Scene& scene, const View& view, const RenderOptions& options, const Guides& guides, bool each_pass,
             const Lighting* lighting = nullptr);
  /// Whether show() with default options would draw only the pixels that changed since the last picture.
  bool keeps(const Scene& scene, const View& view, const Guides& guides, const Lighting* lighting) const;
  /// Reads back the picture drawn last.
  Image shown_image();

  /// Effects of the last picture, whether they ran and why, with the results of occlusion culling.
  const std::vector<PlannedPass>& passes() const;

  std::string device() const;  ///< gl::device_name() of its context
  gl::Context& context();      ///< for other drawing on the same device, while this object draws nothing
  /// Peak memory of all buffers and textures of this process, in bytes.
  std::uint64_t peak_gpu_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
