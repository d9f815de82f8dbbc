// Milliseconds of the main jobs on the real mic geometry (features made up) where ../shared is at hand, else on a made
// sphere. Not timed tests: run build/rebake_benchmarks by hand and compare within one run.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include "mesh_ops/formats/baked_folder.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/obj.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

std::shared_ptr<const BakedObject> subject() {
  static const auto object = [] {
    const auto mic = mic_object();
    return mic ? mic : made_object({.columns = 256, .rows = 160});
  }();
  return object;
}

const std::filesystem::path& subject_folder() {
  static const TemporaryFolder temporary;
  static const std::filesystem::path folder = [] {
    export_scene(scene_of(subject()), temporary.path() / "subject", {});
    return temporary.path() / "subject";
  }();
  return folder;
}

void load(benchmark::State& state) {
  subject_folder();
  for (auto _ : state) benchmark::DoNotOptimize(read_baked_folder(subject_folder(), Axes::y_up));
}
BENCHMARK(load)->Unit(benchmark::kMillisecond)->UseRealTime();

void parse_obj_in_64_chunks(benchmark::State& state) {
  const Soup& soup = subject()->sets[0].soup;
  const std::string chunk = write_obj(soup.positions(), soup.uvs(), soup.faces(), 0, soup.faces().size() / 8);
  for (auto _ : state) tbb::parallel_for(0, 64, [&](int) { benchmark::DoNotOptimize(read_obj(chunk, "chunk.obj")); });
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * 64 * chunk.size()));
}
BENCHMARK(parse_obj_in_64_chunks)->Unit(benchmark::kMillisecond)->UseRealTime();

void frame(benchmark::State& state, RenderOptions::Weights weights, RenderOptions::Shading shading) {
  static Renderer renderer;
  View view;  // the published viewer's camera for synthetic scenes
  view.camera.near_plane = 2;
  view.camera.far_plane = 6;
  view.samples = static_cast<int>(state.range(0));
  const Scene scene = scene_of(subject());
  const RenderOptions options{weights, shading, RenderOptions::Precision::full};
  renderer.time_frame(scene, view, options, false);
  for (auto _ : state) renderer.time_frame(scene, view, options, false);
}
using Weights = RenderOptions::Weights;
using Shading = RenderOptions::Shading;
BENCHMARK_CAPTURE(frame, deferred_constants, Weights::constants, Shading::deferred)
    ->Arg(1)
    ->Arg(4)
    ->Arg(16)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(frame, deferred_buffer, Weights::buffer, Shading::deferred)
    ->Arg(1)
    ->Arg(4)
    ->Arg(16)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(frame, forward_constants, Weights::constants, Shading::forward)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(frame, forward_buffer, Weights::buffer, Shading::forward)
    ->Arg(1)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// From an erased disk of texels to the next picture; and as if the whole texture were new.
void erase_stroke(benchmark::State& state) {
  Renderer renderer;
  const View view;
  std::shared_ptr<const FeatureTexture> texels = subject()->sets[0].texels;
  const auto scene_with = [&] {
    auto object = std::make_shared<BakedObject>(*subject());
    object->sets[0].texels = texels;
    return scene_of(object);
  };
  renderer.time_frame(scene_with(), view, {}, false);
  int at = 0;
  double still = 0;
  for (auto _ : state) {
    state.PauseTiming();
    still += renderer.time_frame(scene_with(), view, {}, false).frame_ms;
    FeatureTexture::Change change(*texels);
    at = (at + 97) % (texels->width() - 20);
    for (int y = at; y < at + 20; ++y)
      for (int x = at; x < at + 20; ++x) change.at(x, y).feat0[0] = 0;
    texels = change.finish();
    const Scene next = scene_with();
    state.ResumeTiming();
    renderer.time_frame(next, view, {}, false);
  }
  state.counters["frame_alone_ms"] = still / static_cast<double>(state.iterations());
}
BENCHMARK(erase_stroke)->Unit(benchmark::kMillisecond)->UseRealTime();

void export_unedited(benchmark::State& state) {
  const TemporaryFolder out;
  Node node;
  node.object = read_baked_folder(subject_folder(), Axes::y_up);
  const Scene scene = with_added({}, node, NodeId::none, 0);
  for (auto _ : state) export_scene(scene, out.path() / "out", {});
}
BENCHMARK(export_unedited)->Unit(benchmark::kMillisecond)->UseRealTime();

void export_half(benchmark::State& state) {
  const TemporaryFolder out;
  auto object = std::make_shared<BakedObject>(*subject());
  TriangleSet keep(object->triangle_count(), 0);
  std::fill(keep.begin(), keep.begin() + static_cast<std::ptrdiff_t>(keep.size() / 2), 1);
  object->sets[0].soup = subset(object->sets[0].soup, keep, 0, true);
  const Scene scene = scene_of(object);
  for (auto _ : state) export_scene(scene, out.path() / "out", {});
}
BENCHMARK(export_half)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace rebake::test
