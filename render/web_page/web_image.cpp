#include "render/web_page/web_image.h"

#include <webp/encode.h>

#include <new>

#include "mesh_ops/formats/images/png_writer.h"

namespace rebake {

namespace {

constexpr int png_level = 9, webp_level = 5;  // webp_level: 0 … 9; 9 takes five times as long for files 2 % smaller

// Empty if the image is too large for the format.
std::string as_webp(int width, int height, const std::vector<std::uint8_t>& rgba) {
  if (width > WEBP_MAX_DIMENSION || height > WEBP_MAX_DIMENSION) return "";
  WebPConfig config;
  WebPPicture picture;
  if (WebPConfigInit(&config) == 0 || WebPPictureInit(&picture) == 0) return "";
  WebPConfigLosslessPreset(&config, webp_level);
  config.exact = 1;
  config.thread_level = 1;
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  std::string bytes;
  if (WebPPictureImportRGBA(&picture, rgba.data(), 4 * width) != 0 && WebPEncode(&config, &picture) != 0)
    bytes.assign(reinterpret_cast<const char*>(writer.mem), writer.size);
  WebPMemoryWriterClear(&writer);
  WebPPictureFree(&picture);
  return bytes;
}

}  // namespace

WebImage web_image(int width, int height, const std::vector<std::uint8_t>& rgba, WebImageCoding coding) {
  std::string webp = coding == WebImageCoding::png ? std::string() : as_webp(width, height, rgba);
  // PNG wins only for images of few texels, which are quick to compress.
  constexpr std::size_t always_smaller = 1 << 20;
  if (!webp.empty() && (rgba.size() > always_smaller || coding == WebImageCoding::webp))
    return {std::move(webp), "webp"};
  std::string png;
  PngEncoder encoder(width, height, 4, png_level, [&](std::string_view piece) { png.append(piece); });
  encoder.write_rows(rgba);
  encoder.finish();
  if (!webp.empty() && webp.size() < png.size()) return {std::move(webp), "webp"};
  return {std::move(png), "png"};
}

}  // namespace rebake
