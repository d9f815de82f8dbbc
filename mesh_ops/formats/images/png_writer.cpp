#include "mesh_ops/formats/images/png_writer.h"

#include <png.h>
#include <zlib.h>

#include <csetjmp>
#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

namespace rebake {

struct PngEncoder::State {
  Sink sink;
  int width = 0, height = 0, channels = 0, compression = 0;
  int rows = 0;  ///< number of rows written so far
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string waiting;  ///< buffer for the sink, since libpng writes a few kilobytes at a time
  std::exception_ptr thrown;

  ~State() { png_destroy_write_struct(&png, &info); }
  void flush() {
    sink(waiting);
    waiting.clear();
  }
  std::size_t stride() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels); }
};

namespace {

using State = PngEncoder::State;

constexpr std::size_t max_waiting = std::size_t{1} << 20;

void append(png_structp png, png_bytep bytes, std::size_t count) {
  State& state = *static_cast<State*>(png_get_io_ptr(png));
  try {
    state.waiting.append(reinterpret_cast<const char*>(bytes), count);
    if (state.waiting.size() >= max_waiting) state.flush();
  } catch (...) {
    state.thrown = std::current_exception();  // exceptions must not pass through libpng
  }
  if (state.thrown) png_error(png, "not written");
}

// libpng reports errors by longjmp, so nothing in these three functions may have a destructor. They return false on an
// error.
bool begin(State& state) {
  if (setjmp(png_jmpbuf(state.png)) != 0) return false;
  png_set_write_fn(state.png, &state, append, nullptr);
  png_set_compression_level(state.png, state.compression);
  // Gives the same bytes as OpenImageIO, which wrote earlier exports.
  png_set_compression_strategy(state.png, Z_DEFAULT_STRATEGY);
  png_set_IHDR(state.png, state.info, static_cast<png_uint_32>(state.width), static_cast<png_uint_32>(state.height), 8,
               state.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_oFFs(state.png, state.info, 0, 0, PNG_OFFSET_PIXEL);
  png_write_info(state.png, state.info);
  return true;
}

bool write(State& state, const std::uint8_t* pixels, std::size_t count) {
  if (setjmp(png_jmpbuf(state.png)) != 0) return false;
  for (std::size_t row = 0; row < count; ++row) png_write_row(state.png, pixels + row * state.stride());
  return true;
}

bool end(State& state) {
  if (setjmp(png_jmpbuf(state.png)) != 0) return false;
  png_write_end(state.png, state.info);
  return true;
}

void check(const State& state, bool whole) {
  if (whole) return;
  if (state.thrown) std::rethrow_exception(state.thrown);
  throw std::bad_alloc();
}

}  // namespace

PngEncoder::PngEncoder(int width, int height, int channels, int compression, Sink sink)
    : state_(std::make_unique<State>()) {
  if ((channels != 3 && channels != 4) || width < 1 || height < 1)
    throw std::invalid_argument("a PNG needs at least one pixel, and 3 (RGB) or 4 (RGBA) channels");
  State& state = *state_;
  state.sink = std::move(sink);
  state.width = width;
  state.height = height;
  state.channels = channels;
  state.compression = compression;
  state.png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, nullptr, [](png_structp of, png_const_charp) { png_longjmp(of, 1); },
      [](png_structp, png_const_charp) {});
  if (state.png != nullptr) state.info = png_create_info_struct(state.png);
  check(state, state.info != nullptr && begin(state));
}
PngEncoder::~PngEncoder() = default;

void PngEncoder::write_rows(std::span<const std::uint8_t> pixels) {
  const std::size_t count = pixels.size() / state_->stride();
  if (count * state_->stride() != pixels.size() ||
      static_cast<std::size_t>(state_->rows) + count > static_cast<std::size_t>(state_->height))
    throw std::invalid_argument("the number of pixels does not match the size of the PNG");
  state_->rows += static_cast<int>(count);
  check(*state_, write(*state_, pixels.data(), count));
}

void PngEncoder::finish() {
  if (state_->rows != state_->height)
    throw std::invalid_argument("the number of pixels does not match the size of the PNG");
  check(*state_, end(*state_));
  state_->flush();
}

std::string encode_png(int width, int height, int channels, std::span<const std::uint8_t> pixels, int compression) {
  std::string result;
  PngEncoder encoder(width, height, channels, compression, [&](std::string_view bytes) { result.append(bytes); });
  encoder.write_rows(pixels);
  encoder.finish();
  return result;
}

}  // namespace rebake
