#include "mesh_ops/light/light_receiver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/light/learned/transfer_model.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// Largest slope of display colour over linear light (sRGB).
constexpr double steepest = 12.92;
// Number of sites per estimate of a change.
constexpr std::size_t sampled_places = 2048;

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

// Whether two nodes share a body at the same place in the world. Parts that were separated and then moved are other
// objects, and so are copies elsewhere.
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

bool any_displaced(const BakedObject& object) {
  return std::any_of(object.sets.begin(), object.sets.end(), [](const TextureSet& set) {
    return set.soup.vertex_attributes().shared(Soup::displacement) != nullptr;
  });
}

// The object with its triangles at their baked positions.
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

}  // namespace

LightReceiver::LightReceiver(const std::vector<PlacedNode>& objects, std::size_t own, const SceneLight& settings,
                             const LightingOptions& options, BakedLights& known)
    : objects_(objects), own_(own), settings_(settings), options_(options), known_(known) {
  for (std::size_t k = 0; k < objects_.size(); ++k)
    if (k == own_ || share_body(placed(), objects_[k])) relatives_.push_back(k);
  // Merged objects occlude each other, which their baked light does not include.
  moved_ = any_displaced(object()) || object().bodies.size() > 1;
  missing_ = anything_missing();
}

bool LightReceiver::related(std::size_t other) const {
  return std::find(relatives_.begin(), relatives_.end(), other) != relatives_.end();
}

Mat3 LightReceiver::turn() const { return orthogonal_factor(to_world().linear()); }

// Light is traced in object space, so that unmoved objects have no rounding differences; in world space if the node is
// sheared.
bool LightReceiver::in_world() const { return !similarity(to_world().linear()); }

// Rotation from the space of tracing to the space of the object's baked light.
Mat3 LightReceiver::to_own_light() const { return in_world() ? Mat3(turn().transpose()) : Mat3(Mat3::Identity()); }

std::shared_ptr<const Light> LightReceiver::light(const Progress& progress) {
  prepare(progress);
  return baked_->light;
}

