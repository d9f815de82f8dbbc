#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/closed_form.h"
#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/light_estimate.h"
#include "mesh_ops/light/lighting.h"
#include "render/picture.h"
#include "samples/bakery/field.h"

// How near corrected light comes to the truth: edited scenes are traced under the light that they were baked with.

namespace {

using namespace rebake;
using namespace rebake::bakery;

Light known_light(const Model& model) {
  return sky_and_sun({0.34, 0.30, 0.27}, {0.75, 0.88, 1.1}, {model.sun.normalized(), 0.09, {1.15, 1.05, 0.9}},
                     {0.13, 0.12, 0.11});
}

struct QuadOf {
  std::size_t patch;
  int column, row;
};
std::vector<QuadOf> quads_of(const Model& model) {
  constexpr int cell = 17;
  std::vector<QuadOf> quads;
  for (std::size_t p = 0; p < model.patches.size(); ++p) {
    const Patch& patch = model.patches[p];
    for (int row = 0; row < patch.rows; ++row)
      for (int column = 0; column < patch.columns; ++column) {
        bool any = false;
        for (int j = 0; j < cell && !any; ++j)
          for (int i = 0; i < cell && !any; ++i)
            any = patch.opaque((column + i / (cell - 1.0)) / patch.columns, (row + j / (cell - 1.0)) / patch.rows);
        if (any) quads.push_back({p, column, row});
      }
  }
  return quads;
}

// Which patch each triangle of a sample was baked from.
std::vector<std::size_t> patch_of_triangles(const Model& model) {
  constexpr int cell = 17;
  std::vector<std::size_t> patch_of;
  for (std::size_t p = 0; p < model.patches.size(); ++p) {
    const Patch& patch = model.patches[p];
    for (int row = 0; row < patch.rows; ++row)
      for (int column = 0; column < patch.columns; ++column) {
        bool any = false;
        for (int j = 0; j < cell && !any; ++j)
          for (int i = 0; i < cell && !any; ++i)
            any = patch.opaque((column + i / (cell - 1.0)) / patch.columns, (row + j / (cell - 1.0)) / patch.rows);
        if (any) patch_of.insert(patch_of.end(), 2, p);
      }
  }
  return patch_of;
}

// A picture of baked surfaces in other colours, 16 rays a pixel over white: so that edges of opacity, which baking
// rounds to texels, are the same in pictures that are compared. `quads` are all that were baked, an object's after the
// other's; `number_of` says which each triangle of the scene is of.
Image painted(const Scene& scene, const std::vector<QuadOf>& quads,
              const std::vector<std::vector<std::size_t>>& number_of, const Model& model, const Camera& camera,
              int side, const RadianceField::Shade& shade) {
  std::vector<PlacedNode> objects;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object) objects.push_back(placed);
  const SceneRays rays = rays_through(objects);
  Image image{side, side,
              std::vector<std::uint8_t>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3)};
  const Mat3 to_world = world_to_camera(camera).transpose();
  const double tan_half = std::tan(camera.fov_degrees / 2 * 3.14159265358979 / 180);
  tbb::parallel_for(0, side, [&](int y) {
    for (int x = 0; x < side; ++x) {
      Vec3 sum = Vec3::Zero();
      for (int s = 0; s < 16; ++s) {
        const double sx = (x + (s % 4 + 0.5) / 4) / side * 2 - 1, sy = 1 - (y + (s / 4 + 0.5) / 4) / side * 2;
        const Vec3 d = (to_world * Vec3(sx * tan_half, sy * tan_half, -1)).normalized();
        const auto hit = rays.nearest(camera.eye, d, 0, 1e9);
        if (!hit) {
          sum += Vec3::Ones();
          continue;
        }
        const BakedObject& object = *objects[hit->instance].node->object;
        std::size_t face = hit->triangle, set = 0;
        while (face >= object.sets[set].soup.triangle_count()) face -= object.sets[set++].soup.triangle_count();
        const Soup& soup = object.sets[set].soup;
        const Affine to_object = objects[hit->instance].to_world.inverse();
        const Vec3 p = to_object * (camera.eye + hit->t * d);
        const Vec3 &c0 = soup.positions()[soup.faces()[face][0]], &c1 = soup.positions()[soup.faces()[face][1]],
                   &c2 = soup.positions()[soup.faces()[face][2]];
        const Vec3 n = (c1 - c0).cross(c2 - c0);
        const double w1 = (p - c0).cross(c2 - c0).dot(n) / n.squaredNorm(),
                     w2 = (c1 - c0).cross(p - c0).dot(n) / n.squaredNorm();
        const std::size_t number = number_of[hit->instance][hit->triangle];
        const QuadOf& quad = quads[number / 2];
        const double a = number % 2 == 0 ? w1 + w2 : w1, b = number % 2 == 0 ? w2 : w1 + w2;
        const Patch& patch = model.patches[quad.patch];
        sum += shade(quad.patch, std::clamp((quad.column + a) / patch.columns, 0.0, 1.0),
                     std::clamp((quad.row + b) / patch.rows, 0.0, 1.0), d);
      }
      for (int c = 0; c < 3; ++c)
        image.rgb[static_cast<std::size_t>((y * side + x) * 3 + c)] =
            static_cast<std::uint8_t>(std::lround(std::clamp(sum[c] / 16, 0.0, 1.0) * 255));
    }
  });
  return image;
}

