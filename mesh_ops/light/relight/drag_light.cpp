#include "mesh_ops/light/relight/drag_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_ops/light/learned/transfer_model.h"

namespace rebake {

namespace {

// Smallest determinant of a matrix that counts as a rotation; comparisons with it reject NaN.
constexpr double min_volume = 0.5;

// Orthonormal frame of a triangle: its normal, and the bisectors of two edge directions, which stretching rotates
// least. Not a rotation if the triangle has no area.
Mat3 frame_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e = (b - a).stableNormalized(), f = (c - a).stableNormalized();
  Mat3 frame;
  frame << (e + f).stableNormalized(), (e - f).stableNormalized(), e.cross(f).stableNormalized();
  return frame;
}

// The rotation nearest to a mean of similar rotations, to second order: one Newton–Schulz step of the polar
// decomposition.
Mat3 rotation_near(const Mat3& mean) { return 0.5 * mean * (3 * Mat3::Identity() - mean.transpose() * mean); }

// The chart for a soup with the same triangles but possibly other vertices.
std::shared_ptr<const LightChart> of_vertices(const std::shared_ptr<const LightChart>& chart, const Soup& from,
                                              const Soup& to) {
  if (from.shared_uvs() == to.shared_uvs()) return chart;
  auto result = std::make_shared<LightChart>(*chart);
  result->uvs = to.shared_uvs();
  result->places.assign(to.positions().size(), Eigen::Vector2f::Zero());
  for (std::size_t f = 0; f < to.triangle_count(); ++f)
    for (std::size_t k = 0; k < 3; ++k) result->places[to.faces()[f][k]] = chart->places[from.faces()[f][k]];
  return result;
}

std::vector<LightSite> keys_of(const TransferModel& model, const std::vector<LightSite>& sites) {
  std::vector<LightSite> keys;
  for (const std::uint32_t k : model.keys) keys.push_back(sites[k]);
  return keys;
}

std::vector<Mat3> turns_of(const TransferModel& model, const std::vector<Mat3>& turns) {
  std::vector<Mat3> keys;
  for (const std::uint32_t k : model.keys) keys.push_back(turns[k]);
  return keys;
}

}  // namespace

std::vector<Mat3> node_rotations(const TextureSet& from, const TextureSet& to, const LightChart& chart) {
  std::vector<Mat3> turns(chart.nodes.size(), Mat3::Identity());
  if (from.soup.shared_positions() == to.soup.shared_positions()) return turns;
  const auto *before = from.soup.rotations(), *after = to.soup.rotations();
  // Previews of large cages move vertices only and do not update their rotations.
  const bool kept = after != nullptr && after != before;
  tbb::parallel_for(std::size_t{0}, chart.nodes.size(), [&](std::size_t i) {
    const LightChart::Node& node = chart.nodes[i];
    const Face &face = from.soup.faces()[node.face], &now = to.soup.faces()[node.face];
    if (kept) {
      Mat3 mean = Mat3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = static_cast<double>(node.weights[static_cast<Eigen::Index>(k)]);
        mean += before != nullptr ? Mat3(weight * (*after)[now[k]].matrix() * (*before)[face[k]].matrix().transpose())
                                  : Mat3(weight * (*after)[now[k]].matrix());
      }
      // Corners whose rotations differ by half a turn have no mean rotation.
      if (const Mat3 turn = rotation_near(mean); turn.determinant() > min_volume) turns[i] = turn;
      return;
    }
    const auto frame = [](const TextureSet& set, const Face& f) {
      const auto& positions = set.soup.positions();
      return frame_of(positions[f[0]], positions[f[1]], positions[f[2]]);
    };
    const Mat3 turn = frame(to, now) * frame(from, face).transpose();
    if (turn.determinant() > min_volume) turns[i] = turn;
  });
  return turns;
}

DragLight::DragLight(Start start) : start_(std::move(start)) {
  for (const BodyLight& body : start_.lights) products_.emplace_back(projected_sky(*body.light, body.to_light));
  for (std::size_t i = 0; i < start_.transfer.size(); ++i)
    unrotated_.push_back(products_[start_.sites.body[i]](Mat3::Identity(), start_.transfer[i]));
  sunlit_ = suns_on(*start_.object, start_.sites.now);
  if (start_.model) prepare_model();
}

Vec3 DragLight::place_of(const BakedObject& object, std::size_t set, std::size_t number) const {
  const LightChart::Node& node = start_.charts[set]->nodes[number];
  const Soup& soup = object.sets[set].soup;
  const Face& face = soup.faces()[node.face];
  Vec3 place = Vec3::Zero();
  for (std::size_t c = 0; c < 3; ++c)
    place += static_cast<double>(node.weights[static_cast<Eigen::Index>(c)]) * soup.positions()[face[c]];
  return place;
}

