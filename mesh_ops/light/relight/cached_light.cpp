#include "mesh_ops/light/relight/cached_light.h"

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "mesh_ops/light/relight/relighting.h"

namespace rebake {

namespace {

void append(std::string& bytes, const void* data, std::size_t size) {
  bytes.append(static_cast<const char*>(data), size);
}
template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
  append(bytes, values.data(), values.size() * sizeof(T));
}

void append(std::string& bytes, const std::vector<Occluder>& occluders) {
  for (const Occluder& occluder : occluders) {
    const std::uint64_t hash = surface_hash(*occluder.object);
    append(bytes, &hash, sizeof(hash));
    append(bytes, occluder.to_frame.matrix().data(), 16 * sizeof(double));
  }
}

void append(std::string& bytes, const Decoder& d) {
  for (const auto* weights : {&d.weights0, &d.weights1, &d.weights2})
    append(bytes, weights->data(), static_cast<std::size_t>(weights->size()) * sizeof(double));
  for (const auto* bias : {&d.bias0, &d.bias1, &d.bias2})
    append(bytes, bias->data(), static_cast<std::size_t>(bias->size()) * sizeof(double));
  if (d.rule != ColorRule::network) append(bytes, &d.rule, sizeof(d.rule));
}

void append_place(std::string& bytes, const Sun& sun) {
  append(bytes, sun.direction.data(), 3 * sizeof(double));
  append(bytes, &sun.radius, sizeof(double));
}

// Serialised light: per side irradiance (3 floats), open and sunny; two sides per site.
constexpr std::size_t site_floats = 10, side_floats = 5;

std::string bytes_of_light(const std::vector<SiteLight>& lit) {
  std::string bytes;
  for (const SiteLight& one : lit)
    for (std::size_t side = 0; side < 2; ++side) {
      const Eigen::Vector3f e = one.irradiance[side].cast<float>();
      append(bytes, e.data(), sizeof(e));
      append(bytes, &one.open[side], sizeof(float));
      append(bytes, &one.sun_visibility[side], sizeof(float));
    }
  return bytes;
}

std::vector<SiteLight> light_of_bytes(std::string_view bytes) {
  std::vector<SiteLight> lit(bytes.size() / (site_floats * sizeof(float)));
  for (std::size_t i = 0; i < lit.size(); ++i) {
    std::array<float, site_floats> f{};
    std::memcpy(f.data(), bytes.data() + i * sizeof(f), sizeof(f));
    for (std::size_t side = 0; side < 2; ++side) {
      const float* const own = f.data() + side * side_floats;
      lit[i].irradiance[side] = Eigen::Vector3f(own[0], own[1], own[2]).cast<double>();
      lit[i].open[side] = own[3];
      lit[i].sun_visibility[side] = own[4];
    }
  }
  return lit;
}

std::vector<sh::Coefficients> transfer_of_bytes(std::string_view bytes) {
  using Rounded = Eigen::Matrix<float, sh::count, 1>;
  std::vector<sh::Coefficients> transfer(bytes.size() / sizeof(Rounded));
  for (std::size_t i = 0; i < transfer.size(); ++i) {
    Rounded one;
    std::memcpy(one.data(), bytes.data() + i * sizeof(one), sizeof(one));
    transfer[i] = one.cast<double>();
  }
  return transfer;
}

}  // namespace

std::vector<std::shared_ptr<const LightChart>> light_charts(const BakedObject& object, double spacing,
                                                            std::size_t max_nodes) {
  for (;; spacing *= 1.5) {
    std::vector<std::shared_ptr<const LightChart>> charts;
    std::size_t nodes = 0;
    for (const TextureSet& set : object.sets) {
      charts.push_back(std::make_shared<const LightChart>(light_chart(set, spacing)));
      nodes += charts.back()->nodes.size();
    }
    if (nodes <= max_nodes || spacing > 1000) return charts;
  }
}

