#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/bends/closed_form.h"
#include "mesh_ops/deform/deform_object.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/lighting.h"
#include "render/picture.h"
#include "samples/bakery/bake.h"
#include "samples/bakery/field.h"

// Measures the accuracy of corrected light: edited scenes are traced under the light that they were baked in.

namespace {

using namespace rebake;
using namespace rebake::bakery;

constexpr int picture = 400;  // side of the pictures in pixels

// Four cameras around a model, from its camera function.
std::vector<Camera> four_cameras(const std::function<Camera(double, double)>& camera) {
  std::vector<Camera> cameras;
  for (int k = 0; k < 4; ++k) cameras.push_back(camera((k + 0.5) / 4, std::fmod(0.3 + k * 0.618, 1.0)));
  return cameras;
}

// A baked quad of a model.
struct BakedQuad {
  std::size_t patch;
  int column, row;
};
std::vector<BakedQuad> quads_of(const Model& model) {
  constexpr int cell = 17;
  std::vector<BakedQuad> quads;
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

// Per triangle of a sample: the patch that it was baked from.
std::vector<std::size_t> patch_of_triangles(const Model& model) {
  std::vector<std::size_t> patch_of;
  for (const BakedQuad& quad : quads_of(model)) patch_of.insert(patch_of.end(), 2, quad.patch);
  return patch_of;
}

// An edited scene and its procedural model.
struct Case {
  std::string name;
  Scene scene;
  Model edited;
  RadianceField::Shade carried;  // display colours of the edited model's patches under the light as baked
  std::function<Vec3(std::size_t patch, double u, double v)> irradiance;  // irradiance / π as baked
  std::vector<Camera> cameras;
  std::vector<BakedQuad> quads;                     // quads of the edited model
  std::vector<std::vector<std::size_t>> number_of;  // [object][triangle]: 2 · index in `quads` + its half
};

// Picture of the baked surfaces with the colours of `shade`, 16 rays per pixel over white. All compared pictures have
// the same opacity edges, which baking rounds to texels.
Image painted(const Case& c, const Camera& camera, const RadianceField::Shade& shade) {
  constexpr int side = picture;
  std::vector<PlacedNode> objects;
  for (const PlacedNode& placed : placed_nodes(c.scene))
    if (placed.node->object) objects.push_back(placed);
  const SceneRays rays = rays_through(objects);
  Image image{side, side,
              std::vector<std::uint8_t>(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3)};
  const Mat3 to_world = world_to_camera(camera).transpose();
  const double tan_half = std::tan(camera.fov_degrees / 2 * std::numbers::pi / 180);
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
        const std::size_t number = c.number_of[hit->instance][hit->triangle];
        const BakedQuad& quad = c.quads[number / 2];
        const double a = number % 2 == 0 ? w1 + w2 : w1, b = number % 2 == 0 ? w2 : w1 + w2;
        const Patch& patch = c.edited.patches[quad.patch];
        sum += shade(quad.patch, std::clamp((quad.column + a) / patch.columns, 0.0, 1.0),
                     std::clamp((quad.row + b) / patch.rows, 0.0, 1.0), d);
      }
      for (int k = 0; k < 3; ++k)
        image.rgb[static_cast<std::size_t>((y * side + x) * 3 + k)] =
            static_cast<std::uint8_t>(std::lround(std::clamp(sum[k] / 16, 0.0, 1.0) * 255));
    }
  });
  return image;
}

// Sums of squared errors over pixels whose true colour changes by more than 4 of 255, and the errors of all other
// pixels.
struct Sums {
  std::size_t changed = 0;
  double change = 0, ruled = 0, known = 0, estimated = 0;  // the true change; errors of changes by rule and light
  double drawn = 0, drawn_known = 0, drawn_estimated = 0;  // errors of whole pictures, including baking losses
  std::vector<double> still[2];                            // errors of the other pixels: known light, estimated light

