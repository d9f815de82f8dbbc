// Decoding of feature textures: the fast path against libspng (if installed) and OpenImageIO.
#include <benchmark/benchmark.h>

#include <vector>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/rgba_png.h"

#ifdef REBAKE_SPNG
#include <spng.h>
#endif

namespace rebake::test {
namespace {

const std::filesystem::path& file() {
  static const std::filesystem::path path =
      std::filesystem::path(REBAKE_SOURCE) / "samples/scenes/ficus/shape0.pngfeat0.png";
  return path;
}
const std::string& bytes() {
  static const std::string all = read_file(file());
  return all;
}

void decode_by_rebake(benchmark::State& state) {
  for (auto _ : state) {
    const auto rows = open_rgba_png(bytes(), file());
    for (int y = 0; y < rows->height(); y += 4) {
      rows->read(4);
      benchmark::DoNotOptimize(rows->row(0));
    }
  }
}
BENCHMARK(decode_by_rebake)->Unit(benchmark::kMillisecond);

void decode_by_openimageio(benchmark::State& state) {
  const PictureCodecs& codecs = picture_codecs(file());
  std::vector<std::uint8_t> texels;
  std::string error;
  for (auto _ : state) {
    const auto reader = codecs.open_memory("png", bytes(), file().string(), error);
    const PictureLayout& layout = reader->layout();
    texels.resize(static_cast<std::size_t>(layout.width) * static_cast<std::size_t>(layout.height) * 4);
    if (!reader->read(0, layout.height, 4, texels.data())) state.SkipWithError("cannot be decoded");
  }
}
BENCHMARK(decode_by_openimageio)->Unit(benchmark::kMillisecond);

#ifdef REBAKE_SPNG
void decode_by_libspng(benchmark::State& state) {
  std::vector<std::uint8_t> texels;
  for (auto _ : state) {
    spng_ctx* const context = spng_ctx_new(0);
    spng_set_png_buffer(context, bytes().data(), bytes().size());
    std::size_t size = 0;
    spng_decoded_image_size(context, SPNG_FMT_RGBA8, &size);
    texels.resize(size);
    if (spng_decode_image(context, texels.data(), size, SPNG_FMT_RGBA8, 0) != 0)
      state.SkipWithError("cannot be decoded");
    spng_ctx_free(context);
  }
}
BENCHMARK(decode_by_libspng)->Unit(benchmark::kMillisecond);
#endif

}  // namespace
}  // namespace rebake::test