std::vector<SiteLight> cached_light(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                    const std::vector<Occluder>& occluders, const Light& light, const Mat3& to_light,
                                    int rays, ResultCache* results, const Progress& progress,
                                    const std::function<const VisibilityFlags&()>& first_open_rays) {
  const auto trace = [&] {
    if (!first_open_rays)
      return traced_light(sites, wanted, rays_among(occluders), light, to_light, {.rays = rays}, progress);
    const std::vector<Occluder> others(occluders.begin() + 1, occluders.end());
    return traced_light(sites, wanted, rays_among(others), light, to_light, {.rays = rays, .known = &first_open_rays()},
                        progress);
  };
  if (results == nullptr) return trace();
  std::string inputs;
  const std::array<std::size_t, 5> counts{sites.size(), wanted.size(), occluders.size(), light.sky.texels().size(),
                                          light.suns.size()};
  append(inputs, counts.data(), sizeof(counts));
  append(inputs, sites);
  append(inputs, wanted);
  append(inputs, occluders);
  append(inputs, light.sky.texels());
  for (const Sun& sun : light.suns) {
    append_place(inputs, sun);
    append(inputs, sun.irradiance.data(), 3 * sizeof(double));
  }
  append(inputs, light.bounce.data(), 3 * sizeof(double));
  append(inputs, to_light.data(), 9 * sizeof(double));
  append(inputs, &rays, sizeof(rays));
  const std::string key = result_key("light4", inputs);
  if (const auto bytes = results->find(key); bytes && bytes->size() == sites.size() * site_floats * sizeof(float))
    return light_of_bytes(*bytes);
  // Converted through the rounded bytes, so that a cache miss gives the same result as a hit.
  const std::string bytes = bytes_of_light(trace());
  results->keep(key, bytes);
  return light_of_bytes(bytes);
}

VisibilityFlags cached_open_rays(const std::vector<LightSite>& sites, const std::vector<std::uint8_t>& wanted,
                                 const Occluder& occluder, const std::vector<Sun>& suns, int rays, ResultCache* results,
                                 const Progress& progress) {
  VisibilityFlags open(sites.size(), rays, suns.size());
  std::string key;
  if (results != nullptr) {
    std::string inputs;
    append(inputs, sites);
    append(inputs, wanted);
    append(inputs, {occluder});
    for (const Sun& sun : suns) append_place(inputs, sun);
    append(inputs, &rays, sizeof(rays));
    key = result_key("openrays2", inputs);
    std::vector<std::uint64_t>& words = open.words();
    const std::size_t size = words.size() * sizeof(words[0]);
    if (const auto bytes = results->find(key); bytes && bytes->size() == size) {
      std::memcpy(words.data(), bytes->data(), size);
      return open;
    }
  }
  Light dark;
  dark.suns = suns;
  traced_light(sites, wanted, rays_among({occluder}), dark, Mat3::Identity(), {.rays = rays, .found = &open}, progress);
  if (results != nullptr) {
    const std::vector<std::uint64_t>& words = open.words();
    results->keep(key, {reinterpret_cast<const char*>(words.data()), words.size() * sizeof(words[0])});
  }
  return open;
}

std::vector<sh::Coefficients> visible_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                               const SceneRays& around, int rays, const Progress& progress) {
  std::vector<sh::Coefficients> transfer(sites.size(), sh::Coefficients::Zero());
  for (const bool back : {false, true}) {
    std::vector<LightSite> some;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (facing[i] == (back ? 1.0F : 0.0F)) continue;
      some.push_back(sites[i]);
      if (back) some.back().normal = -some.back().normal;
      numbers.push_back(i);
    }
    const Transfer traced = traced_transfer(some, around, rays, progress);
    for (std::size_t k = 0; k < numbers.size(); ++k) {
      const double share = static_cast<double>(facing[numbers[k]]);
      transfer[numbers[k]] += (back ? 1 - share : share) * traced.sites[k];
    }
  }
  return transfer;
}