  double rms(double sum) const { return changed > 0 ? std::sqrt(sum / 3 / static_cast<double>(changed)) : 0; }
  static double max_of_99(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 99 / 100);
    std::nth_element(values.begin(), at, values.end());
    return *at;
  }
  double still_known() const { return max_of_99(still[0]); }
  double still_estimated() const { return max_of_99(still[1]); }

  void add(const Image& carried, const Image& relit, const Image& by_rule, const Image& plain, const Image& by_known,
           const Image& by_estimate) {
    for (std::size_t p = 0; p < carried.rgb.size(); p += 3) {
      double most = 0;
      std::array<double, 2> moved{};
      Vec3 t, b, k, e, d;
      for (std::size_t c = 0; c < 3; ++c) {
        const auto at = [&](const Image& image) { return static_cast<double>(image.rgb[p + c]); };
        const auto i = static_cast<Eigen::Index>(c);
        t[i] = at(relit) - at(carried);
        b[i] = at(relit) - at(by_rule);
        k[i] = at(by_known) - at(plain);
        e[i] = at(by_estimate) - at(plain);
        d[i] = at(plain) - at(relit);
      }
      most = t.cwiseAbs().maxCoeff();
      moved = {(k - t).cwiseAbs().maxCoeff(), (e - t).cwiseAbs().maxCoeff()};
      if (most > 4) {
        ++changed;
        change += t.squaredNorm();
        ruled += b.squaredNorm();
        known += (k - t).squaredNorm();
        estimated += (e - t).squaredNorm();
        drawn += d.squaredNorm();
        drawn_known += (d + k).squaredNorm();
        drawn_estimated += (d + e).squaredNorm();
      } else {
        for (std::size_t n = 0; n < 2; ++n) still[n].push_back(moved[n]);
      }
    }
  }
};

Case bent_ficus(const Scene& ficus_scene, const RadianceField& rest, const Model& model, double degrees) {
  ClosedForm form;
  form.kind = ClosedForm::Kind::bend;
  form.origin = {0.07, 0.17, 0.04};
  form.axis = {1, 0.3, 0};
  form.direction = {0, -1, 0};
  form.from = 0.1;
  form.to = 1.1;
  form.radians = degrees * std::numbers::pi / 180;
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
  for (Patch& patch : c.edited.patches) patch.ray_offset = rest.ray_offset();
  c.carried = [=, &rest, &model](std::size_t patch, double u, double v, const Vec3& d) {
    if (!bends[patch]) return rest.color(patch, u, v, d);
    const Mat3 turn = orthogonal_factor(deform(form, model.patches[patch].point(u, v)).jacobian);
    return rest.color(patch, u, v, turn.transpose() * d);
  };
  c.irradiance = [&rest](std::size_t patch, double u, double v) { return rest.irradiance(patch, u, v); };
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
  c.cameras = four_cameras(model.camera);
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
  for (Patch& patch : c.edited.patches) patch.ray_offset = rest.ray_offset();
  c.carried = [=, &rest](std::size_t patch, double u, double v, const Vec3& d) {
    return rest.color(kept[patch], u, v, d);
  };
  c.irradiance = [=, &rest](std::size_t patch, double u, double v) { return rest.irradiance(kept[patch], u, v); };
  const NodePtr node = ficus_scene.roots.front();
  TriangleSet flags;
  for (const std::size_t patch : patch_of_triangles(model)) flags.push_back(keeps[patch] ? 1 : 0);
  auto object = std::make_shared<BakedObject>(*node->object);
  record_bodies(*object, *node->object);
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
  c.cameras = four_cameras(model.camera);
  return c;
}

