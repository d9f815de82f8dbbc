#include "mesh_ops/light/lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <optional>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/light/light_estimate.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// The steepest that display colours rise over linear light.
constexpr double steepest = 12.92;

struct Sphere {
  Vec3 center{0, 0, 0};
  double radius = 0;
};
Sphere around(const PlacedNode& placed) {
  const Box box = transformed(placed.node->object->bounds(), placed.to_world);
  return box.isEmpty() ? Sphere{} : Sphere{box.center(), box.diagonal().norm() / 2};
}

bool similarity(const Mat3& m) {
  const Mat3 squares = m.transpose() * m;
  const double scale = squares.trace() / 3;
  return (squares - scale * Mat3::Identity()).cwiseAbs().maxCoeff() <= 1e-9 * scale;
}

bool any_displaced(const BakedObject& object) {
  return std::any_of(object.sets.begin(), object.sets.end(), [](const TextureSet& set) {
    return set.soup.vertex_attributes().shared(Soup::displacement) != nullptr;
  });
}

// Whether two nodes hold parts of one body that is still in one piece: what was separated and then moved is another
// object, and so is a copy elsewhere.
bool share_body(const PlacedNode& a, const PlacedNode& b) {
  const std::vector<BakedBody> first = bodies_of(*a.node->object), second = bodies_of(*b.node->object);
  const auto same_place = [&](const BakedBody& x, const BakedBody& y) {
    return (a.to_world * x.to_object).isApprox(b.to_world * y.to_object, 1e-9);
  };
  return std::any_of(first.begin(), first.end(), [&](const BakedBody& x) {
    return std::any_of(second.begin(), second.end(), [&](const BakedBody& y) {
      return same_body({x.object, Affine::Identity()}, {y.object, Affine::Identity()}) && same_place(x, y);
    });
  });
}

// The object's triangles where they were when their light was baked.
std::shared_ptr<const BakedObject> at_baked_places(const BakedObject& object) {
  auto result = std::make_shared<BakedObject>(object);
  for (TextureSet& set : result->sets) {
    const auto* displaced = set.soup.vertex_attributes().find<Eigen::Vector3f>(Soup::displacement);
    if (displaced == nullptr) continue;
    std::vector<Vec3> positions = set.soup.positions();
    for (std::size_t v = 0; v < positions.size(); ++v) positions[v] -= (*displaced)[v].cast<double>();
    set.soup = Soup(std::make_shared<const std::vector<Vec3>>(std::move(positions)), set.soup.shared_uvs(),
                    set.soup.shared_faces(), {}, set.soup.face_attributes());
  }
  return result;
}

// How far away an object's parts shade anything: what lies much farther than most of it, such as a backdrop, is what
// shines.
double reach_of(const BakedObject& object) {
  std::vector<Vec3> centers;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces())
      centers.push_back(
          (set.soup.positions()[face[0]] + set.soup.positions()[face[1]] + set.soup.positions()[face[2]]) / 3);
  if (centers.empty()) return std::numeric_limits<double>::infinity();
  const auto quantile = [](std::vector<double>& values, double share) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  Vec3 middle;
  std::vector<double> values(centers.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(centers.begin(), centers.end(), values.begin(), [&](const Vec3& p) { return p[axis]; });
    middle[axis] = quantile(values, 0.5);
  }
  std::transform(centers.begin(), centers.end(), values.begin(), [&](const Vec3& p) { return (p - middle).norm(); });
  const double most = quantile(values, 0.6), all = *std::max_element(values.begin(), values.end());
  constexpr double far = 3;
  return all > 1.2 * far * most ? far * most : std::numeric_limits<double>::infinity();
}

