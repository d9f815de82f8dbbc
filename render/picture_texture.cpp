#include "render/picture_texture.h"

#include <epoxy/gl.h>

#include "render/gl/objects.h"

namespace rebake {

class PictureTexture::Impl {
 public:
  gl::Texture texture;
};

PictureTexture::PictureTexture(const Image& image)
    : impl_(std::make_unique<Impl>(Impl{gl::make_texture(GL_RGBA8, image.width, image.height, 4)})) {
  GLint bound = 0, alignment = 4;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  glGetIntegerv(GL_UNPACK_ALIGNMENT, &alignment);
  glBindTexture(GL_TEXTURE_2D, impl_->texture.name());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE, image.rgb.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, alignment);
  glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(bound));
}
PictureTexture::~PictureTexture() = default;
PictureTexture::PictureTexture(PictureTexture&&) noexcept = default;
PictureTexture& PictureTexture::operator=(PictureTexture&&) noexcept = default;

unsigned PictureTexture::name() const { return impl_->texture.name(); }

}  // namespace rebake
