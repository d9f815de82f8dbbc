// Benchmarks of the main jobs, on the real mic geometry with generated features if REBAKE_TEST_DATA contains it,
// otherwise on a generated sphere. Run build/rebake_benchmarks by hand and compare times of one run only.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <array>
#include <chrono>
#include <numbers>

#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "render/gl/objects.h"
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

// A view from among the nine mics.
View inside_view(const BakedObject& nine) {
  View view;
  view.camera.eye = nine.bounds().center() + Vec3(0, 0.6, 0.2);
  view.camera.target = view.camera.eye + Vec3(1, -0.2, 0.8);
  view.camera.fov_degrees = 60;
  view.camera.far_plane = 30;
  return view;
}

// A view that orbits its target.
class OrbitingView {
 public:
  explicit OrbitingView(const View& view) : view_(view), away_(view.camera.eye - view.camera.target) {}
  View by(double degrees) const {
    View view = view_;
    if (degrees != 0)
      view.camera.eye = view.camera.target + Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitY()) * away_;
    return view;
  }

 private:
  View view_;
  Vec3 away_;
};

// Occlusion culling: off, with the camera at rest, while it orbits by 1° per frame, and with an unknown view in each
// frame. `inside`: nine mics seen from among them, instead of one.
enum class Hidden { drawn, at_rest, turning, jumping };
void hidden_triangles(benchmark::State& state, Hidden hidden, bool inside) {
  static Renderer renderer;
  static const auto tiled_subject = tiled(*subject());
  View view;
  if (inside) {
    view = inside_view(*tiled_subject);
  } else {
    view.camera.near_plane = 2;
    view.camera.far_plane = 6;
  }
  const Scene scene = scene_of(inside ? tiled_subject : subject());
  RenderOptions options;
  options.occlusion = hidden == Hidden::drawn ? RenderOptions::Occlusion::off : RenderOptions::Occlusion::on;
  const OrbitingView turn(view);
  double degrees = 0;
  renderer.time_frame(scene, view, options, false);
  renderer.time_frame(scene, view, options, false);
  for (auto _ : state) {
    if (hidden == Hidden::turning) degrees += 1;
    if (hidden == Hidden::jumping) degrees += 97;
    renderer.time_frame(scene, turn.by(degrees), options, false);
  }
}
BENCHMARK_CAPTURE(hidden_triangles, drawn, Hidden::drawn, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, at_rest, Hidden::at_rest, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, turning, Hidden::turning, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, jumping, Hidden::jumping, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, inside_drawn, Hidden::drawn, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, inside_at_rest, Hidden::at_rest, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, inside_turning, Hidden::turning, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(hidden_triangles, inside_jumping, Hidden::jumping, true)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// 100,000 nodes of one object of 20 triangles.
void many_instances(benchmark::State& state) {
  const auto one = made_object({.columns = 5, .rows = 2, .cell = 5, .radius = 0.03});
  Scene scene;
  scene.roots.reserve(100'000);
  for (int k = 0; k < 100'000; ++k) {
    Node node;
    node.id = static_cast<NodeId>(k + 1);
    node.name = std::to_string(k);
    node.object = one;
    node.to_parent.translation() = 0.1 * Vec3(k % 50 - 25, k / 50 % 50 - 25, k / 2500 - 20);
    scene.roots.push_back(std::make_shared<const Node>(std::move(node)));
  }
  scene.next_id = 100'001;
  View view;
  view.camera.eye = {4, 3, 6};
  Renderer renderer;
  RenderOptions options;
  options.occlusion = state.range(0) != 0 ? RenderOptions::Occlusion::on : RenderOptions::Occlusion::off;
  for (auto _ : state) renderer.time_frame(scene, view, options, false);
}
BENCHMARK(many_instances)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

TriangleSet left_half(const Soup& soup) {
  std::vector<double> along;
  for (const Face& face : soup.faces()) along.push_back(soup.positions()[face[0]].x());
  std::vector<double> sorted = along;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
  TriangleSet keep(soup.triangle_count(), 0);
  for (std::size_t f = 0; f < keep.size(); ++f) keep[f] = along[f] < sorted[sorted.size() / 2] ? 1 : 0;
  return keep;
}

// GPU memory of a scene without the picture's buffers, in MB. Argument 1: with half of its triangles deleted.
void gpu_memory(benchmark::State& state) {
  auto object = std::make_shared<BakedObject>(*subject());
  if (state.range(0) != 0) {
    const Soup& soup = object->sets[0].soup;
    const TriangleSet keep = left_half(soup);
    object->sets[0].soup = subset(soup, keep, 0, true);
  }
  View view;
  view.width = view.height = 16;
  std::uint64_t held = 0;
  for (auto _ : state) {
    const std::uint64_t before = gl::memory_use().now;
    Renderer renderer;
    renderer.time_frame(scene_of(object), view, {}, false);
    held = gl::memory_use().now - before;
  }
  state.counters["megabytes"] = static_cast<double>(held) / 1e6;
}
BENCHMARK(gpu_memory)->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond)->UseRealTime();

// Eight mics with their own textures and real features, seen from among them, with plain texels (8 bytes) or coded
// ones: frame time, and GPU memory without the picture's buffers in MB. Arguments: 1 for half of each deleted; 1 for a
// view that orbits.
void many_textures(benchmark::State& state, RenderOptions::Texels texels) {
  static const std::array<std::shared_ptr<const BakedObject>, 2> objects = [] {
    std::array<std::shared_ptr<const BakedObject>, 2> made;
    auto object = std::make_shared<BakedObject>(*tiled(*subject()));
    object->sets.pop_back();
    for (std::size_t k = 0; k < object->sets.size(); ++k) {
      TextureSet& set = object->sets[k];
      if (auto real =
              with_real_features(*set.texels, k % 2 == 0 ? "lego_ball" : "lego_tractor", 100 * static_cast<int>(k)))
        set.texels = std::move(real);
      else
        set.texels = made_features(set.soup, set.texels->width(), set.texels->height(), static_cast<unsigned>(k) + 5);
    }
    made[0] = object;
    auto half = std::make_shared<BakedObject>(*object);
    for (TextureSet& set : half->sets) set.soup = subset(set.soup, left_half(set.soup), 0, true);
    made[1] = half;
    return made;
  }();
  const Scene scene = scene_of(objects.at(static_cast<std::size_t>(state.range(0))));
  const bool turning = state.range(1) != 0;
  View view = inside_view(*objects[0]);
  RenderOptions options;
  options.texels = texels;
  const std::uint64_t before = gl::memory_use().now;
  Renderer renderer;
  {
    View small = view;
    small.width = small.height = 16;
    const auto start = std::chrono::steady_clock::now();
    renderer.time_frame(scene, small, options, false);
    state.counters["first_ms"] =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    state.counters["megabytes"] = static_cast<double>(gl::memory_use().now - before) / 1e6;
  }
  const OrbitingView turn(view);
  renderer.time_frame(scene, view, options, false);
  renderer.time_frame(scene, view, options, false);
  double degrees = 0;
  for (auto _ : state) renderer.time_frame(scene, turn.by(turning ? ++degrees : 0), options, false);
}
BENCHMARK_CAPTURE(many_textures, plain, RenderOptions::Texels::plain)
    ->Args({0, 0})
    ->Args({0, 1})
    ->Args({1, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(many_textures, coded, RenderOptions::Texels::coded)
    ->Args({0, 0})
    ->Args({0, 1})
    ->Args({1, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Time from an eraser's stroke of 20×20 texels to the next picture.
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

// First picture of an object that comes into view, with a new decoder. Argument 1: its programs were compiled in
// advance. Run with the driver's cache of programs disabled (MESA_SHADER_CACHE_DISABLE=1).
void first_look(benchmark::State& state) {
  Scene scene = scene_of(made_object({.seed = 1}));
  Node other;
  other.object = made_object({.seed = 2});
  other.to_parent.translation() = Vec3(100, 0, 0);
  scene = with_added(scene, other, NodeId::none, 9);
  View there;
  there.camera.eye += other.to_parent.translation();
  there.camera.target += other.to_parent.translation();
  for (auto _ : state) {
    state.PauseTiming();
    auto renderer = std::make_unique<Renderer>();
    renderer->time_frame(scene, {}, {}, false);
    while (state.range(0) != 0 && renderer->compile_next_program(scene, {}, {}, nullptr)) {
    }
    state.ResumeTiming();
    renderer->time_frame(scene, there, {}, false);
    state.PauseTiming();
    renderer.reset();
    state.ResumeTiming();
  }
}
BENCHMARK(first_look)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseRealTime();

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
