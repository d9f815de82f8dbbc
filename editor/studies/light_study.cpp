#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/index/numbering.h"
#include "mesh_ops/light/estimate/light_estimate.h"
#include "mesh_ops/light/relight/cached_light.h"
#include "mesh_ops/light/relight/relighting.h"

namespace rebake {

namespace {

// A palette of linear albedos for the test surface.
struct Albedos {
  const char* name;
  std::vector<Radiance> colors;
};
const Albedos& even_grey() {
  static const Albedos albedos{"1 albedo", {{0.5, 0.5, 0.5}}};
  return albedos;
}
const Albedos& eight_hues() {
  static const Albedos albedos{"8 hues",
                               {{0.5, 0.5, 0.5},
                                {0.7, 0.25, 0.15},
                                {0.2, 0.5, 0.15},
                                {0.15, 0.3, 0.6},
                                {0.75, 0.65, 0.3},
                                {0.35, 0.15, 0.1},
                                {0.1, 0.4, 0.4},
                                {0.4, 0.15, 0.4}}};
  return albedos;
}
// Albedos of the same chromaticity, which clusters by chromaticity cannot separate.
const Albedos& eight_greys() {
  static const Albedos albedos{
      "8 greys",
      {Radiance::Constant(0.2), Radiance::Constant(0.3), Radiance::Constant(0.4), Radiance::Constant(0.5),
       Radiance::Constant(0.55), Radiance::Constant(0.6), Radiance::Constant(0.7), Radiance::Constant(0.8)}};
  return albedos;
}

// Surface of the first visible object, for which colours under a known light are simulated.
class Body {
 public:
  Body(const Scene& scene, const Progress& progress) {
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object && placed.node->object->triangle_count() > 0) {
        object_ = placed.node->object;
        break;
      }
    if (!object_)
      throw Error("the scene has no visible object whose light could be estimated; pass another one with --scene");
    constexpr std::size_t max_sites = 8000;
    charts_ = light_charts(*object_, 4, max_sites);
    sites_ = light_sites(*object_, charts_);
    rays_ = std::make_unique<SceneRays>(
        std::vector<SceneRays::Instance>{{rays_of(*object_), Affine::Identity(), object_->bounds().diagonal().norm()}});
    for (const SiteLight& lit :
         traced_light(sites_.baked, {}, *rays_, Light(), Mat3::Identity(), {.rays = 256}, progress))
      facing_.push_back(
          static_cast<float>(facing_by_visibility(static_cast<double>(lit.open[0]), static_cast<double>(lit.open[1]))));
  }

  const LightSites& sites() const { return sites_; }
  const SceneRays& rays() const { return *rays_; }
  // Traced light per site, on its visible side.
  std::vector<Radiance> irradiance(const Light& light, int rays, const Progress& progress) const {
    std::vector<Radiance> shown;
    const auto lit = traced_light(sites_.baked, {}, *rays_, light, Mat3::Identity(), {.rays = rays}, progress);
    for (std::size_t i = 0; i < lit.size(); ++i) shown.push_back(visible_irradiance(lit[i], facing_[i]));
    return shown;
  }

  // Simulated colour per site: the mean over all of `views` photographs from all around that see it. A photograph sees
  // albedo times irradiance plus a view-dependent highlight. Sites that no photograph sees are black.
  std::vector<Radiance> simulated_photographs(const std::vector<Radiance>& irradiance, const Light& light,
                                              const Albedos& albedos, int views) const {
    const double size = object_->bounds().diagonal().norm();
    const Vec3 middle = object_->bounds().center();
    std::vector<Radiance> colors(sites_.size(), Radiance::Zero());
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      const LightSite& site = sites_.baked[i];
      int seen = 0;
      for (int k = 0; k < views; ++k) {
        // Cameras are above the ground, as for a person who walks around the object.
        const double height = 0.1 + 0.8 * (k + 0.5) / views,
                     around = 2 * std::numbers::pi * std::fmod(k * 0.6180339887498949 + 0.1, 1.0);
        const double level = std::sqrt(1 - height * height);
        const Vec3 eye = middle + 1.5 * size * Vec3(level * std::cos(around), height, level * std::sin(around));
        const Vec3 to_eye = (eye - site.position).normalized();
        const bool front = site.normal.dot(to_eye) > 0;
        if ((front ? facing_[i] : 1 - facing_[i]) == 0) continue;
        const Vec3 normal = front ? site.normal : Vec3(-site.normal);
        const Vec3 above = site.position + site.offset[front ? 0 : 1] * normal;
        if (rays_->blocked(above, eye)) continue;
        ++seen;
        Radiance color = albedo(site.position, albedos).cwiseProduct(irradiance[i]);
        for (const Sun& sun : light.suns) {
          const double gloss = std::pow(std::max(0.0, normal.dot((to_eye + sun.direction).normalized())), 40);
          if (normal.dot(sun.direction) > 0 && !rays_->shaded(above, sun.direction))
            color += 0.15 * gloss * sun.irradiance;
        }
        colors[i] += color;
      }
      if (seen > 0) colors[i] /= seen;
    }
    return colors;
  }

