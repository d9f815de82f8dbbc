// Binding and dragging at the size of a real scene: 300,000 points, a cage of 324 faces. The first argument is the
// number of threads, unless stated otherwise.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "editor/studies/gradient_binding.h"
#include "mesh_ops/deform/cages/wrap.h"
#include "mesh_ops/deform/deform_object.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

constexpr std::size_t point_count = 300000;

struct Case {
  TriangleList triangles;
  std::vector<Vec3> points;
  Cage cage;
};

// The vertices of the real mic, repeated with slightly smaller scales up to 300,000 points, in a lattice of 324 faces.
const Case& mic_case() {
  static const Case made = [] {
    auto object = mic_object();
    if (!object) object = made_object({.columns = 256, .rows = 160});
    Case result;
    for (const TextureSet& set : object->sets) {
      const auto base = static_cast<std::uint32_t>(result.triangles.points.size());
      const auto& positions = set.soup.positions();
      result.triangles.points.insert(result.triangles.points.end(), positions.begin(), positions.end());
      for (const Face& face : set.soup.faces())
        result.triangles.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
    }
    Box box;
    for (const Vec3& p : result.triangles.points) box.extend(p);
    const Vec3 margin = 0.01 * box.sizes();
    result.cage = lattice_cage(Box(Vec3(box.min() - margin), Vec3(box.max() + margin)), 3, 6, 7);
    for (std::size_t k = 0; k < point_count; ++k)
      result.points.push_back(result.triangles.points[k % result.triangles.points.size()] *
                              (1 - 1e-4 * static_cast<double>(k / result.triangles.points.size())));
    return result;
  }();
  return made;
}

std::vector<Vec3> bent(const Cage& cage, std::size_t moving) {
  std::vector<Vec3> moved = cage.vertices;
  for (std::size_t v = 0; v < std::min(moving, moved.size()); ++v)
    moved[v] = Eigen::AngleAxisd(moved[v].y(), Vec3::UnitZ()) * moved[v];
  return moved;
}

void bind(benchmark::State& state) {
  const Case& mic = mic_case();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    const auto coordinates = mean_value_coordinates(mic.cage);
    const CageBinding binding(*coordinates, mic.cage, mic.points);
    state.counters["MB"] = static_cast<double>(binding.memory()) / 1e6;
  }
  state.counters["faces"] = static_cast<double>(mic.cage.faces.size());
}

// Computes weights without storing them.
void compute_weights(benchmark::State& state, bool gradients) {
  const Case& mic = mic_case();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  const std::vector<Vec3> moved = bent(mic.cage, 1000000);
  for (auto _ : state) {
    const auto coordinates = mean_value_coordinates(mic.cage);
    benchmark::DoNotOptimize(deform_points(*coordinates, mic.cage, moved, mic.points, gradients));
  }
}

// 3000 points on a sphere around a cube. Argument: radius in half diagonals. Beyond four, all faces are integrated by
// quadrature; nearer than eight face extents with many nodes.
void weigh_far(benchmark::State& state) {
  const Cage cage = lattice_cage(Box(Vec3(-0.5, -0.5, -0.5), Vec3(0.5, 0.5, 0.5)), 1, 1, 1);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<Vec3> points;
  for (int k = 0; k < 3000; ++k)
    points.push_back(Vec3(std::sin(k), std::cos(1.7 * k), std::sin(2.3 * k + 1)).normalized() *
                     (static_cast<double>(state.range(0)) * std::sqrt(3.0) / 2));
  const auto coordinates = mean_value_coordinates(cage);
  for (auto _ : state) benchmark::DoNotOptimize(deform_points(*coordinates, cage, cage.vertices, points, false));
}

void green(benchmark::State& state) {
  const Case& mic = mic_case();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  const std::vector<Vec3> moved = bent(mic.cage, 1000000);
  for (auto _ : state) {
    const auto coordinates = green_coordinates(mic.cage);
    benchmark::DoNotOptimize(deform_points(*coordinates, mic.cage, moved, mic.points, false));
  }
}

struct Bound {
  std::unique_ptr<Coordinates> coordinates = mean_value_coordinates(mic_case().cage);
  CageBinding binding{*coordinates, mic_case().cage, mic_case().points};
  GradientBinding gradients{*coordinates, mic_case().cage, mic_case().points};
};
const Bound& bound() {
  static const Bound made;
  return made;
}

void drag_positions(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  const std::vector<Vec3> moved = bent(mic_case().cage, static_cast<std::size_t>(state.range(1)));
  std::vector<Vec3> out;
  bound();
  for (auto _ : state) bound().binding.positions(moved, out);
}

