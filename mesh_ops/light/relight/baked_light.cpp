#include "mesh_ops/light/relight/baked_light.h"

#include <algorithm>

#include "mesh_ops/light/relight/relighting.h"

namespace rebake {

BakedLight::BakedLight(std::shared_ptr<const BakedObject> object, const SceneLight& settings,
                       const LightingOptions& options, const Progress& progress)
    : object_(std::move(object)),
      bodies_(bodies_of(*object_)),
      untouched_(object_->bodies.empty() &&
                 std::none_of(object_->sets.begin(), object_->sets.end(),
                              [](const TextureSet& set) {
                                return set.soup.vertex_attributes().shared(Soup::displacement) != nullptr;
                              })),
      options_(options) {
  charts = light_charts(*object_, options.spacing, options.max_nodes);
  sites = light_sites(*object_, charts);
  colors = site_colors(*object_, charts, sites, std::vector<float>(sites.size(), 0.5F));
  if (const auto given = given_light(settings)) {
    light = given;
    confidence = 1;
  } else {
    const LightEstimate estimate =
        cached_estimate(*bodies_.front().object, options.spacing, options.max_nodes, options.results, progress);
    light = std::make_shared<const Light>(estimate.light);
    confidence = estimate.confidence;
  }
  coarse_light_ = as_baked({}, 64, progress);
  facing = facing_of(sites, coarse_light_, colors);
  for (const float one : facing) sides.push_back(visible_sides(one));
  std::vector<double> values;
  for (int c = 0; c < 3; ++c) {
    values.clear();
    for (std::size_t i = 0; i < sites.size(); ++i)
      if (const double e = visible_irradiance(coarse_light_[i], facing[i])[c]; e > 0)
        values.push_back(colors[i][c] / e);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
    if (values.empty()) continue;
    std::nth_element(values.begin(), at, values.end());
    albedo[c] = *at;
  }
}

const std::shared_ptr<const GlossFit>& BakedLight::gloss() {
  if (!gloss_)
    gloss_ =
        std::make_shared<const GlossFit>(cached_gloss(*object_, charts, sites, facing, colors, *light, coarse_light_,
                                                      {bodies_.front().object, Affine::Identity()}, options_.results));
  return gloss_;
}

const std::vector<Radiance>& BakedLight::visible_colors() {
  if (shown_colors_.empty()) shown_colors_ = site_colors(*object_, charts, sites, facing);
  return shown_colors_;
}

std::vector<std::uint8_t> BakedLight::of_body(std::size_t body, const std::vector<std::uint8_t>& wanted) const {
  std::vector<std::uint8_t> flags(sites.size());
  for (std::size_t i = 0; i < flags.size(); ++i) flags[i] = sites.body[i] != body ? 0 : wanted.empty() ? 3 : wanted[i];
  return flags;
}

std::vector<SiteLight> BakedLight::traced(const std::vector<LightSite>& at, const std::vector<std::uint8_t>& wanted,
                                          const std::vector<Occluder>& occluders, const Light& in, const Mat3& to_light,
                                          int rays, const Progress& progress) const {
  return cached_light(at, wanted, occluders, in, to_light, rays, options_.keep_traced ? options_.results : nullptr,
                      progress);
}

std::vector<SiteLight> BakedLight::as_baked(const std::vector<std::uint8_t>& wanted, int rays,
                                            const Progress& progress) {
  const bool of_shown = !wanted.empty() && wanted == sides;
  if (const auto known = visible_light_.find(rays); of_shown && known != visible_light_.end()) return known->second;
  std::vector<SiteLight> result(sites.size());
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::vector<std::uint8_t> flags = of_body(b, wanted);
    const auto lit =
        traced(sites.baked, flags, {{bodies_[b].object, Affine::Identity()}}, *light, Mat3::Identity(), rays, progress);
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i] != 0) result[i] = lit[i];
  }
  if (of_shown) visible_light_[rays] = result;
  return result;
}

std::vector<SiteLight> BakedLight::among(const std::vector<Occluder>& others, int rays, const Progress& progress) {
  if (const auto known = visible_light_.find(rays); others.empty() && known != visible_light_.end())
    return known->second;
  std::vector<Occluder> occluders{{object_, Affine::Identity()}};
  occluders.insert(occluders.end(), others.begin(), others.end());
  ResultCache* const results = options_.keep_traced ? options_.results : nullptr;
  const auto own = [&]() -> const VisibilityFlags& {
    if (const auto known = open_.find(rays); known != open_.end()) return known->second;
    VisibilityFlags open = cached_open_rays(sites.now, sides, occluders.front(), light->suns, rays, results, progress);
    return open_.emplace(rays, std::move(open)).first->second;
  };
  // Above this size, visibility flags would take too much memory: the own object is then traced again for every set of
  // occluders.
  constexpr std::uint64_t max_bytes = std::uint64_t{1} << 26;
  const bool few = VisibilityFlags::memory_for(sites.size(), rays, light->suns.size()) <= max_bytes;
  auto lit = cached_light(sites.now, sides, occluders, *light, Mat3::Identity(), rays, results, progress,
                          few ? own : std::function<const VisibilityFlags&()>());
  if (others.empty()) visible_light_[rays] = lit;
  return lit;
}

std::shared_ptr<BakedLight> BakedLights::of(const std::shared_ptr<const BakedObject>& object,
                                            const Progress& progress) {
  const auto known = std::find_if(made_.begin(), made_.end(), [&](const auto& made) {
    return made->object() == object || same_source(*made->object(), *object);
  });
  if (known != made_.end()) return *known;
  made_.push_back(std::make_shared<BakedLight>(object, settings_, options_, progress));
  return made_.back();
}

}  // namespace rebake
