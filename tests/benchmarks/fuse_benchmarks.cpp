// Fuses two real decoders to one plain folder: a million texels as in typical exports, and ten million for the time per
// texel. Memory is that of the whole process, so run one benchmark at a time (--benchmark_filter). Without
// REBAKE_TEST_DATA, generated spheres are used.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include "mesh_ops/features/distill/fuse.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

double peak_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

// Rows of two objects, the second rotated.
Scene two_decoders(int quads, int rows) {
  const auto object = [&](const char* name, unsigned seed) {
    const auto real = morpheus_object(name, quads);
    return real ? real : made_object({.columns = quads, .rows = quads, .seed = seed});
  };
  const auto ball = object("lego_ball", 1), tractor = object("lego_tractor", 2);
  Scene scene;
  for (int k = 0; k < rows; ++k) {
    Node node;
    node.name = "ball";
    node.object = ball;
    node.to_parent = Eigen::Translation3d(-1.2, 0, 2.4 * k);
    scene = with_added(scene, node, NodeId::none, 999);
    node.name = "tractor";
    node.object = tractor;
    node.to_parent = Eigen::Translation3d(1.2, 0, 2.4 * k) * Eigen::AngleAxisd(1.1, Vec3(1, 2, 0.5).normalized());
    scene = with_added(scene, node, NodeId::none, 999);
  }
  return scene;
}

void fuse_scene(benchmark::State& state, const FuseOptions& options) {
  const Scene scene = two_decoders(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const double before = peak_bytes();
  for (auto _ : state) {
    const Composition composition = composed(scene, 4096);
    const VisibleDirections sightlines(scene);
    const Fused fused = fuse(composition, sightlines, plan_fuse(composition, sightlines, options), options);
    const auto texels = static_cast<double>(composition.opaque_texels);
    state.counters["texels"] = texels;
    state.counters["bytes_a_texel"] = (peak_bytes() - before) / texels;
    state.counters["dB"] = fused.report.whole.psnr_db;
    state.counters["width"] = static_cast<double>(fused.object->decoder->hidden0());
  }
}

void fuse_automatic(benchmark::State& state) { fuse_scene(state, {}); }
void fuse_width_16(benchmark::State& state) {
  FuseOptions options;
  options.width = 16;
  options.keep = FuseOptions::Keep::none;
  fuse_scene(state, options);
}
BENCHMARK(fuse_automatic)->Args({42, 1})->Args({60, 5})->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK(fuse_width_16)->Args({42, 1})->Args({60, 5})->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace rebake::test