struct Case {
  std::string name;
  Scene scene;
  Model edited;
  RadianceField::Shade carried;  // of the edited model's patches: the light that was baked
  std::vector<Camera> cameras;
  std::vector<QuadOf> quads;                        // of the edited model
  std::vector<std::vector<std::size_t>> number_of;  // of each object's triangles among them
};

struct Errors {
  std::size_t changed = 0, still = 0;
  double before = 0, after = 0;              // over changed pixels, root mean square, of 255
  double clean_before = 0, clean_after = 0;  // the same of the change that light makes alone
  double moved = 0;                          // 99th percentile of how far others move
  double most = 0;
};

double at(const Image& image, std::size_t k) { return image.rgb[k]; }

Errors compare(const Image& truth0, const Image& truth1, const Image& drawn0, const Image& drawn1) {
  Errors e;
  std::vector<double> still;
  for (std::size_t p = 0; p < truth0.rgb.size(); p += 3) {
    double change = 0, moved = 0, before = 0, after = 0, clean0 = 0, clean1 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = p + c;
      const double t = at(truth1, k) - at(truth0, k), d = at(drawn1, k) - at(drawn0, k);
      change = std::max(change, std::abs(t));
      moved = std::max(moved, std::abs(d - t));
      before += std::pow(at(drawn0, k) - at(truth1, k), 2);
      after += std::pow(at(drawn1, k) - at(truth1, k), 2);
      clean0 += t * t;
      clean1 += (d - t) * (d - t);
    }
    if (change > 4) {
      ++e.changed;
      e.before += before, e.after += after, e.clean_before += clean0, e.clean_after += clean1;
    } else {
      still.push_back(moved);
    }
  }
  e.still = still.size();
  for (double* sum : {&e.before, &e.after, &e.clean_before, &e.clean_after})
    *sum = e.changed > 0 ? std::sqrt(*sum / 3 / static_cast<double>(e.changed)) : 0;
  if (!still.empty()) {
    std::sort(still.begin(), still.end());
    e.moved = still[still.size() * 99 / 100];
    e.most = still.back();
  }
  return e;
}