bool LightReceiver::anything_missing() const {
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

double LightReceiver::cast_bound(std::size_t other, const Shared& shared, const Progress& progress) {
  const Sphere mine = around(placed()), its = around(objects_[other]);
  const double distance = (its.center - mine.center).norm() - mine.radius;
  const double sine = distance > its.radius ? its.radius / distance : 1;
  // Early exit before the light is known, with a bound on any radiance: a sun of one degree is about 10⁴ times as
  // bright as the surfaces that it lights.
  constexpr double brightest_sun = 1e5;
  if (const double at_most = sine * sine * brightest_sun * steepest; at_most < settings_.budget / 1000) return at_most;
  prepare(progress);
  const Light& shining = shared.light != nullptr ? *shared.light : *baked_->light;
  const Mat3 to_space = shared.light != nullptr ? Mat3(shared.to_light.transpose()) : turn();
  double most = 0;
  for (int c = 0; c < 3; ++c) {
    // Occluders replace the sky's radiance by their own.
    double taken = sine * sine * std::max(shining.sky.brightest()[c], shining.bounce[c]);
    for (const Sun& sun : shining.suns) {
      const Vec3 towards = to_space * sun.direction, way = its.center - mine.center;
      const double along = way.dot(towards), aside = (way - along * towards).norm();
      const double reach = mine.radius + its.radius + std::tan(sun.radius) * std::max(0.0, along + mine.radius);
      if (along > -reach && aside < reach) taken += sun.irradiance[c];
    }
    most = std::max(most, taken * baked_->albedo[c]);
  }
  return std::min(1.0, steepest * most);
}

ChangeEstimate LightReceiver::sampled_change(bool self, bool removed, const Progress& progress) {
  prepare(progress);
  std::vector<std::uint8_t> wanted(baked_->sites.size(), 0);
  ChangeEstimate estimate;
  for (const std::size_t i : sample_places(baked_->sides, sampled_places)) {
    wanted[i] = baked_->sides[i];
    ++estimate.places;
  }
  estimate.of =
      baked_->sides.size() - static_cast<std::size_t>(std::count(baked_->sides.begin(), baked_->sides.end(), 0));
  const auto before = light_before(self, removed, wanted, 64, progress);
  const auto after = light_after({}, wanted, 64, {}, progress);
  double most = 0;
  for (std::size_t i = 0; i < baked_->sites.size(); ++i) {
    if (wanted[i] == 0) continue;
    const Radiance e0 = shown(i, before), e1 = shown(i, after);
    for (int c = 0; c < 3; ++c) {
      const double color = baked_->colors[i][c];
      // Sites that were baked in the dark use the object's albedo.
      const double albedo = e0[c] > 0 ? std::min(color / e0[c], 4 * baked_->albedo[c]) : baked_->albedo[c];
      const double changed = std::clamp(color + albedo * (e1[c] - e0[c]), 0.0, 1.0);
      most = std::max(most, std::abs(to_display(changed) - to_display(color)));
    }
  }
  estimate.change = std::min(1.0, ChangeEstimate::margin * most);
  return estimate;
}

std::shared_ptr<const GlossFit> LightReceiver::gloss(const Shared& shared, const Progress& progress) {
  prepare(progress);
  if (shared.light != nullptr || in_world() || !baked_->has_single_body()) return nullptr;
  return baked_->gloss()->any() ? baked_->gloss() : nullptr;
}

std::string LightReceiver::no_gloss_reason(const Shared& shared) const {
  if (shared.light != nullptr) return "it is lit by another light than the one it was baked in";
  if (in_world()) return "its node has a sheared transform";
  if (!baked_->has_single_body()) return "it was merged from several objects, or rotated before a merge";
  return "its colours do not depend on the view direction as specular reflection would";
}

ChangeEstimate LightReceiver::estimated_gloss_change(const GlossFit& fit) const {
  const LightSites& sites = baked_->sites;
  const std::vector<Vec3> directions = even_directions(24);
  // Only sites that rotated and reflect can change.
  std::vector<std::uint8_t> turned(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i)
    turned[i] = sites.baked[i].normal != sites.now[i].normal && !fit.amounts[i].isZero(0) ? 1 : 0;
  const std::vector<std::size_t> picked = sample_places(turned, sampled_places);
  double most = 0;
  for (const std::size_t i : picked) {
    const LightSite &before = sites.baked[i], &after = sites.now[i];
    GlossPlace place;
    place.before << before.normal.cast<float>(), fit.amounts[i][0];
    place.after << after.normal.cast<float>(), fit.amounts[i][0];
    place.suns_before = place.suns_after = fit.amounts[i][1];
    Mat3 was, is;
    was << before.tangent, before.normal, before.tangent.cross(before.normal);
    is << after.tangent, after.normal, after.tangent.cross(after.normal);
    const Mat3 turn = is * was.transpose();
    for (const Vec3& now : directions) {
      const Radiance change = gloss_change(fit.gloss, place, Radiance::Ones(), turn.transpose() * now, now);
      for (int c = 0; c < 3; ++c) {
        const double color = baked_->colors[i][c];
        most = std::max(most, std::abs(to_display(std::clamp(color + change[c], 0.0, 1.0)) - to_display(color)));
      }
    }
  }
  return {std::min(1.0, ChangeEstimate::margin * most), picked.size(),
          static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1))};
}

