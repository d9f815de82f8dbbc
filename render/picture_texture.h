#pragma once

#include <memory>

#include "render/image.h"

namespace rebake {

/// A texture that holds an image, usable in the OpenGL context that was current at its construction.
class PictureTexture {
 public:
  /// Uploads the image as RGBA8, top row first. Throws DeviceError if the GPU cannot hold it.
  explicit PictureTexture(const Image& image);
  ~PictureTexture();
  PictureTexture(PictureTexture&&) noexcept;
  PictureTexture& operator=(PictureTexture&&) noexcept;
  unsigned name() const;  ///< OpenGL name

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