std::vector<LightSite> DragLight::sites_on(const BakedObject& object,
                                           const std::vector<std::vector<Mat3>>& turns) const {
  std::vector<LightSite> sites = start_.sites.now;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    for (std::size_t k = 0; k < turns[s].size(); ++k) {
      LightSite& site = sites[start_.sites.first[s] + k];
      site.position = place_of(object, s, k);
      site.normal = turns[s][k] * site.normal;
      site.tangent = turns[s][k] * site.tangent;
    }
  return sites;
}

// Irradiance / π of each site by the suns.
std::vector<Radiance> DragLight::suns_on(const BakedObject& object, const std::vector<LightSite>& sites) const {
  std::vector<Radiance> result(sites.size(), Radiance::Zero());
  if (std::all_of(start_.lights.begin(), start_.lights.end(), [](const BodyLight& b) { return b.light->suns.empty(); }))
    return result;
  std::vector<Occluder> occluders = start_.others;
  occluders.push_back({std::make_shared<const BakedObject>(object), Affine::Identity()});
  const SceneRays around = rays_among(occluders);
  constexpr int rays = 4;
  for (std::size_t b = 0; b < start_.lights.size(); ++b) {
    std::vector<std::uint8_t> wanted(sites.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
      wanted[i] = start_.sites.body[i] == b ? visible_sides(start_.facing[i]) : 0;
    const auto lit = traced_suns(sites, wanted, around, *start_.lights[b].light, start_.lights[b].to_light, rays);
    for (std::size_t i = 0; i < lit.size(); ++i) result[i] += visible_irradiance(lit[i], start_.facing[i]);
  }
  return result;
}

void DragLight::prepare_model() {
  const TransferModel& model = *start_.model;
  const std::shared_ptr<const BakedObject> body = bodies_of(*start_.object).front().object;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    for (const Mat3& turn : node_rotations(body->sets[s], start_.object->sets[s], *start_.charts[s]))
      since_baked_.push_back(turn);
  const PoseSpace::Place place = model.learned.space.place(probes_on(*start_.object));
  if (!(place.range <= LearnedTransfer::trusted_range)) return;
  learned_ = model.predict(place, keys_of(model, start_.sites.now), turns_of(model, since_baked_));
  // Interpolation from the nearest four keys with a similar normal and the same visible side.
  const auto shown_normal = [&](std::size_t i, float facing) -> Vec3 {
    return facing == 0.0F ? Vec3(-start_.sites.baked[i].normal) : start_.sites.baked[i].normal;
  };
  shares_.resize(start_.sites.size());
  tbb::parallel_for(std::size_t{0}, shares_.size(), [&](std::size_t i) {
    std::array<double, 4> least{};
    least.fill(std::numeric_limits<double>::infinity());
    Share share{{0, 0, 0, 0}, {0, 0, 0, 0}};
    const Vec3 normal = shown_normal(i, start_.facing[i]), at = start_.sites.baked[i].position;
    for (std::uint32_t k = 0; k < model.keys.size(); ++k) {
      const std::uint32_t other = model.keys[k];
      const double distance = (start_.sites.baked[other].position - at).squaredNorm();
      if (!(distance < least[3])) continue;
      // Several vertices of a U-Net's proxy may be represented by one site.
      const auto same = [&](std::size_t j) { return std::isfinite(least[j]) && model.keys[share.keys[j]] == other; };
      if (same(0) || same(1) || same(2) || same(3)) continue;
      // The visible side is derived from the light, which may differ from that in training.
      if (start_.facing[i] != model.facing[k] || shown_normal(other, model.facing[k]).dot(normal) < 0.5) continue;
      std::size_t place_in = 3;
      for (; place_in > 0 && distance < least[place_in - 1]; --place_in) {
        least[place_in] = least[place_in - 1];
        share.keys[place_in] = share.keys[place_in - 1];
      }
      least[place_in] = distance;
      share.keys[place_in] = k;
    }
    double sum = 0, farthest = 0;
    std::array<double, 4> weights{};
    for (const double distance : least)
      if (std::isfinite(distance)) farthest = distance;
    for (std::size_t k = 0; k < 4; ++k)
      if (std::isfinite(least[k])) sum += weights[k] = farthest > 0 ? farthest / (least[k] + 1e-3 * farthest) : 1;
    for (std::size_t k = 0; k < 4; ++k) share.weights[k] = sum > 0 ? static_cast<float>(weights[k] / sum) : 0;
    shares_[i] = share;
  });
}

std::vector<Vec3> DragLight::probes_on(const BakedObject& object) const {
  std::vector<Vec3> places;
  const std::vector<std::size_t>& first = start_.sites.first;
  for (const std::uint32_t probe : start_.model->learned.probes) {
    const std::size_t site = start_.model->keys[probe];
    const auto set = static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), site) - first.begin()) - 1;
    places.push_back(place_of(object, set, site - first[set]));
  }
  return places;
}