Case bent_ficus(const Scene& ficus_scene, const RadianceField& rest, const Model& model, double degrees) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.origin = {0.07, 0.17, 0.04};
  form.axis = {1, 0.3, 0};
  form.direction = {0, -1, 0};
  form.from = 0.1;
  form.to = 1.1;
  form.radians = degrees * 3.14159265358979 / 180;
  std::vector<bool> bends;
  for (std::size_t p = 0, leaf = 0; p < model.patches.size(); ++p) {
    const std::string& name = model.patches[p].name;
    const bool is_leaf = name.rfind("leaf", 0) == 0;
    bends.push_back(name == "branch" || (is_leaf && leaf >= 34 && leaf < 66));
    if (is_leaf) ++leaf;
  }
  Case c;
  c.name = fmt::format("branch bent by {}°", degrees);
  const auto warp = [=](std::size_t patch, const Vec3& p) -> Vec3 { return bends[patch] ? deform(form, p).point : p; };
  c.edited = warped(model, warp);
  for (Patch& patch : c.edited.patches) patch.clearance = rest.clearance();
  c.carried = [=, &rest, &model](std::size_t patch, double u, double v, const Vec3& d) {
    if (!bends[patch]) return rest.color(patch, u, v, d);
    const Mat3 turn = orthogonal_factor(deform(form, model.patches[patch].point(u, v)).jacobian);
    return rest.color(patch, u, v, turn.transpose() * d);
  };
  const NodePtr node = ficus_scene.roots.front();
  TriangleSet flags;
  for (const std::size_t patch : patch_of_triangles(model)) flags.push_back(bends[patch] ? 1 : 0);
  const DeformedObject made =
      deformed(*node->object, Affine::Identity(), flags, 0, [&](const std::vector<Vec3>& points) {
        DeformedPoints out;
        for (const Vec3& p : points) {
          const Deformed d = deform(form, p);
          out.points.push_back(d.point);
          out.jacobians.push_back(d.jacobian);
          out.outside.push_back(0);
        }
        return out;
      });
  c.scene = with_changed(ficus_scene, node->id, [&](Node& n) { n.object = made.object; });
  c.quads = quads_of(model);
  c.number_of.resize(1);
  for (std::size_t t = 0; t < c.quads.size() * 2; ++t) c.number_of[0].push_back(t);
  for (int k = 0; k < 4; ++k) c.cameras.push_back(model.camera((k + 0.5) / 4, std::fmod(0.3 + k * 0.618, 1.0)));
  return c;
}

Case cut_ficus(const Scene& ficus_scene, const RadianceField& rest, const Model& model) {
  std::vector<std::size_t> kept;
  std::vector<bool> keeps;
  for (std::size_t p = 0, leaf = 0; p < model.patches.size(); ++p) {
    const std::string& name = model.patches[p].name;
    const bool is_leaf = name.rfind("leaf", 0) == 0;
    keeps.push_back(!(name == "branch" || (is_leaf && leaf >= 34 && leaf < 66)));
    if (is_leaf) ++leaf;
    if (keeps.back()) kept.push_back(p);
  }
  Case c;
  c.name = "branch removed";
  c.edited = model;
  c.edited.patches.clear();
  for (const std::size_t p : kept) c.edited.patches.push_back(model.patches[p]);
  for (Patch& patch : c.edited.patches) patch.clearance = rest.clearance();
  c.carried = [=, &rest](std::size_t patch, double u, double v, const Vec3& d) {
    return rest.color(kept[patch], u, v, d);
  };
  const NodePtr node = ficus_scene.roots.front();
  TriangleSet flags;
  for (const std::size_t patch : patch_of_triangles(model)) flags.push_back(keeps[patch] ? 1 : 0);
  auto object = std::make_shared<BakedObject>(*node->object);
  keep_bodies(*object, *node->object);
  std::size_t first = 0;
  for (TextureSet& set : object->sets) {
    const std::size_t total = set.soup.triangle_count();
    set.soup = subset(set.soup, flags, first, true);
    first += total;
  }
  c.scene = with_changed(ficus_scene, node->id, [&](Node& n) { n.object = object; });
  c.quads = quads_of(c.edited);
  c.number_of.resize(1);
  for (std::size_t t = 0; t < c.quads.size() * 2; ++t) c.number_of[0].push_back(t);
  for (int k = 0; k < 4; ++k) c.cameras.push_back(model.camera((k + 0.5) / 4, std::fmod(0.3 + k * 0.618, 1.0)));
  return c;
}

