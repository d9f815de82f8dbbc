#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "editor/gui/window/child_process.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/camera.h"

namespace rebake {

/// Pictures along a way of the camera: in a folder as 000.png, 001.png, …, or a video that ffmpeg makes of them.
class Film {
 public:
  static constexpr int rate = 25;  ///< pictures a second of a video

  /// A video where `out` ends in .mp4, else a folder. Throws Error where it cannot be written there, and for a video
  /// without ffmpeg.
  Film(std::filesystem::path out, int width, int height, std::vector<Camera> cameras, const SourceGuard& sources);
  ~Film();

  int width() const { return width_; }
  int height() const { return height_; }
  /// "Picture 3 of 36", "Making the video".
  std::string doing() const;
  /// Has the next picture written by `write`, or looks whether ffmpeg is done. What there is to say once all is, else
  /// nothing. Throws Error.
  std::string go_on(const std::function<void(const Camera&, const std::filesystem::path&)>& write,
                    const SourceGuard& sources);
  /// Whether it only waits for ffmpeg.
  bool waits() const { return encoder_ != nullptr; }
  /// What is there when it is stopped now.
  std::string stopped() const;

 private:
  bool video() const { return !pictures_.empty() && pictures_ != out_; }
  std::filesystem::path out_, pictures_;  ///< what people asked for; the folder of its pictures
  int width_, height_;
  std::vector<Camera> cameras_;
  std::size_t next_ = 0;
  std::unique_ptr<ChildProcess> encoder_;
};

}  // namespace rebake
