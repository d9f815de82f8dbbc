#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/base/child_process.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/camera.h"

namespace rebake {

/// Rendering job for a camera animation: a folder of pictures 000.png, 001.png, …, or a video that ffmpeg encodes from
/// them.
class CameraAnimation {
 public:
  static constexpr int rate = 25;  ///< frames per second of a video

  /// A video if `out` ends in .mp4, else a folder. `width`, `height` in pixels, made even for a video. Throws Error if
  /// `out` is protected by `sources` or cannot be created, or if a video is requested without ffmpeg.
  CameraAnimation(std::filesystem::path out, int width, int height, std::vector<Camera> cameras,
                  const SourceGuard& sources);
  /// Stops ffmpeg and removes a video's pictures.
  ~CameraAnimation();

  int width() const { return width_; }
  int height() const { return height_; }
  /// Progress for the status bar: "Picture 3 of 36" or "Making the video".
  std::string doing() const;
  /// Does one step: writes the next picture by `write`, or checks whether ffmpeg has ended. Returns a message when all
  /// is done, else an empty string. Throws Error.
  std::string run_step(const std::function<void(const Camera&, const std::filesystem::path&)>& write,
                       const SourceGuard& sources);
  /// Whether all pictures are written and ffmpeg is running.
  bool waits() const { return encoder_ != nullptr; }
  /// Message for a job that is cancelled now: which pictures exist.
  std::string stopped() const;

 private:
  bool video() const { return !pictures_.empty() && pictures_ != out_; }
  std::filesystem::path out_, pictures_;  ///< requested output; folder of the pictures
  int width_, height_;
  std::vector<Camera> cameras_;
  std::size_t next_ = 0;  ///< index of the next picture
  std::unique_ptr<ChildProcess> encoder_;
};

}  // namespace rebake