LightReceiver::Change LightReceiver::change(bool self, bool removed, const std::vector<std::size_t>& casters,
                                            const Shared& shared, const std::shared_ptr<const GlossFit>& gloss,
                                            const Progress& progress) {
  prepare(progress);
  const int rays = options_.rays > 0 ? options_.rays : settings_.rays;
  std::vector<SiteLight> before, after;
  if (!casters.empty() && shared.light == nullptr && baked_->untouched() && relatives_.size() == 1 && !in_world()) {
    // Self-occlusion is as baked, so it is traced once for both.
    std::vector<Occluder> others;
    for (const std::size_t k : casters) others.push_back(occluder(k));
    before = baked_->among({}, rays, progress);
    after = baked_->among(others, rays, progress);
  } else {
    before = light_before(self, removed, baked_->sides, rays, progress);
    after = light_after(casters, baked_->sides, rays, shared, progress);
  }
  Change change{{}, {}, baked_->visible_colors(), {}};
  if (gloss) change.mirrors = GlossVisibility{gloss, {}, {}};
  for (std::size_t i = 0; i < baked_->sites.size(); ++i) {
    change.before.push_back(shown(i, before));
    change.after.push_back(shown(i, after));
    if (!gloss) continue;
    change.mirrors->before.push_back(surface_visibility(before[i], baked_->facing[i]));
    change.mirrors->after.push_back(surface_visibility(after[i], baked_->facing[i]));
  }
  return change;
}

std::vector<std::shared_ptr<const LightMap>> LightReceiver::maps(const Change& change) const {
  return light_maps(charts_, baked_->sites, change.colors, change.before, change.after, now(),
                    change.mirrors ? &*change.mirrors : nullptr);
}

// The cached model of the object's body; null if there is none or it cannot be parsed.
std::shared_ptr<const TransferModel> LightReceiver::cached_model() const {
  const std::vector<BakedBody> bodies = bodies_of(object());
  if (options_.results == nullptr || bodies.size() != 1 || !bodies.front().to_object.matrix().isIdentity(0))
    return nullptr;
  const BakedObject& body = *bodies.front().object;
  const auto bytes = options_.results->find(transfer_model_key(body, baked_->sites.size()));
  if (!bytes || !DragLight::same_triangles(body, object())) return nullptr;
  try {
    auto model = std::make_shared<const TransferModel>(transfer_model_of(*bytes));
    return model->body == surface_hash(body) && model->sites == baked_->sites.size() ? model : nullptr;
  } catch (const std::exception&) {
    return nullptr;
  }
}

std::shared_ptr<const DragLight> LightReceiver::turned(const Change& change, const std::vector<std::size_t>& casters,
                                                       const Shared& shared, const Progress& progress) const {
  // Sheared objects are traced in world space, in which their triangles do not rotate rigidly.
  if (in_world() || !settings_.self) return nullptr;
  DragLight::Start start{
      placed().node->object, charts_, baked_->sites, baked_->facing, change.colors, change.before, change.after, {}, {},
      cached_model(),        {},      change.mirrors};
  for (const std::size_t k : relatives_)
    if (k != own_) start.others.push_back(occluder(k));
  for (const std::size_t k : casters) start.others.push_back(occluder(k));
  std::vector<Occluder> occluders = start.others;
  occluders.push_back(occluder(own_));
  constexpr int rays = 64;
  start.transfer = cached_transfer(now(), baked_->facing, occluders, rays, options_.results, progress);
  const std::vector<BakedBody> bodies = bodies_of(object());
  for (const BakedBody& body : bodies) {
    if (shared.light != nullptr)
      start.lights.push_back({std::make_shared<const Light>(*shared.light), shared.to_light * turn()});
    else
      start.lights.push_back({baked_->light, bodies.size() == 1
                                                 ? Mat3(Mat3::Identity())
                                                 : Mat3(orthogonal_factor(body.to_object.linear()).transpose())});
  }
  return std::make_shared<const DragLight>(std::move(start));
}