std::optional<double> DragLight::range_of(const BakedObject& object) const {
  if (shares_.empty()) return std::nullopt;
  return start_.model->learned.space.place(probes_on(object)).range;
}

// Adds the change that the model predicts beyond rotation, if the pose is within the trusted range.
void DragLight::add_learned(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                            const std::vector<LightSite>& sites, std::vector<Radiance>& light) const {
  if (shares_.empty()) return;
  const PoseSpace::Place place = start_.model->learned.space.place(probes_on(object));
  // The prediction fades out towards the end of the range, so that nothing jumps.
  constexpr double fades = 0.5;
  const double share = std::min(1.0, (LearnedTransfer::trusted_range - place.range) / fades);
  if (!(share > 0)) return;
  std::vector<Mat3> since_rest = since_baked_;
  for (std::size_t s = 0; s < turns.size(); ++s)
    for (std::size_t k = 0; k < turns[s].size(); ++k) {
      Mat3& turn = since_rest[start_.sites.first[s] + k];
      turn = turns[s][k] * turn;
    }
  const TransferModel& model = *start_.model;
  const Eigen::VectorXf change =
      static_cast<float>(share) * (model.predict(place, keys_of(model, sites), turns_of(model, since_rest)) - learned_);
  for (std::size_t s = 0; s < turns.size(); ++s)
    tbb::parallel_for(std::size_t{0}, turns[s].size(), [&](std::size_t k) {
      const std::size_t i = start_.sites.first[s] + k;
      Eigen::Matrix<float, sh::count, 1> own = Eigen::Matrix<float, sh::count, 1>::Zero();
      for (std::size_t j = 0; j < 4; ++j)
        own += shares_[i].weights[j] *
               change.segment<sh::count>(static_cast<Eigen::Index>(shares_[i].keys[j]) * sh::count);
      light[i] += products_[start_.sites.body[i]](since_rest[i], own.cast<double>());
    });
}

bool DragLight::same_triangles(const BakedObject& first, const BakedObject& second) {
  const auto &a = first.sets, &b = second.sets;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TextureSet& x, const TextureSet& y) {
    if (x.texels != y.texels || x.soup.triangle_count() != y.soup.triangle_count()) return false;
    if (x.soup.shared_uvs() == y.soup.shared_uvs() && x.soup.shared_faces() == y.soup.shared_faces()) return true;
    // Deforming a part of a surface duplicates the vertices at its border.
    const auto corners = [](const Face& f, const Soup& soup, std::size_t k) { return soup.uvs()[f[k]]; };
    for (std::size_t f = 0; f < x.soup.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        if (corners(x.soup.faces()[f], x.soup, k) != corners(y.soup.faces()[f], y.soup, k)) return false;
    return true;
  });
}

std::vector<std::vector<Mat3>> DragLight::rotations_on(const BakedObject& object) const {
  std::vector<std::vector<Mat3>> turns;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    turns.push_back(node_rotations(start_.object->sets[s], object.sets[s], *start_.charts[s]));
  return turns;
}

std::vector<Radiance> DragLight::light_on(const BakedObject& object) const {
  const std::vector<std::vector<Mat3>> turns = rotations_on(object);
  return light_on(object, turns, sites_on(object, turns));
}

std::vector<Radiance> DragLight::light_on(const BakedObject& object, const std::vector<std::vector<Mat3>>& turns,
                                          const std::vector<LightSite>& sites) const {
  std::vector<Radiance> light = suns_on(object, sites);
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    tbb::parallel_for(std::size_t{0}, turns[s].size(), [&](std::size_t k) {
      const std::size_t i = start_.sites.first[s] + k;
      const Mat3& turn = turns[s][k];
      Radiance change = light[i] - sunlit_[i];
      if (!turn.isIdentity(0)) change += products_[start_.sites.body[i]](turn, start_.transfer[i]) - unrotated_[i];
      light[i] = start_.after[i] + change;
    });
  add_learned(object, turns, sites, light);
  for (Radiance& one : light) one = one.cwiseMax(0.0);
  return light;
}

std::vector<std::shared_ptr<const LightMap>> DragLight::maps(const BakedObject& object) const {
  std::vector<std::shared_ptr<const LightChart>> charts;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    charts.push_back(of_vertices(start_.charts[s], start_.object->sets[s].soup, object.sets[s].soup));
  const std::vector<std::vector<Mat3>> turns = rotations_on(object);
  const std::vector<LightSite> sites = sites_on(object, turns);
  return light_maps(charts, start_.sites, start_.colors, start_.before, light_on(object, turns, sites), sites,
                    start_.mirrors ? &*start_.mirrors : nullptr);
}

}  // namespace rebake
