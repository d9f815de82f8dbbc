#include "editor/studies/representations/scene_kinds.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

constexpr double golden = 0.6180339887498949;
constexpr int held_out_cameras = 20;

}  // namespace

bakery::Model procedural_model(const std::string& sample) {
  for (bakery::Model& model :
       std::vector<bakery::Model>{bakery::ficus(), bakery::kettle(), bakery::shelf(), bakery::courtyard()})
    if (model.name == sample) return std::move(model);
  throw FieldError("sample", sample + " is not a procedural sample");
}

TruthRays traced_rays(const bakery::Model& model, const bakery::RadianceField& field, int views, int side,
                      const Progress& progress) {
  const auto per_view = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
  struct Traced {
    TruthRay ray;
    bool met;
    Vec3 point;
  };
  std::vector<Traced> traced(per_view * static_cast<std::size_t>(views));
  for (int v = 0; v < views; ++v) {
    progress.at("tracing rays", static_cast<double>(v) / views);
    const Camera camera = model.camera((v + 0.5) / views, std::fmod(v * golden, 1.0));
    const Mat3 to_world = world_to_camera(camera).transpose();
    const double tan_half = std::tan(camera.fov_degrees / 2 * std::numbers::pi / 180);
    tbb::parallel_for(0, side, [&](int y) {
      std::mt19937 random(static_cast<unsigned>(v * side + y));
      const auto within = [&] { return random() / 4294967296.0; };
      for (int x = 0; x < side; ++x) {
        const double right = ((x + within()) / side * 2 - 1) * tan_half,
                     up = (1 - (y + within()) / side * 2) * tan_half;
        const Vec3 direction = (to_world * Vec3(right, up, -1)).normalized();
        const auto hit = field.hit(camera.eye, direction);
        const Color color = hit ? field.color(hit->patch, hit->u, hit->v, direction) : Color(Color::Ones());
        traced[static_cast<std::size_t>(v) * per_view + static_cast<std::size_t>(y * side + x)] = {
            {camera.eye.cast<float>(),
             direction.cast<float>(),
             {static_cast<float>(color.x()), static_cast<float>(color.y()), static_cast<float>(color.z())}},
            hit.has_value(),
            hit ? Vec3(camera.eye + hit->distance * direction) : Vec3(Vec3::Zero())};
      }
    });
  }
  // Fisher–Yates, so that the order is the same with each standard library.
  std::mt19937 random(1);
  for (std::size_t k = traced.size(); k > 1; --k) std::swap(traced[k - 1], traced[random() % k]);
  TruthRays result;
  for (const Traced& one : traced) {
    result.rays.push_back(one.ray);
    if (!one.met) continue;
    result.hits.push_back(one.point);
    result.hit_colors.push_back(one.ray.color);
  }
  return result;
}

std::vector<HeldOutView> held_out_views(const bakery::Model& model, int count, int side, int after) {
  std::vector<HeldOutView> result;
  for (int k = 0; k < count; ++k) {
    const int camera = (k * held_out_cameras / count + after) % held_out_cameras;
    View view;
    view.camera = model.camera((camera + 0.5) / held_out_cameras, std::fmod(0.5 + camera * golden, 1.0));
    view.width = view.height = side;
    result.push_back({view, {}});
  }
  return result;
}

}  // namespace rebake