void LightReceiver::prepare(const Progress& progress) {
  if (baked_) return;
  try {
    orthogonal_factor(to_world().linear());
    for (const BakedBody& body : bodies_of(object())) orthogonal_factor(body.to_object.linear());
  } catch (const std::invalid_argument& error) {
    throw EditError(fmt::format("node \"{}\": {}", name(), error.what()));
  }
  baked_ = known_.of(placed().node->object, progress);
  for (std::size_t s = 0; s < baked_->charts.size(); ++s) {
    charts_.push_back(baked_->charts[s]);
    const Soup::Uvs uvs = object().sets[s].soup.shared_uvs();
    if (charts_[s]->uvs == uvs) continue;
    // The object was read again from the same files: its UV array is another one with the same content.
    LightChart own = *charts_[s];
    own.uvs = uvs;
    charts_[s] = std::make_shared<const LightChart>(std::move(own));
  }
  if (!in_world()) return;
  in_world_ = baked_->sites.now;
  const Affine& motion = to_world();
  const Mat3 normals = motion.linear().inverse().transpose();
  for (LightSite& site : in_world_) {
    site.position = motion * site.position;
    site.normal = (normals * site.normal).normalized();
    const Vec3 tangent = motion.linear() * site.tangent;
    site.tangent = (tangent - tangent.dot(site.normal) * site.normal).normalized();
    for (double& offset : site.offset) offset *= std::cbrt(std::abs(motion.linear().determinant()));
  }
}

const std::vector<LightSite>& LightReceiver::now() const { return in_world() ? in_world_ : baked_->sites.now; }

Radiance LightReceiver::shown(std::size_t i, const std::vector<SiteLight>& lit) const {
  return visible_irradiance(lit[i], baked_->facing[i]);
}

Occluder LightReceiver::occluder(std::size_t k) const {
  if (in_world()) return {objects_[k].node->object, objects_[k].to_world};
  if (k == own_) return {objects_[k].node->object, Affine::Identity()};
  return {objects_[k].node->object, to_world().inverse() * objects_[k].to_world};
}

std::vector<Occluder> LightReceiver::relatives() const {
  std::vector<Occluder> occluders;
  for (const std::size_t k : relatives_) occluders.push_back(occluder(k));
  return occluders;
}

// Without `self`, the present positions of triangles count as those at baking.
std::vector<SiteLight> LightReceiver::light_before(bool self, bool removed, const std::vector<std::uint8_t>& wanted,
                                                   int rays, const Progress& progress) const {
  if (moved_ && !self)
    return baked_->traced(now(), wanted, relatives(), *baked_->light, to_own_light(), rays, progress);
  if (removed || !missing_) return baked_->as_baked(wanted, rays, progress);
  const std::vector<BakedBody> bodies = bodies_of(object());
  std::vector<SiteLight> result(baked_->sites.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    std::vector<Occluder> occluders;
    for (const std::size_t k : relatives_)
      for (const BakedBody& body : bodies_of(*objects_[k].node->object))
        if (same_body(body, bodies[b]))
          occluders.push_back({at_baked_places(*objects_[k].node->object), body.to_object.inverse()});
    const std::vector<std::uint8_t> flags = baked_->of_body(b, wanted);
    const auto lit =
        baked_->traced(baked_->sites.baked, flags, occluders, *baked_->light, Mat3::Identity(), rays, progress);
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i] != 0) result[i] = lit[i];
  }
  return result;
}

std::vector<SiteLight> LightReceiver::light_after(const std::vector<std::size_t>& casters,
                                                  const std::vector<std::uint8_t>& wanted, int rays,
                                                  const Shared& shared, const Progress& progress) const {
  std::vector<Occluder> occluders = relatives();
  for (const std::size_t k : casters) occluders.push_back(occluder(k));
  if (shared.light != nullptr)
    return baked_->traced(now(), wanted, occluders, *shared.light,
                          in_world() ? shared.to_light : Mat3(shared.to_light * turn()), rays, progress);
  const std::vector<BakedBody> bodies = bodies_of(object());
  if (bodies.size() == 1)
    return baked_->traced(now(), wanted, occluders, *baked_->light, to_own_light(), rays, progress);
  // The light of each body rotated with it when it was merged.
  std::vector<SiteLight> result(baked_->sites.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Mat3 to_body = orthogonal_factor(bodies[b].to_object.linear()).transpose() * to_own_light();
    const std::vector<std::uint8_t> flags = baked_->of_body(b, wanted);
    const auto lit = baked_->traced(now(), flags, occluders, *baked_->light, to_body, rays, progress);
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i] != 0) result[i] = lit[i];
  }
  return result;
}

}  // namespace rebake