 private:
  // A pseudo-random albedo per cube of space; cubes are an eighth of the object's diagonal wide.
  const Radiance& albedo(const Vec3& place, const Albedos& albedos) const {
    const Vec3 cell = (place - object_->bounds().min()) / object_->bounds().diagonal().norm() * 8;
    std::uint64_t number = 0;
    for (const double c : cell) number = number * 64 + static_cast<std::uint64_t>(std::clamp(c, 0.0, 63.0));
    return albedos.colors[mixed(number, 3, 5) % albedos.colors.size()];
  }

  std::shared_ptr<const BakedObject> object_;
  std::vector<std::shared_ptr<const LightChart>> charts_;
  LightSites sites_;
  std::unique_ptr<SceneRays> rays_;
  std::vector<float> facing_;
};

// Relative root mean square error in percent, after the best scale per channel: an estimate leaves scale and tint
// undetermined.
double relative_error_percent(const std::vector<Radiance>& found, const std::vector<Radiance>& truth) {
  Radiance both = Radiance::Zero(), own = Radiance::Zero();
  for (std::size_t i = 0; i < found.size(); ++i) {
    both += found[i].cwiseProduct(truth[i]);
    own += found[i].cwiseProduct(found[i]);
  }
  double off = 0, all = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Radiance scaled = found[i].cwiseProduct(both.cwiseQuotient(own.cwiseMax(1e-300)));
    off += (scaled - truth[i]).squaredNorm();
    all += truth[i].squaredNorm();
  }
  return 100 * std::sqrt(off / all);
}

}  // namespace

StudyTable study_light(const StudyInput& input) {
  StudyTable table{
      {"milliseconds", "surface light error %", "sun direction error, degrees", "confidence", "surface seen %"},
      {},
      0,
      1,
      true,
      true};
  const Body body(input.scene, input.progress);
  const Sun high{Vec3(0.5, 0.8, 0.45).normalized(), 0.09, {1.15, 1.05, 0.9}};
  const Radiance ground(0.34, 0.3, 0.27), zenith(0.75, 0.88, 1.1);
  const std::map<std::string, Light> lights{{"sky", sky_and_sun(ground, zenith, {}, {0, 0, 0})},
                                            {"sun", sky_and_sun(ground, zenith, high, {0, 0, 0})}};
  constexpr int truth_rays = 1024;
  std::map<std::string, std::vector<Radiance>> truth;
  for (const auto& [name, light] : lights) truth[name] = body.irradiance(light, truth_rays, input.progress);

  const auto add = [&](const std::string& name, const std::string& lit, const Albedos& albedos, int views,
                       const EstimateOptions& options) {
    const Light& light = lights.at(lit);
    const auto colors = body.simulated_photographs(truth[lit], light, albedos, views);
    LightEstimate estimate;
    const double time = median_milliseconds(std::min(3, input.frames), [&] {
      estimate = estimated_light(body.sites(), colors, body.rays(), options, input.progress);
    });
    const auto found = body.irradiance(estimate.light, 256, input.progress);
    const auto seen = static_cast<double>(
        std::count_if(colors.begin(), colors.end(), [](const Radiance& color) { return color.sum() > 0; }));
    // 180 if only one of the two lights has a sun; NaN if neither has.
    const double degrees =
        light.suns.empty() != estimate.light.suns.empty() ? 180
        : light.suns.empty()
            ? std::numeric_limits<double>::quiet_NaN()
            : std::acos(std::clamp(light.suns[0].direction.dot(estimate.light.suns[0].direction), -1.0, 1.0)) * 180 /
                  std::numbers::pi;
    table.rows.push_back({name,
                          {time, relative_error_percent(found, truth[lit]), degrees, estimate.confidence,
                           100 * seen / static_cast<double>(colors.size())}});
  };
  // Baseline: a uniform environment.
  Light even;
  even.sky = SkyMap(Radiance(1, 1, 1));
  table.rows.push_back(
      {"sun: uniform light instead",
       {0.1, relative_error_percent(body.irradiance(even, 256, input.progress), truth["sun"]), 180, 0, 0}});
  for (const Albedos* albedos : {&even_grey(), &eight_hues(), &eight_greys()})
    for (const int views : {4, 64})
      add(fmt::format("sun: {}, {} views", albedos->name, views), "sun", *albedos, views, {});
  for (const Albedos* albedos : {&even_grey(), &eight_greys()})
    add(fmt::format("sky: {}, 64 views", albedos->name), "sky", *albedos, 64, {});
  const auto with = [&](const std::string& name, const EstimateOptions& options) {
    add("sun: 8 greys, 16 views, " + name, "sun", eight_greys(), 16, options);
  };
  for (const std::size_t sites : {500, 1500, 6000}) with(fmt::format("{} sites", sites), {.sites = sites});
  for (const int rays : {64, 1024}) with(fmt::format("{} rays", rays), {.rays = rays});
  for (const int lobes : {24, 48, 192}) with(fmt::format("{} lobes", lobes), {.lobes = lobes});
  return table;
}

}  // namespace rebake
