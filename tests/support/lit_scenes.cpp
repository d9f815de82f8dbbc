#include "tests/support/lit_scenes.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/edits/edit.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/transport/irradiance.h"
#include "tests/support/lit_objects.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

Scene table() {
  std::vector<LitQuad> quads = box_quads({-0.3, 0.02, -0.3}, {0.3, 0.6, 0.3}, 2);
  quads.push_back(flat_quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 4, 4));
  const auto grey = [](const Vec3&) -> Radiance { return Radiance::Constant(0.4); };
  const auto shape = lit_object(quads, grey);
  const SceneRays rays({{rays_of(*shape), Affine::Identity(), 3}});
  Light sky;
  sky.sky = SkyMap(Radiance::Constant(1));
  return scene_of(
      lit_object(quads,
                 [&](const Vec3& p) -> Radiance {
                   if (p.y() > 0.01) return Radiance::Constant(0.4);
                   const std::vector<LightSite> site(1, LightSite{p, {0, 1, 0}, {1, 0, 0}, {1e-3, 0}});
                   const std::vector<std::uint8_t> up{1};
                   return 0.4 * traced_light(site, up, rays, sky, Mat3::Identity(), {.rays = 64})[0].irradiance[0];
                 }),
      "table");
}

Scene with_light(const Scene& scene) {
  return apply(scene, read_edit({{"op", "light"}, {"source", "uniform"}, {"zenith", {1, 1, 1}}, {"rays", 64}}, scene))
      .scene;
}

bool runs(const Lighting& lighting, const std::string& name) {
  return std::any_of(lighting.decisions.begin(), lighting.decisions.end(),
                     [&](const LightDecision& one) { return one.name == name && one.runs; });
}

const LightDecision* decision_named(const Lighting& lighting, const std::string& name) {
  for (const LightDecision& one : lighting.decisions)
    if (one.name == name) return &one;
  return nullptr;
}

}  // namespace rebake::test
