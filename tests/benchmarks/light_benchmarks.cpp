// Light of the committed ficus: transfer at 5,500 points on one core (the aim is 20 ms at 64 rays), the estimate, and
// all that a bent branch calls for.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "editor/edits/edit.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/light_estimate.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/light/transfer.h"

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

void TransferOnOneCore(benchmark::State& state) {
  const Points points;
  std::vector<LightSite> some;
  constexpr std::size_t wanted = 5500;
  for (std::size_t k = 0; k < wanted; ++k) some.push_back(points.sites.now[k * points.sites.size() / wanted]);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const int rays = static_cast<int>(state.range(0));
  double error = 0;
  for (auto _ : state) error = traced_transfer(some, points.rays, rays).relative_error;
  state.counters["relT"] = error;
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(wanted * state.range(0)), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(TransferOnOneCore)->Arg(16)->Arg(64)->Arg(256)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void Estimate(benchmark::State& state) {
  const Points points;
  const auto colors =
      site_colors(*points.object, points.charts, points.sites, std::vector<float>(points.sites.size(), 0.5F));
  for (auto _ : state) benchmark::DoNotOptimize(estimated_light(points.sites, colors, points.rays));
}
BENCHMARK(Estimate)->Unit(benchmark::kMillisecond)->Iterations(3);

void BentBranch(benchmark::State& state) {
  Scene scene = ficus();
  for (const nlohmann::json& line : std::vector<nlohmann::json>{{{"op", "light"}, {"source", "sky"}},
                                                                {{"op", "bend"},
                                                                 {"node", "ficus"},
                                                                 {"degrees", 70},
                                                                 {"axis", {1, 0.3, 0}},
                                                                 {"direction", {0, -1, 0}},
                                                                 {"box", {{"min", {0.52, 0.5, 0}}, {"max", {1, 1, 1}}}},
                                                                 {"frame", "bounds"}}})
    scene = apply(scene, read_edit(line, scene)).scene;
  for (auto _ : state)
    benchmark::DoNotOptimize(lighting_of(scene, {.rays = static_cast<int>(state.range(0))}).left_out);
}
BENCHMARK(BentBranch)->Arg(16)->Arg(64)->Arg(256)->Unit(benchmark::kMillisecond)->Iterations(3);

}  // namespace
}  // namespace rebake::test