std::vector<sh::Coefficients> cached_transfer(const std::vector<LightSite>& sites, const std::vector<float>& facing,
                                              const std::vector<Occluder>& occluders, int rays, ResultCache* results,
                                              const Progress& progress) {
  std::string key;
  if (results != nullptr) {
    std::string inputs;
    append(inputs, sites);
    append(inputs, facing);
    append(inputs, occluders);
    append(inputs, &rays, sizeof(rays));
    key = result_key("transfer2", inputs);
    if (const auto bytes = results->find(key); bytes && bytes->size() == sites.size() * sh::count * sizeof(float))
      return transfer_of_bytes(*bytes);
  }
  std::string bytes;
  for (const sh::Coefficients& one : visible_transfer(sites, facing, rays_among(occluders), rays, progress)) {
    const Eigen::Matrix<float, sh::count, 1> rounded = one.cast<float>();
    append(bytes, rounded.data(), sizeof(rounded));
  }
  if (results != nullptr) results->keep(key, bytes);
  return transfer_of_bytes(bytes);
}

LightEstimate cached_estimate(const BakedObject& body, double spacing, std::size_t max_nodes, ResultCache* results,
                              const Progress& progress) {
  const auto make = [&] {
    const auto charts = light_charts(body, spacing, max_nodes);
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
  append(inputs, d);
  append(inputs, &spacing, sizeof(spacing));
  append(inputs, &max_nodes, sizeof(max_nodes));
  append(inputs, &body.axes, sizeof(body.axes));
  for (const TextureSet& set : body.sets) {
    const AlphaCode code = set.texels->alpha_code();
    append(inputs, &code, sizeof(code));
  }
  const std::string key = result_key("lightestimate6", inputs);
  // Layout in doubles: sky side, confidence, bounce (3), sun direction (3), sun radius, sun irradiance (3), then the
  // sky's texels (3 each).
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
      // SkyMap calls this once per texel, in order.
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

GlossFit cached_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                      const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                      const Light& light, const std::vector<SiteLight>& baked, const Occluder& body,
                      ResultCache* results) {
  const auto make = [&] {
    return fitted_gloss(object, charts, sites, facing, colors, light, baked, rays_among({body}));
  };
  if (results == nullptr) return make();
  std::string inputs;
  append(inputs, *object.decoder);
  append(inputs, {body});
  append(inputs, sites.baked);
  append(inputs, facing);
  append(inputs, colors);
  append(inputs, baked);
  append(inputs, light.sky.texels());
  for (const Sun& sun : light.suns) {
    append_place(inputs, sun);
    append(inputs, sun.irradiance.data(), 3 * sizeof(double));
  }
  append(inputs, &object.axes, sizeof(object.axes));
  const std::string key = result_key("gloss1", inputs);
  // Layout: sharpness and explained share as doubles, then two floats per site.
  if (const auto bytes = results->find(key);
      bytes && bytes->size() == 2 * sizeof(double) + sites.size() * sizeof(Eigen::Vector2f)) {
    GlossFit fit;
    fit.gloss = gloss_environment(light);
    std::memcpy(&fit.gloss.sharpness, bytes->data(), sizeof(double));
    std::memcpy(&fit.explained, bytes->data() + sizeof(double), sizeof(double));
    fit.amounts.resize(sites.size());
    for (std::size_t i = 0; i < sites.size(); ++i)
      std::memcpy(fit.amounts[i].data(), bytes->data() + 2 * sizeof(double) + i * sizeof(Eigen::Vector2f),
                  sizeof(Eigen::Vector2f));
    return fit;
  }
  GlossFit fit = make();
  std::string bytes;
  append(bytes, &fit.gloss.sharpness, sizeof(double));
  append(bytes, &fit.explained, sizeof(double));
  append(bytes, fit.amounts);
  results->keep(key, bytes);
  return fit;
}

}  // namespace rebake