// Two samples, the second moved.
Case beside(const std::string& name, const Scene& first_scene, const RadianceField& first_field, const Model& first,
            const Scene& second_scene, const RadianceField& second_field, const Model& second, const Affine& motion,
            std::vector<Camera> cameras) {
  Case c;
  c.name = name;
  c.edited = first;
  const Model moved = warped(second, [=](std::size_t, const Vec3& p) -> Vec3 { return motion * p; });
  for (Patch& patch : c.edited.patches) patch.clearance = first_field.clearance();
  for (Patch patch : moved.patches) {
    patch.clearance = second_field.clearance() * std::cbrt(std::abs(motion.linear().determinant()));
    c.edited.patches.push_back(std::move(patch));
  }
  const std::size_t count = first.patches.size();
  const Mat3 turn = orthogonal_factor(motion.linear());
  c.carried = [=, &first_field, &second_field](std::size_t patch, double u, double v, const Vec3& d) {
    if (patch < count) return first_field.color(patch, u, v, d);
    return second_field.color(patch - count, u, v, turn.transpose() * d);
  };
  c.scene = first_scene;
  Node node = *second_scene.roots.front();
  node.id = NodeId::none;
  node.to_parent = motion;
  c.scene = with_added(c.scene, std::move(node), NodeId::none, 1);
  c.cameras = std::move(cameras);
  c.quads = quads_of(c.edited);
  const std::size_t first_triangles = quads_of(first).size() * 2;
  c.number_of.resize(2);
  for (std::size_t t = 0; t < first_triangles; ++t) c.number_of[0].push_back(t);
  for (std::size_t t = first_triangles; t < c.quads.size() * 2; ++t) c.number_of[1].push_back(t);
  return c;
}