// Something that shades: an object, and where it stands.
struct Occluder {
  std::shared_ptr<const BakedObject> object;
  Affine to_frame;
};
SceneRays rays_among(const std::vector<Occluder>& occluders) {
  std::vector<SceneRays::Instance> instances;
  for (const Occluder& occluder : occluders)
    instances.push_back({rays_of(*occluder.object), occluder.to_frame, occluder.object->bounds().diagonal().norm(),
                         reach_of(*occluder.object) * std::cbrt(std::abs(occluder.to_frame.linear().determinant()))});
  return SceneRays(std::move(instances));
}

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}
template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  append(bytes, values.data(), values.size() * sizeof(T));
}

// A hash of what shades: triangles, and which of their texels are opaque.
std::uint64_t surface_hash(const BakedObject& object) {
  std::string hashes;
  const auto add = [&](std::string_view bytes) {
    const std::uint64_t hash = content_hash(bytes);
    append(hashes, &hash, sizeof(hash));
  };
  const auto view = [](const auto& values) {
    return std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  for (const TextureSet& set : object.sets) {
    add(view(set.soup.positions()));
    add(view(set.soup.uvs()));
    add(view(set.soup.faces()));
    const std::array<int, 2> size{set.texels->width(), set.texels->height()};
    add(view(size));
    for (int row = 0; row < set.texels->tile_rows(); ++row)
      for (int column = 0; column < set.texels->tile_columns(); ++column)
        add(view(set.texels->tile(column, row)->texels));
  }
  return content_hash(hashes);
}

// Traced light, from where such results are kept if it is there.
std::vector<SiteLight> kept_light(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                  const std::vector<Occluder>& occluders, const Light& light, const Mat3& to_light,
                                  int rays, Results* results, const Progress& progress) {
  const auto trace = [&] {
    return traced_light(sites, wanted, rays_among(occluders), light, to_light, {rays}, progress);
  };
  if (results == nullptr) return trace();
  std::string inputs;
  const std::array<std::size_t, 5> counts{sites.size(), wanted.size(), occluders.size(), light.sky.texels().size(),
                                          light.suns.size()};
  append(inputs, counts.data(), sizeof(counts));
  append(inputs, sites);
  append(inputs, wanted);
  for (const Occluder& occluder : occluders) {
    const std::uint64_t hash = surface_hash(*occluder.object);
    append(inputs, &hash, sizeof(hash));
    append(inputs, occluder.to_frame.matrix().data(), 16 * sizeof(double));
  }
  append(inputs, light.sky.texels());
  for (const Sun& sun : light.suns) {
    append(inputs, sun.direction.data(), 3 * sizeof(double));
    append(inputs, &sun.radius, sizeof(double));
    append(inputs, sun.irradiance.data(), 3 * sizeof(double));
  }
  append(inputs, light.bounce.data(), 3 * sizeof(double));
  append(inputs, to_light.data(), 9 * sizeof(double));
  append(inputs, &rays, sizeof(rays));
  const std::string key = result_key("light2", inputs);
  constexpr std::size_t floats = 8;
  if (const auto bytes = results->find(key); bytes && bytes->size() == sites.size() * floats * sizeof(float)) {
    std::vector<SiteLight> lit(sites.size());
    for (std::size_t i = 0; i < lit.size(); ++i) {
      std::array<float, floats> f{};
      std::memcpy(f.data(), bytes->data() + i * sizeof(f), sizeof(f));
      for (std::size_t side = 0; side < 2; ++side) {
        lit[i].irradiance[side] = Eigen::Vector3f(f[side * 4], f[side * 4 + 1], f[side * 4 + 2]).cast<double>();
        lit[i].open[side] = f[side * 4 + 3];
      }
    }
    return lit;
  }
  std::vector<SiteLight> lit = trace();
  std::string bytes;
  for (SiteLight& one : lit)
    for (std::size_t side = 0; side < 2; ++side) {
      const Eigen::Vector3f e = one.irradiance[side].cast<float>();
      append(bytes, e.data(), sizeof(e));
      append(bytes, &one.open[side], sizeof(float));
      // The same whether it was kept or not.
      one.irradiance[side] = e.cast<double>();
    }
  results->keep(key, bytes);
  return lit;
}

std::vector<std::shared_ptr<const LightChart>> charts_of(const BakedObject& object, const LightingOptions& options) {
  for (double spacing = options.spacing;; spacing *= 1.5) {
    std::vector<std::shared_ptr<const LightChart>> charts;
    std::size_t nodes = 0;
    for (const TextureSet& set : object.sets) {
      charts.push_back(std::make_shared<const LightChart>(light_chart(set, spacing)));
      nodes += charts.back()->nodes.size();
    }
    if (nodes <= options.most_nodes || spacing > 1000) return charts;
  }
}

// The light that an object as it was baked stood in, likewise.
LightEstimate kept_estimate(const BakedObject& body, const LightingOptions& options, const Progress& progress) {
  Results* results = options.results;
  const auto make = [&] {
    const auto charts = charts_of(body, options);
    const LightSites sites = light_sites(body, charts);
    const auto colors = site_colors(body, charts, sites, std::vector<float>(sites.size(), 0.5F));
    return estimated_light(sites, colors, rays_among({{std::make_shared<const BakedObject>(body), Affine::Identity()}}),
                           {}, progress);
  };
  if (results == nullptr) return make();
  std::string inputs;
  const std::uint64_t hash = surface_hash(body);
  append(inputs, &hash, sizeof(hash));
  const Decoder& d = *body.decoder;
  for (const auto* weights : {&d.weights0, &d.weights1, &d.weights2})
    append(inputs, weights->data(), static_cast<std::size_t>(weights->size()) * sizeof(double));
  for (const auto* bias : {&d.bias0, &d.bias1, &d.bias2})
    append(inputs, bias->data(), static_cast<std::size_t>(bias->size()) * sizeof(double));
  append(inputs, &options.spacing, sizeof(options.spacing));
  append(inputs, &options.most_nodes, sizeof(options.most_nodes));
  append(inputs, &body.axes, sizeof(body.axes));
  for (const TextureSet& set : body.sets) {
    const AlphaCode code = set.texels->alpha_code();
    append(inputs, &code, sizeof(code));
  }
  const std::string key = result_key("lightestimate3", inputs);
  // Numbers in this order; the sky last.
  constexpr std::size_t fixed = 12;
  if (const auto bytes = results->find(key); bytes && bytes->size() > fixed * sizeof(double)) {
    std::vector<double> n(bytes->size() / sizeof(double));
    std::memcpy(n.data(), bytes->data(), n.size() * sizeof(double));
    const int side = static_cast<int>(n[0]);
    if (side >= 1 && side <= 4096 &&
        n.size() == fixed + static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3) {
      LightEstimate estimate;
      estimate.confidence = n[1];
      estimate.light.bounce = {n[2], n[3], n[4]};
      estimate.sun = n[8] > 0;
      if (estimate.sun) estimate.light.suns.push_back({{n[5], n[6], n[7]}, n[8], {n[9], n[10], n[11]}});
      std::size_t at = fixed;
      // SkyMap asks texel by texel, in order.
      estimate.light.sky = SkyMap(side, [&](const Vec3&) -> Radiance {
        at += 3;
        return {n[at - 3], n[at - 2], n[at - 1]};
      });
      return estimate;
    }
  }
  const LightEstimate estimate = make();
  const Sun sun = estimate.sun ? estimate.light.suns.front() : Sun{{0, 0, 0}, 0, {0, 0, 0}};
  const Radiance& b = estimate.light.bounce;
  std::vector<double> n{static_cast<double>(estimate.light.sky.side()),
                        estimate.confidence,
                        b[0],
                        b[1],
                        b[2],
                        sun.direction[0],
                        sun.direction[1],
                        sun.direction[2],
                        sun.radius,
                        sun.irradiance[0],
                        sun.irradiance[1],
                        sun.irradiance[2]};
  for (const Eigen::Vector3f& texel : estimate.light.sky.texels())
    for (int c = 0; c < 3; ++c) n.push_back(static_cast<double>(texel[c]));
  results->keep(key, {reinterpret_cast<const char*>(n.data()), n.size() * sizeof(double)});
  return estimate;
}

// An object whose colours may change.
class Receiver {
 public:
  Receiver(const std::vector<PlacedNode>& objects, std::size_t own, const SceneLight& settings,
           const LightingOptions& options)
      : objects_(objects), own_(own), settings_(settings), options_(options) {
    for (std::size_t k = 0; k < objects_.size(); ++k)
      if (k == own_ || share_body(objects_[own_], objects_[k])) relatives_.push_back(k);
    // What was joined of several shades each other as it was not baked to.
    moved_ = any_displaced(object()) || object().bodies.size() > 1;
    missing_ = anything_missing();
  }

  const BakedObject& object() const { return *objects_[own_].node->object; }
  const std::string& name() const { return objects_[own_].node->name; }
  bool moved() const { return moved_; }
  bool missing() const { return missing_; }
  bool related(std::size_t other) const {
    return std::find(relatives_.begin(), relatives_.end(), other) != relatives_.end();
  }

  // An upper bound of what another object takes from this one's light, in display colours; under the shared light where
  // there is one. A sun counts where a ray to it may meet the other's sphere.
  double cast_bound(std::size_t other, const Light* shared, const Mat3& to_shared, const Progress& progress) {
    const Sphere mine = around(objects_[own_]), its = around(objects_[other]);
    const double distance = (its.center - mine.center).norm() - mine.radius;
    const double sine = distance > its.radius ? its.radius / distance : 1;
    // Without a light to be found: a sun of a degree is ten thousand times as bright as what it lights.
    constexpr double brightest_sun = 1e5;
    if (const double at_most = sine * sine * brightest_sun * steepest; at_most < settings_.budget / 1000)
      return at_most;
    const Light& own = light(progress);
    const Light& shining = shared != nullptr ? *shared : own;
    const Mat3 to_space = shared != nullptr ? Mat3(to_shared.transpose()) : turn();
    double most = 0;
    for (int c = 0; c < 3; ++c) {
      // What hides the sky sends its own light instead.
      double taken = sine * sine * std::max(shining.sky.brightest()[c], shining.bounce[c]);
      for (const Sun& sun : shining.suns) {
        const Vec3 towards = to_space * sun.direction, way = its.center - mine.center;
        const double along = way.dot(towards), aside = (way - along * towards).norm();
        const double reach = mine.radius + its.radius + std::tan(sun.radius) * std::max(0.0, along + mine.radius);
        if (along > -reach && aside < reach) taken += sun.irradiance[c];
      }
      most = std::max(most, taken * albedo()[c]);
    }
    return std::min(1.0, steepest * most);
  }

  // What an effect changes where it is looked at, 64 rays each: twice the largest of some sites. An estimate.
  double sampled_bound(bool self, bool removed, const Progress& progress) {
    constexpr std::size_t some = 512;
    prepare(progress);
    std::vector<std::uint8_t> wanted(sites_.size(), 0);
    const std::size_t step = std::max<std::size_t>(1, sites_.size() / some);
    for (std::size_t i = step / 2; i < sites_.size(); i += step) wanted[i] = sides_[i];
    const auto before = light_before(self, removed, wanted, 64, progress);
    const auto after = light_after({}, wanted, 64, nullptr, Mat3::Identity(), progress);
    double most = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      if (wanted[i] == 0) continue;
      const Radiance e0 = shown(i, before), e1 = shown(i, after);
      for (int c = 0; c < 3; ++c) {
        const double color = colors_[i][c];
        // What was baked in the dark counts with the common albedo, as it is lit.
        const double albedo = e0[c] > 0 ? std::min(color / e0[c], 4 * albedo_[c]) : albedo_[c];
        const double changed = std::clamp(color + albedo * (e1[c] - e0[c]), 0.0, 1.0);
        most = std::max(most, std::abs(to_display(changed) - to_display(color)));
      }
    }
    return std::min(1.0, 2 * most);
  }

  // The change of colours under what runs; under another light than the baked one where there is a `shared`, whose
  // directions `to_shared` makes of the world's.
  std::vector<std::shared_ptr<const LightMap>> maps(bool self, bool removed, const std::vector<std::size_t>& casters,
                                                    const Light* shared, const Mat3& to_shared,
                                                    const Progress& progress) {
    prepare(progress);
    const int rays = options_.rays > 0 ? options_.rays : settings_.rays;
    const auto before = light_before(self, removed, sides_, rays, progress);
    const Mat3 in_shared = in_world() ? to_shared : Mat3(to_shared * turn());
    const auto after = light_after(casters, sides_, rays, shared, in_shared, progress);
    std::vector<Radiance> e0, e1;
    for (std::size_t i = 0; i < sites_.size(); ++i) {
      e0.push_back(shown(i, before));
      e1.push_back(shown(i, after));
    }
    const std::vector<Radiance> colors = site_colors(object(), charts_, sites_, facing_);
    std::vector<std::shared_ptr<const LightMap>> result;
    for (LightMap& map : light_maps(charts_, sites_, colors, e0, e1)) {
      const bool changes = std::any_of(map.gain.begin(), map.gain.end(),
                                       [](const Eigen::Vector3f& g) { return g != Eigen::Vector3f::Ones(); }) ||
                           !map.offset.empty();
      result.push_back(changes ? std::make_shared<const LightMap>(std::move(map)) : nullptr);
    }
    return result;
  }

  const Light& light(const Progress& progress) {
    prepare(progress);
    return *light_;
  }
  std::shared_ptr<const Light> shared_light() const { return light_; }
  double confidence() const { return confidence_; }
  // Turns its light's directions into the world's.
  Mat3 turn() const { return orthogonal_factor(to_world().linear()); }

 private:
  bool anything_missing() const {
    const std::vector<BakedBody> bodies = bodies_of(object());
    std::size_t baked = 0, there = 0;
    std::set<const void*> textures;
    for (const BakedBody& body : bodies) baked += body.object->triangle_count();
    for (const std::size_t k : relatives_) {
      there += objects_[k].node->object->triangle_count();
      for (const TextureSet& set : objects_[k].node->object->sets) textures.insert(set.texels.get());
    }
    bool erased = false;
    for (const BakedBody& body : bodies)
      for (const TextureSet& set : body.object->sets) erased = erased || !textures.contains(set.texels.get());
    return there < baked || erased;
  }

  const Affine& to_world() const { return objects_[own_].to_world; }
  // Light is traced in the object's own space, where nothing is rounded that did not move, unless that is sheared.
  bool in_world() const { return !similarity(to_world().linear()); }
  Mat3 to_light_baked() const {
    return in_world() ? Mat3(orthogonal_factor(to_world().linear()).transpose()) : Mat3(Mat3::Identity());
  }

  void prepare(const Progress& progress) {
    if (!charts_.empty()) return;
    try {
      orthogonal_factor(to_world().linear());
    } catch (const std::invalid_argument& error) {
      throw EditError(fmt::format("node \"{}\": {}", name(), error.what()));
    }
    charts_ = charts_of(object(), options_);
    sites_ = light_sites(object(), charts_);
    now_ = sites_.now;
    if (in_world()) {
      const Affine& motion = to_world();
      const Mat3 normals = motion.linear().inverse().transpose();
      for (LightSite& site : now_) {
        site.position = motion * site.position;
        site.normal = (normals * site.normal).normalized();
        const Vec3 tangent = motion.linear() * site.tangent;
        site.tangent = (tangent - tangent.dot(site.normal) * site.normal).normalized();
        site.offset *= std::cbrt(std::abs(motion.linear().determinant()));
      }
    }
    colors_ = site_colors(object(), charts_, sites_, std::vector<float>(sites_.size(), 0.5F));
    if (const auto given = given_light(settings_)) {
      light_ = given;
      confidence_ = 1;
    } else {
      const LightEstimate estimate = kept_estimate(*bodies_of(object()).front().object, options_, progress);
      light_ = std::make_shared<const Light>(estimate.light);
      confidence_ = estimate.confidence;
    }
    const auto lit = light_before(true, true, {}, 64, progress);
    facing_ = facing_of(sites_, lit, colors_);
    for (const float facing : facing_)
      sides_.push_back(static_cast<std::uint8_t>((facing > 0 ? 1 : 0) + (facing < 1 ? 2 : 0)));
    // What nine sites of ten stay below.
    std::vector<double> values;
    for (int c = 0; c < 3; ++c) {
      values.clear();
      for (std::size_t i = 0; i < sites_.size(); ++i)
        if (const double e = shown(i, lit)[c]; e > 0) values.push_back(colors_[i][c] / e);
      const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
      if (values.empty()) continue;
      std::nth_element(values.begin(), at, values.end());
      albedo_[c] = *at;
    }
  }
  const Radiance& albedo() const { return albedo_; }
  Results* traced_results() const { return options_.keep_traced ? options_.results : nullptr; }

  Radiance shown(std::size_t i, const std::vector<SiteLight>& lit) const {
    const double f = static_cast<double>(facing_[i]);
    return f * lit[i].irradiance[0] + (1 - f) * lit[i].irradiance[1];
  }

  // Without `self`, triangles count as baked where they are now.
  std::vector<SiteLight> light_before(bool self, bool removed, const std::vector<std::uint8_t>& wanted, int rays,
                                      const Progress& progress) {
    const Light& shining = *light_;
    if (moved_ && !self) {
      std::vector<Occluder> occluders;
      for (const std::size_t k : relatives_) occluders.push_back(occluder(k));
      return kept_light(now_, wanted, occluders, shining, to_light_baked(), rays, traced_results(), progress);
    }
    const std::vector<BakedBody> bodies = bodies_of(object());
    std::vector<SiteLight> result(sites_.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      std::vector<std::uint8_t> of_body(sites_.size());
      for (std::size_t i = 0; i < of_body.size(); ++i)
        of_body[i] = sites_.body[i] != b ? 0 : wanted.empty() ? 3 : wanted[i];
      std::vector<Occluder> occluders;
      if (removed || !missing_) {
        occluders.push_back({bodies[b].object, Affine::Identity()});
      } else {
        for (const std::size_t k : relatives_)
          for (const BakedBody& body : bodies_of(*objects_[k].node->object))
            if (same_body(body, bodies[b]))
              occluders.push_back({at_baked_places(*objects_[k].node->object), body.to_object.inverse()});
      }
      const auto lit =
          kept_light(sites_.baked, of_body, occluders, shining, Mat3::Identity(), rays, traced_results(), progress);
      for (std::size_t i = 0; i < of_body.size(); ++i)
        if (of_body[i] != 0) result[i] = lit[i];
    }
    return result;
  }
  std::vector<SiteLight> light_after(const std::vector<std::size_t>& casters, const std::vector<std::uint8_t>& wanted,
                                     int rays, const Light* shared, const Mat3& to_shared, const Progress& progress) {
    std::vector<Occluder> occluders;
    for (const std::size_t k : relatives_) occluders.push_back(occluder(k));
    for (const std::size_t k : casters) occluders.push_back(occluder(k));
    if (shared != nullptr)
      return kept_light(now_, wanted, occluders, *shared, to_shared, rays, traced_results(), progress);
    const std::vector<BakedBody> bodies = bodies_of(object());
    if (bodies.size() == 1)
      return kept_light(now_, wanted, occluders, *light_, to_light_baked(), rays, traced_results(), progress);
    // Each body's light turned with it when it was joined.
    std::vector<SiteLight> result(sites_.size());
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      std::vector<std::uint8_t> of_body(sites_.size());
      for (std::size_t i = 0; i < of_body.size(); ++i)
        of_body[i] = sites_.body[i] != b ? 0 : wanted.empty() ? 3 : wanted[i];
      const Mat3 to_body = orthogonal_factor(bodies[b].to_object.linear()).transpose() * to_light_baked();
      const auto lit = kept_light(now_, of_body, occluders, *light_, to_body, rays, traced_results(), progress);
      for (std::size_t i = 0; i < of_body.size(); ++i)
        if (of_body[i] != 0) result[i] = lit[i];
    }
    return result;
  }
  Occluder occluder(std::size_t k) const {
    if (in_world()) return {objects_[k].node->object, objects_[k].to_world};
    if (k == own_) return {objects_[k].node->object, Affine::Identity()};
    return {objects_[k].node->object, to_world().inverse() * objects_[k].to_world};
  }

  const std::vector<PlacedNode>& objects_;
  std::size_t own_;
  const SceneLight& settings_;
  const LightingOptions& options_;
  std::vector<std::size_t> relatives_;
  bool moved_ = false, missing_ = false;
  // Made when first needed:
  std::vector<std::shared_ptr<const LightChart>> charts_;
  LightSites sites_;
  std::vector<LightSite> now_;    // in the space that light is traced in
  std::vector<Radiance> colors_;  // seen from both sides alike
  std::vector<float> facing_;
  std::vector<std::uint8_t> sides_;  // that show, as traced_light wants them
  std::shared_ptr<const Light> light_;
  double confidence_ = 0;
  Radiance albedo_{1, 1, 1};
};

}  // namespace