// Two samples in one scene; the second is placed by `motion`.
Case beside(const std::string& name, const Scene& first_scene, const RadianceField& first_field, const Model& first,
            const Scene& second_scene, const RadianceField& second_field, const Model& second, const Affine& motion,
            std::vector<Camera> cameras) {
  Case c;
  c.name = name;
  c.edited = first;
  const Model moved = warped(second, [=](std::size_t, const Vec3& p) -> Vec3 { return motion * p; });
  for (Patch& patch : c.edited.patches) patch.ray_offset = first_field.ray_offset();
  for (Patch patch : moved.patches) {
    patch.ray_offset = second_field.ray_offset() * std::cbrt(std::abs(motion.linear().determinant()));
    c.edited.patches.push_back(std::move(patch));
  }
  const std::size_t count = first.patches.size();
  const Mat3 turn = orthogonal_factor(motion.linear());
  c.carried = [=, &first_field, &second_field](std::size_t patch, double u, double v, const Vec3& d) {
    if (patch < count) return first_field.color(patch, u, v, d);
    return second_field.color(patch - count, u, v, turn.transpose() * d);
  };
  c.irradiance = [=, &first_field, &second_field](std::size_t patch, double u, double v) {
    return patch < count ? first_field.irradiance(patch, u, v) : second_field.irradiance(patch - count, u, v);
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

Lighting lighting_under(const Scene& scene, const Model* known) {
  Scene lit = scene;
  SceneLight light;
  if (known != nullptr) {
    light.source = SceneLight::Source::sky;
    light.sun.direction = known->sun.normalized();
    light.bounce = {0.13, 0.12, 0.11};
  }
  lit.light = std::make_shared<const SceneLight>(light);
  return lighting_of(lit);
}

void measure(Renderer& renderer, const Case& c, const Model& light, const std::filesystem::path& out, int number) {
  const RadianceField field(c.edited);
  const Lighting known = lighting_under(c.scene, &light), estimated = lighting_under(c.scene, nullptr);
  Sums sums;
  for (std::size_t k = 0; k < c.cameras.size(); ++k) {
    View view;
    view.camera = c.cameras[k];
    view.width = view.height = picture;
    const auto truth = [&](std::size_t p, double u, double v, const Vec3& d) { return field.color(p, u, v, d); };
    // The correction rule with the true irradiance at each point. Highlights still move with their surface.
    const auto ruled = [&](std::size_t p, double u, double v, const Vec3& d) {
      Color color = c.carried(p, u, v, d);
      const Vec3 before = c.irradiance(p, u, v), after = field.irradiance(p, u, v);
      for (int i = 0; i < 3; ++i)
        if (before[i] > 0) color[i] = to_display(std::min(1.0, to_linear(color[i]) * after[i] / before[i]));
      return color;
    };
    const Image carried = painted(c, view.camera, c.carried), relit = painted(c, view.camera, truth),
                by_rule = painted(c, view.camera, ruled), drawn = renderer.render(c.scene, view),
                by_known = renderer.render(c.scene, view, {}, &known),
                by_estimate = renderer.render(c.scene, view, {}, &estimated);
    sums.add(carried, relit, by_rule, drawn, by_known, by_estimate);
    if (out.empty()) continue;
    for (const auto& [image, what] : {std::pair{&carried, "carried"},
                                      {&relit, "truth"},
                                      {&drawn, "drawn"},
                                      {&by_known, "known"},
                                      {&by_estimate, "estimated"}})
      write_picture(*image, out / fmt::format("{}-{}-{}.png", number, k, what), {});
  }
  fmt::print("| {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} / {:.0f} |\n", c.name,
             sums.changed, sums.rms(sums.change), sums.rms(sums.ruled) / sums.rms(sums.change),
             sums.rms(sums.known) / sums.rms(sums.change), sums.rms(sums.estimated) / sums.rms(sums.change),
             sums.rms(sums.drawn_known) / sums.rms(sums.drawn), sums.rms(sums.drawn_estimated) / sums.rms(sums.drawn),
             sums.still_known(), sums.still_estimated());
  std::fflush(stdout);
}

Scene baked_with(Model model, const Vec3& sun) {
  model.sun = sun;
  const RadianceField field(model);
  Node node;
  node.name = model.name;
  node.object = bake(model, field, {}, {});
  return with_added({}, std::move(node), NodeId::none, 0);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fmt::print(
        stderr,
        "Compares corrected light with ray-traced ground truth.\nUsage: rebake_light_truth SAMPLES [PICTURES]\n  "
        "SAMPLES    folder of the baked sample scenes\n  PICTURES   folder to write the compared pictures to\n");
    return 2;
  }
  try {
    const std::filesystem::path samples = argv[1], out = argc > 2 ? argv[2] : "";
    if (!out.empty()) std::filesystem::create_directories(out);
    const Model plant = ficus(), pot = kettle(), yard = courtyard();
    const RadianceField plant_field(plant), pot_field(pot);
    const Scene plant_scene = read_any(samples / "ficus", Axes::y_up),
                pot_scene = read_any(samples / "kettle", Axes::y_up);
    fmt::print(
        "| scene | pixels | truth changes | true irradiance | known | estimated | drawn, known | drawn, estimated | "
        "still "
        "|\n"
        "|---|---|---|---|---|---|---|---|---|\n");
    Renderer renderer;
    measure(renderer, bent_ficus(plant_scene, plant_field, plant, 40), plant, out, 0);
    measure(renderer, bent_ficus(plant_scene, plant_field, plant, 70), plant, out, 1);
    measure(renderer, cut_ficus(plant_scene, plant_field, plant), plant, out, 2);
    Affine place = Affine::Identity();
    place.translation() = Vec3(0.75, -0.6, 0.35);
    place.linear() *= 0.6;
    measure(renderer,
            beside("kettle beside the ficus", plant_scene, plant_field, plant, pot_scene, pot_field, pot, place,
                   four_cameras(plant.camera)),
            plant, out, 3);
    // The courtyard has another sun, so the kettle is baked again under it.
    Model lit_pot = pot;
    lit_pot.sun = yard.sun;
    const RadianceField yard_field(yard), lit_field(lit_pot);
    place.translation() = Vec3(1.5, 0.25, 1.5);
    measure(renderer,
            beside("kettle in the courtyard", baked_with(yard, yard.sun), yard_field, yard, baked_with(pot, yard.sun),
                   lit_field, lit_pot, place, four_cameras(orbit_cameras({1.4, 0.2, 1.4}, 1.5, 25, 60))),
            yard, out, 4);
    return 0;
  } catch (const rebake::Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