Lighting lighting_with(const Scene& scene, const Light& known, int rays) {
  Lighting result;
  std::vector<PlacedNode> objects;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.visible) objects.push_back(placed);
  for (const PlacedNode& placed : objects) {
    const BakedObject& object = *placed.node->object;
    std::vector<std::shared_ptr<const LightChart>> charts;
    for (const TextureSet& set : object.sets) charts.push_back(std::make_shared<const LightChart>(light_chart(set, 4)));
    const LightSites sites = light_sites(object, charts);
    const BakedBody body = bodies_of(object).front();
    const SceneRays before({{rays_of(*body.object), Affine::Identity(), body.object->bounds().diagonal().norm()}});
    std::vector<SceneRays::Instance> instances;
    for (const PlacedNode& other : objects)
      instances.push_back({rays_of(*other.node->object), placed.to_world.inverse() * other.to_world,
                           other.node->object->bounds().diagonal().norm()});
    const SceneRays after(std::move(instances));
    const auto t0 = std::chrono::steady_clock::now();
    const Mat3 I = Mat3::Identity();
    Light light = known;
    if (std::getenv("ESTIMATE")) {
      const auto any = site_colors(object, charts, sites, std::vector<float>(sites.size(), 0.5F));
      const LightEstimate e = estimated_light(sites, any, before);
      light = e.light;
      fmt::print("  estimated in {:.2f} s: confidence {:.3f}, sun {}",
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count(), e.confidence, e.sun);
      if (e.sun) {
        const Sun& a = e.light.suns.front();
        fmt::print(" {:.1f}° off, radius {}, {:.2f} {:.2f} {:.2f}",
                   std::acos(std::min(1.0, a.direction.dot(known.suns.front().direction))) * 57.2958, a.radius,
                   a.irradiance[0], a.irradiance[1], a.irradiance[2]);
      }
      const Radiance m = e.light.sky.mean(), up = e.light.sky.at({0, 1, 0}), down = e.light.sky.at({0, -1, 0});
      fmt::print("; sky mean {:.2f} {:.2f} {:.2f} up {:.2f} down {:.2f}, bounce {:.2f} {:.2f} {:.2f}\n", m[0], m[1],
                 m[2], up[1], down[1], e.light.bounce[0], e.light.bounce[1], e.light.bounce[2]);
    }
    const std::vector<SiteLight> lit0 = traced_light(sites.baked, {}, before, light, I, {rays, true});
    const std::vector<SiteLight> lit1 = traced_light(sites.now, {}, after, light, I, {rays, true});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
    const std::vector<float> facing =
        facing_of(sites, lit0, site_colors(object, charts, sites, std::vector<float>(sites.size(), 0.5F)));
    const std::vector<Radiance> colors = site_colors(object, charts, sites, facing);
    std::vector<Radiance> e0, e1;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const double f = static_cast<double>(facing[i]);
      e0.push_back(f * lit0[i].irradiance[0] + (1 - f) * lit0[i].irradiance[1]);
      e1.push_back(f * lit1[i].irradiance[0] + (1 - f) * lit1[i].irradiance[1]);
    }
    fmt::print("  {}: {} sites, traced in {:.2f} s\n", placed.node->name, sites.size(), seconds);
    auto& maps = result.maps[placed.node->id];
    for (LightMap& map : light_maps(charts, sites, colors, e0, e1))
      maps.push_back(std::make_shared<const LightMap>(std::move(map)));
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path samples = argc > 1 ? argv[1] : "samples/scenes", out = argc > 2 ? argv[2] : "";
  const int rays = argc > 3 ? std::atoi(argv[3]) : 256;
  const Model ficus_model = ficus(), kettle_model = kettle();
  const RadianceField ficus_field(ficus_model), kettle_field(kettle_model);
  const auto load = [&](const char* name) {
    Scene loaded = read_any(samples / name, Axes::y_up);
    return loaded;
  };
  const Scene ficus_scene = load("ficus"), kettle_scene = load("kettle");
  std::vector<Case> cases;
  cases.push_back(bent_ficus(ficus_scene, ficus_field, ficus_model, 40));
  cases.push_back(bent_ficus(ficus_scene, ficus_field, ficus_model, 70));
  cases.push_back(cut_ficus(ficus_scene, ficus_field, ficus_model));
  Affine beside_it = Affine::Identity();
  beside_it.translation() = Vec3(0.75, -0.6, 0.35);
  beside_it.linear() *= 0.6;
  std::vector<Camera> cameras;
  for (int k = 0; k < 4; ++k) cameras.push_back(ficus_model.camera((k + 0.5) / 4, std::fmod(0.3 + k * 0.618, 1.0)));
  cases.push_back(beside("kettle beside the ficus", ficus_scene, ficus_field, ficus_model, kettle_scene, kettle_field,
                         kettle_model, beside_it, cameras));
  Renderer renderer;
  for (const Case& c : cases) {
    const RadianceField field(c.edited);
    const Lighting lighting = lighting_with(c.scene, known_light(ficus_model), rays);
    int k = 0;
    for (const Camera& camera : c.cameras) {
      View view;
      view.camera = camera;
      view.width = view.height = 400;
      const Image truth1 =
                      painted(c.scene, c.quads, c.number_of, c.edited, camera, 400,
                              [&](std::size_t p, double u, double v, const Vec3&d) { return field.color(p, u, v, d); }),
                  truth0 = painted(c.scene, c.quads, c.number_of, c.edited, camera, 400, c.carried);
      const Image drawn0 = renderer.render(c.scene, view), drawn1 = renderer.render(c.scene, view, {}, &lighting);
      const Errors e = compare(truth0, truth1, drawn0, drawn1);
      fmt::print(
          "{:<24} {}: {:>6} px change; error {:5.2f} -> {:5.2f} ({:.2f}); light's alone {:5.2f} -> {:5.2f} ({:.2f}); "
          "still: 99 % within {:.0f}, most {:.0f}\n",
          c.name, k, e.changed, e.before, e.after, e.after / e.before, e.clean_before, e.clean_after,
          e.clean_after / e.clean_before, e.moved, e.most);
      if (!out.empty()) {
        std::filesystem::create_directories(out);
        const auto write = [&](const Image& image, const char* what) {
          write_png(image, out / fmt::format("{}-{}-{}.png", &c - cases.data(), k, what), {});
        };
        Image wrong = truth0, change = truth0;
        for (std::size_t q = 0; q < wrong.rgb.size(); ++q) {
          const double t = at(truth1, q) - at(truth0, q), d = at(drawn1, q) - at(drawn0, q);
          wrong.rgb[q] = static_cast<std::uint8_t>(std::clamp(128 + 3 * (d - t), 0.0, 255.0));
          change.rgb[q] = static_cast<std::uint8_t>(std::clamp(128 + 3 * t, 0.0, 255.0));
        }
        write(wrong, "wrong");
        write(change, "change");
        write(truth0, "truth0");
        write(truth1, "truth1");
        write(drawn0, "drawn0");
        write(drawn1, "drawn1");
      }
      ++k;
    }
    std::fflush(stdout);
  }
  return 0;
}
