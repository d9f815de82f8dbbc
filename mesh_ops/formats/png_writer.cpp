#include "mesh_ops/formats/png_writer.h"

#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <new>
#include <stdexcept>

namespace rebake {

namespace {

void append(png_structp png, png_bytep bytes, std::size_t count) {
  bool full = false;
  try {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<const char*>(bytes), count);
  } catch (const std::bad_alloc&) {
    full = true;  // no exception passes through libpng
  }
  if (full) png_error(png, "no memory");
}

// libpng leaves by longjmp: nothing here has a destructor.
bool encode(png_structp png, png_infop info, int width, int height, int channels, const std::uint8_t* pixels,
            int compression, std::string* to) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_set_write_fn(png, to, append, nullptr);
  png_set_compression_level(png, compression);
  // As OpenImageIO writes PNGs, to the byte: earlier exports were written by it.
  png_set_compression_strategy(png, Z_DEFAULT_STRATEGY);
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8,
               channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_oFFs(png, info, 0, 0, PNG_OFFSET_PIXEL);
  png_write_info(png, info);
  const std::size_t stride = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  for (int y = 0; y < height; ++y) png_write_row(png, pixels + static_cast<std::size_t>(y) * stride);
  png_write_end(png, info);
  return true;
}

}  // namespace

std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels, int compression) {
  if ((channels != 3 && channels != 4) || width < 1 || height < 1 ||
      pixels.size() !=
          static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(channels))
    throw std::invalid_argument("pixels of another size");
  std::string result;
  png_structp png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, nullptr, [](png_structp of, png_const_charp) { png_longjmp(of, 1); },
      [](png_structp, png_const_charp) {});
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  const bool whole = info != nullptr && encode(png, info, width, height, channels, pixels.data(), compression, &result);
  png_destroy_write_struct(&png, &info);
  if (!whole) throw std::bad_alloc();
  return result;
}

}  // namespace rebake
