#pragma once

#include <memory>

#include "render/image.h"

namespace rebake {

/// An image on the GPU, to be shown in the context in which it was made.
class PictureTexture {
 public:
  /// RGBA8, top row first. Throws DeviceError.
  explicit PictureTexture(const Image& image);
  ~PictureTexture();
  PictureTexture(PictureTexture&&) noexcept;
  PictureTexture& operator=(PictureTexture&&) noexcept;
  unsigned name() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rebake