void drag_rotations(benchmark::State& state) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  const std::vector<Vec3> moved = bent(mic_case().cage, 1000000);
  std::vector<Mat3> out;
  bound();
  for (auto _ : state) bound().gradients.rotations(moved, out, static_cast<std::size_t>(state.range(1)));
}

// As for a real soup: coincident vertices are bound once, and the result is copied to each of them.
void drag_corners(benchmark::State& state) {
  const Case& mic = mic_case();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  struct Welded {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> place_of;
    std::unique_ptr<Coordinates> coordinates;
    std::unique_ptr<CageBinding> binding;
  };
  static const Welded welded = [&] {
    Welded made;
    std::map<std::array<double, 3>, std::uint32_t> places;
    for (const Vec3& p : mic.points) {
      const auto [place, added] = places.emplace(std::array{p.x(), p.y(), p.z()}, made.points.size());
      if (added) made.points.push_back(p);
      made.place_of.push_back(place->second);
    }
    made.coordinates = mean_value_coordinates(mic.cage);
    made.binding = std::make_unique<CageBinding>(*made.coordinates, mic.cage, made.points);
    return made;
  }();
  const std::vector<Vec3> moved = bent(mic.cage, 1000000);
  std::vector<Vec3> places;
  std::vector<Eigen::Vector3f> corners(mic.points.size());
  for (auto _ : state) {
    welded.binding->positions(moved, places);
    tbb::parallel_for(std::size_t{0}, corners.size(),
                      [&](std::size_t k) { corners[k] = places[welded.place_of[k]].cast<float>(); });
    benchmark::DoNotOptimize(corners.data());
  }
  state.counters["places"] = static_cast<double>(welded.points.size());
}

void wrap_soup(benchmark::State& state) {
  const Case& mic = mic_case();
  // Four copies of the mic side by side: 330,000 triangles.
  TriangleList many;
  for (int copy = 0; copy < 4; ++copy) {
    const auto base = static_cast<std::uint32_t>(many.points.size());
    for (const Vec3& p : mic.triangles.points) many.points.push_back(p + copy * 0.2 * Vec3::UnitX());
    for (const Face& face : mic.triangles.faces) many.faces.push_back({face[0] + base, face[1] + base, face[2] + base});
  }
  for (auto _ : state) {
    const Cage cage = wrap(many, 1 / static_cast<double>(state.range(0)));
    state.counters["faces"] = static_cast<double>(cage.faces.size());
  }
  state.counters["triangles"] = static_cast<double>(many.faces.size());
}

// One step of a drag in the window without drawing: new positions of the real mic, uploaded to the GPU. The picture has
// a single pixel.
void drag_preview(benchmark::State& state) {
  auto object = mic_object();
  if (!object) object = made_object({.columns = 256, .rows = 160});
  const TriangleSet all(object->triangle_count(), 1);
  std::unique_ptr<CageBinding> binding;
  const Case& mic = mic_case();
  const auto coordinates = mean_value_coordinates(mic.cage);
  Renderer renderer;
  View view;
  view.width = view.height = 1;
  view.samples = 1;
  std::size_t vertices = 0;
  for (const TextureSet& set : object->sets) vertices += set.soup.positions().size();
  double turn = 0;
  const auto step = [&] {
    std::vector<Vec3> moved = mic.cage.vertices;
    turn += 0.01;
    for (Vec3& v : moved) v = Eigen::AngleAxisd(turn * v.y(), Vec3::UnitY()) * v;
    const DeformedObject made = deformed(*object, Affine::Identity(), all, 0, [&](const std::vector<Vec3>& world) {
      if (!binding) binding = std::make_unique<CageBinding>(*coordinates, mic.cage, world);
      DeformedPoints points{{}, std::vector<Mat3>(world.size(), Mat3::Identity()), {}};
      binding->positions(moved, points.points);
      return points;
    });
    renderer.time_frame(scene_of(made.object), view, {}, false);
  };
  step();  // binds
  for (auto _ : state) step();
  state.counters["vertices"] = static_cast<double>(vertices);
}

BENCHMARK(weigh_far)->Arg(2)->Arg(3)->Arg(5)->Arg(8)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(bind)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(compute_weights, mean_value, false)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(compute_weights, mean_value_with_gradients, true)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(green)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(drag_positions)->Args({2, 1000000})->Args({2, 10})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(drag_corners)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(drag_rotations)->Args({2, 1})->Args({2, 64})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(drag_preview)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(wrap_soup)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace rebake::test