std::shared_ptr<const LightMap> Lighting::map_of(NodeId node, std::size_t number, const TextureSet& set) const {
  const auto found = maps.find(node);
  if (found == maps.end() || number >= found->second.size()) return nullptr;
  const std::shared_ptr<const LightMap>& map = found->second[number];
  return map && map->chart->uvs == set.soup.shared_uvs() ? map : nullptr;
}

Lighting lighting_of(const Scene& scene, const LightingOptions& options, const Progress& progress) {
  Lighting result;
  if (!scene.light) return result;
  const SceneLight& settings = *scene.light;
  const bool estimated = settings.source == SceneLight::Source::estimated;
  std::vector<PlacedNode> objects;
  for (PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object && placed.node->object->triangle_count() > 0)
      objects.push_back(std::move(placed));

  struct Candidate {
    std::size_t decision;
    std::size_t receiver;
    enum class Kind { self, removed, cast } kind;
    std::size_t caster = 0;
  };
  std::vector<Receiver> receivers;
  receivers.reserve(objects.size());
  for (std::size_t k = 0; k < objects.size(); ++k) receivers.emplace_back(objects, k, settings, options);
  std::vector<Candidate> candidates;
  const auto say = [&](std::string name, double bound, std::string why) {
    result.decisions.push_back({std::move(name), false, bound, 0, std::move(why)});
    return result.decisions.size() - 1;
  };
  const Light* shared = nullptr;
  Mat3 to_shared = Mat3::Identity();
  if (settings.match && !receivers.empty()) {
    shared = &receivers.front().light(progress);
    // A given light stands in the world.
    if (estimated) to_shared = receivers.front().turn().transpose();
  }
  const auto matched_at = [&](std::size_t k) { return shared != nullptr && (!estimated || k > 0); };
  // Of an object that moved in itself and lost parts both shadows are traced as one; the line that follows another.
  std::map<std::size_t, std::size_t> follows;
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    Receiver& receiver = receivers[k];
    const bool self = settings.self && receiver.moved(), removed = settings.removed && receiver.missing();
    std::optional<std::size_t> own;
    if (!settings.self)
      say("self-shadow " + receiver.name(), 0, "not asked for");
    else if (!self)
      say("self-shadow " + receiver.name(), 0, "no triangle moved against its object");
    else
      own = say("self-shadow " + receiver.name(), removed ? 0 : receiver.sampled_bound(true, false, progress), "");
    if (own && !removed) candidates.push_back({*own, k, Candidate::Kind::self});
    if (receiver.missing() && !removed) say("removed shadow " + receiver.name(), 0, "not asked for");
    if (removed) {
      const std::size_t line =
          say("removed shadow " + receiver.name(), receiver.sampled_bound(receiver.moved(), true, progress), "");
      candidates.push_back({line, k, Candidate::Kind::removed});
      if (own) follows[*own] = line;
    }
    for (std::size_t other = 0; other < receivers.size(); ++other) {
      if (other == k || receiver.related(other)) continue;
      const std::string name = fmt::format("cast shadow {}→{}", receivers[other].name(), receiver.name());
      if (!settings.cast)
        say(name, 0, "not asked for");
      else
        candidates.push_back(
            {say(name, receiver.cast_bound(other, matched_at(k) ? shared : nullptr, to_shared, progress), ""), k,
             Candidate::Kind::cast, other});
    }
  }
  // The least bounds are left out while their sum stays within the budget.
  std::vector<std::size_t> order(candidates.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return result.decisions[candidates[a].decision].bound < result.decisions[candidates[b].decision].bound;
  });
  for (const std::size_t k : order) {
    LightDecision& decision = result.decisions[candidates[k].decision];
    const double sum = result.left_out + decision.bound;
    // In another light all of an object's own changes count.
    const bool in_other_light = candidates[k].kind != Candidate::Kind::cast && matched_at(candidates[k].receiver);
    decision.runs = options.everything || in_other_light || sum > settings.budget;
    decision.why = fmt::format("{} {:.2g} of 255, {:.2g} left out before it; budget {:.2g}",
                               candidates[k].kind == Candidate::Kind::cast ? "at most" : "about", decision.bound * 255,
                               result.left_out * 255, settings.budget * 255);
    if (!decision.runs) result.left_out = sum;
  }
  for (const auto& [line, other] : follows) {
    result.decisions[line].runs = result.decisions[other].runs;
    result.decisions[line].why = "together with the removed shadow";
  }
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    bool self = false, removed = false;
    std::vector<std::size_t> casters;
    std::vector<std::size_t> running;
    for (const Candidate& candidate : candidates) {
      if (candidate.receiver != k || !result.decisions[candidate.decision].runs) continue;
      running.push_back(candidate.decision);
      self = self || candidate.kind == Candidate::Kind::self;
      removed = removed || candidate.kind == Candidate::Kind::removed;
      if (candidate.kind == Candidate::Kind::cast) casters.push_back(candidate.caster);
    }
    self = self || (removed && receivers[k].moved());
    const bool matched = matched_at(k);
    if (running.empty() && !matched) continue;
    const Clock::time_point start = Clock::now();
    result.maps[objects[k].node->id] =
        receivers[k].maps(self, removed, casters, matched ? shared : nullptr, to_shared, progress);
    const double seconds = seconds_since(start);
    result.lights[objects[k].node->id] = receivers[k].shared_light();
    for (const std::size_t decision : running)
      result.decisions[decision].seconds = seconds / static_cast<double>(running.size());
    if (estimated) {
      say("light estimate " + receivers[k].name(), 0,
          fmt::format("explains {:.0f} % of its colours' variance", 100 * receivers[k].confidence()));
      result.decisions.back().runs = true;
    }
    if (matched) {
      say("matched light " + receivers[k].name(), 1,
          !estimated ? "the given light" : "that of " + receivers.front().name());
      result.decisions.back().runs = true;
      result.decisions.back().seconds = seconds;
    }
  }
  for (LightDecision& decision : result.decisions)
    if (decision.runs && decision.seconds > 0) decision.why += fmt::format(", took {:.2f} s", decision.seconds);
  return result;
}

}  // namespace rebake
