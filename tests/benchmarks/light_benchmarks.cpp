// Light of the sample ficus: transfer at 5,500 points on one core (target: 20 ms at 64 rays), the light estimate, and
// all effects of a bent branch.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "editor/edits/edit.h"
#include "editor/studies/posed_body.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/estimate/light_estimate.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/train_transfer_model.h"
#include "mesh_ops/light/transport/transfer.h"
#include "render/picture.h"

namespace rebake::test {
namespace {

Scene ficus() { return read_any(std::filesystem::path(REBAKE_SOURCE) / "samples/scenes/ficus", Axes::y_up); }

struct Points {
  std::shared_ptr<const BakedObject> object = ficus().roots.front()->object;
  std::vector<std::shared_ptr<const LightChart>> charts{
      std::make_shared<const LightChart>(light_chart(object->sets.front(), 4))};
  LightSites sites = light_sites(*object, charts);
  SceneRays rays{{{rays_of(*object), Affine::Identity(), object->bounds().diagonal().norm()}}};
};

// Traces transfer on one core. Counters: `off`, the error relative to 4096 rays, and `said`, the error that the tracer
// states.
void trace_on_one_core(benchmark::State& state, const std::vector<LightSite>& sites, const SceneRays& around) {
  const Transfer truth = traced_transfer(sites, around, 4096);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  Transfer traced;
  for (auto _ : state) traced = traced_transfer(sites, around, static_cast<int>(state.range(0)));
  state.counters["said"] = traced.relative_error;
  state.counters["off"] = relative_difference(traced.sites, truth.sites);
  state.counters["rays/s"] = benchmark::Counter(static_cast<double>(sites.size()) * static_cast<double>(state.range(0)),
                                                benchmark::Counter::kIsIterationInvariantRate);
}
void TransferOfLeavesOnOneCore(benchmark::State& state) {
  const Points points;
  std::vector<LightSite> some;
  constexpr std::size_t wanted = 5500;
  for (std::size_t k = 0; k < wanted; ++k) some.push_back(points.sites.now[k * points.sites.size() / wanted]);
  trace_on_one_core(state, some, points.rays);
}
BENCHMARK(TransferOfLeavesOnOneCore)
    ->RangeMultiplier(4)
    ->Range(16, 1024)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

// The sheet of the studies with 5,476 points and 10,658 triangles, bent. Arguments: rays, degrees.
void TransferOfSheetOnOneCore(benchmark::State& state) {
  const PosedBody sheet = bumpy_sheet(74);
  const ProxyMesh bent = sheet.bent(static_cast<double>(state.range(1)));
  trace_on_one_core(state, vertex_sites(sheet.rest, bent, vertex_rotations(sheet.rest, bent)),
                    rays_among({{solid_object(bent), Affine::Identity()}}));
}
BENCHMARK(TransferOfSheetOnOneCore)
    ->ArgsProduct({{16, 64, 256, 1024}, {0, 60}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

// Mean colours of light sites, needed for the light estimate and for every map.
void SiteColors(benchmark::State& state) {
  const Points points;
  const std::vector<float> facing(points.sites.size(), 0.5F);
  for (auto _ : state) benchmark::DoNotOptimize(site_colors(*points.object, points.charts, points.sites, facing));
}
BENCHMARK(SiteColors)->Unit(benchmark::kMillisecond)->UseRealTime();

void Estimate(benchmark::State& state) {
  const Points points;
  const auto colors =
      site_colors(*points.object, points.charts, points.sites, std::vector<float>(points.sites.size(), 0.5F));
  for (auto _ : state) benchmark::DoNotOptimize(estimated_light(points.sites, colors, points.rays));
}
BENCHMARK(Estimate)->Unit(benchmark::kMillisecond)->Iterations(3);

Scene with(Scene scene, const std::vector<nlohmann::json>& edits) {
  for (const nlohmann::json& line : edits) scene = apply(scene, read_edit(line, scene)).scene;
  return scene;
}
const nlohmann::json in_sky{{"op", "light"}, {"source", "sky"}};
nlohmann::json bent_by(int degrees) {
  return {{"op", "bend"},        {"node", "ficus"},         {"degrees", degrees},
          {"axis", {1, 0.3, 0}}, {"direction", {0, -1, 0}}, {"box", {{"min", {0.52, 0.5, 0}}, {"max", {1, 1, 1}}}},
          {"frame", "bounds"}};
}

void BentBranch(benchmark::State& state) {
  const Scene scene = with(ficus(), {in_sky, bent_by(70)});
  for (auto _ : state)
    benchmark::DoNotOptimize(lighting_of(scene, {.rays = static_cast<int>(state.range(0))}).left_out);
}
BENCHMARK(BentBranch)->Arg(16)->Arg(64)->Arg(256)->Unit(benchmark::kMillisecond)->Iterations(3);

// Kettles side by side, each read separately, with all shadows between them and nothing cached.
void ManyKettles(benchmark::State& state) {
  Scene scene;
  for (int k = 0; k < state.range(0); ++k) {
    Node node;
    node.name = "kettle " + std::to_string(k);
    node.object = read_any(std::filesystem::path(REBAKE_SOURCE) / "samples/scenes/kettle", Axes::y_up).roots[0]->object;
    node.to_parent.translation() = Vec3(2.2 * (k % 6), 0, 2.2 * (k / 6));
    scene = with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  }
  scene.light = std::make_shared<const SceneLight>();
  for (auto _ : state) benchmark::DoNotOptimize(lighting_of(scene).left_out);
}
BENCHMARK(ManyKettles)->Arg(4)->Arg(12)->Arg(26)->Unit(benchmark::kMillisecond)->Iterations(1)->UseRealTime();

// A cache of results in memory.
struct InMemoryResults final : ResultCache {
  std::map<std::string, std::string> held;
  std::optional<std::string> find(const std::string& key) override {
    const auto it = held.find(key);
    return it == held.end() ? std::nullopt : std::optional(it->second);
  }
  void keep(const std::string& key, std::string_view bytes) override { held[key] = bytes; }
};

// Time that light adds to a frame of a drag, off the window's thread. Counter `left`: root mean square error over the
// sites that change, relative to the change. Arguments: degrees; 1 for a model trained on such bends, 0 for rotated
// transfer.
void DraggedBranch(benchmark::State& state) {
  const Scene rest = with(ficus(), {in_sky}), bent = with(rest, {bent_by(static_cast<int>(state.range(0)))});
  const NodeId node = rest.roots.front()->id;
  InMemoryResults results;
  LightingOptions options{.rays = 256, .results = &results, .turning = {node}};
  Lighting start = lighting_of(rest, options);
  if (state.range(1) != 0) {
    const TransferModel model = trained_model(
        *start.turning.at(node), [&](int k) { return with(rest, {bent_by(3 * k - 90)}).roots.front()->object; },
        {.poses = 60, .rays = 128});
    results.keep(transfer_model_key(*rest.roots.front()->object, model.sites), bytes_of(model));
    start = lighting_of(rest, options);
  }
  const DragLight& turning = *start.turning.at(node);
  for (auto _ : state) benchmark::DoNotOptimize(dragged_lighting(rest, start, bent)->left_out);
  const Lighting truth = lighting_of(bent, {.rays = 256, .turning = {node}});
  const std::vector<Radiance>& traced = truth.turning.at(node)->start().after;
  const std::vector<Radiance> turned = turning.light_on(*bent.roots.front()->object);
  double off = 0, all = 0;
  for (std::size_t i = 0; i < traced.size(); ++i) {
    if (turned[i] == turning.start().after[i]) continue;
    off += (turned[i] - traced[i]).squaredNorm();
    all += (turning.start().after[i] - traced[i]).squaredNorm();
  }
  state.counters["left"] = std::sqrt(off / all);
  state.counters["sites"] = static_cast<double>(traced.size());
}
BENCHMARK(DraggedBranch)
    ->ArgsProduct({{10, 40, 70}, {0, 1}})
    ->ArgNames({"degrees", "learned"})
    ->Unit(benchmark::kMillisecond);

// Frame time of a drag in the window with moving vertices. Argument 0: without light, 1: with constant light maps, 2:
// with new light maps in each frame.
void DraggedFrame(benchmark::State& state) {
  const Scene rest = with(ficus(), {in_sky});
  const NodeId node = rest.roots.front()->id;
  const Lighting start = lighting_of(rest, {.rays = 64, .turning = {node}});
  const bool follows = state.range(0) == 2;
  std::vector<Scene> scenes;
  std::vector<Lighting> lights;
  for (int k = 0; k < 8; ++k) {
    scenes.push_back(with(rest, {bent_by(30 + k)}));
    lights.push_back(*dragged_lighting(rest, start, scenes[follows ? static_cast<std::size_t>(k) : 0]));
  }
  View view;
  view.camera.eye = {0.7, 1.2, 5.6};
  view.camera.near_plane = 0.5;
  view.camera.far_plane = 20;
  view.width = 1280;
  view.height = 800;
  view.samples = 1;
  Renderer renderer;
  std::size_t k = 0;
  for (auto _ : state) {
    ++k;
    benchmark::DoNotOptimize(
        renderer.render(scenes[k % 8], view, {}, state.range(0) == 0 ? nullptr : &lights[k % 8]).rgb.data());
  }
}
BENCHMARK(DraggedFrame)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace rebake::test
