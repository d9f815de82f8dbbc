#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/graph/plan.h"
#include "render/image.h"

namespace rebake {

/// Wall-clock milliseconds of one frame. Passes are timed by finishing each before the next begins.
struct FrameTimes {
  double frame_ms = 0;
  std::map<std::string, double> pass_ms;
};

namespace gl {
class Context;
}

/// Draws scenes. Keeps what it uploaded for the next picture; not for use from several threads at
/// once.
class Renderer {
 public:
  /// Without a window. Throws DeviceError where there is no OpenGL.
  Renderer();
  /// In a context that is there already, e.g. a window's, which goes on to own what this makes.
  explicit Renderer(std::unique_ptr<gl::Context> context);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// With `lighting`, colours change as it says.
  Image render(const Scene& scene, const View& view, const RenderOptions& options = {},
               const Lighting* lighting = nullptr);

  /// Makes the next of the programs that other views of this scene would want, and were not made yet: a driver may take
  /// a tenth of a second for one. False where there are none. Changes nothing that is shown.
  bool make_ahead(const Scene& scene, const View& view, const RenderOptions& options, const Lighting* lighting);
  /// How often a frame had to have programs made, of all that were drawn to be seen.
  std::size_t frames_that_compiled() const;

  /// Works out what the next picture of a scene will upload, so that it takes less time. From any thread.
  void prepare(const Scene& scene);

  /// Uploads some of what the next picture of a scene needs, for about `milliseconds`, while another scene goes on
  /// being drawn; returns how much of it is there, from 0 to 1. Drawing it earlier uploads the rest at once.
  double arrive(const Scene& scene, double milliseconds);
  /// Lets go of what arrived, where that scene is not drawn after all.
  void forget_arrival();

  /// Draws a frame and leaves it on the GPU. With `each_pass`, waits for each pass and fills pass_ms; else the frame as
  /// a whole.
  FrameTimes time_frame(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass,
                        const Lighting* lighting = nullptr);

  /// Draws with `guides` over the picture and leaves it on the GPU, to be shown by its texture: RGBA8 of the view's
  /// size, bottom row first, until the next picture is drawn. `times.pass_ms` is filled with `each_pass`.
  struct Shown {
    unsigned texture;
    FrameTimes times;
    std::vector<PlannedPass> passes;
    bool kept = false;  ///< only the pixels that changed were drawn
  };
  Shown show(const Scene& scene, const View& view, const RenderOptions& options, const Guides& guides, bool each_pass,
             const Lighting* lighting = nullptr);
  /// Whether only the pixels that changed since the last picture would be drawn: sooner than a whole one.
  bool keeps(const Scene& scene, const View& view, const Guides& guides, const Lighting* lighting) const;
  /// The picture shown last.
  Image shown_image();

  /// Of the picture drawn last: what ran and why, with what looking for hidden triangles found.
  const std::vector<PlannedPass>& passes() const;

  std::string device() const;
  /// Most bytes held on the GPU at once so far.
  std::uint64_t peak_gpu_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
