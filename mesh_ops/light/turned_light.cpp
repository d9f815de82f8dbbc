#include "mesh_ops/light/turned_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace rebake {

namespace {

// Orthonormal axes that go with a triangle: its normal and the bisectors of two edges' directions, which stretching
// turns least. Not finite where there is no area.
Mat3 frame_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e = (b - a).stableNormalized(), f = (c - a).stableNormalized();
  Mat3 frame;
  frame << (e + f).stableNormalized(), (e - f).stableNormalized(), e.cross(f).stableNormalized();
  return frame;
}

// The nearest rotation to a mean of rotations that differ little, to second order.
Mat3 rotation_near(const Mat3& mean) { return 0.5 * mean * (3 * Mat3::Identity() - mean.transpose() * mean); }

// The same chart of a soup with the same triangles, of which vertices may be others.
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

}  // namespace

std::vector<Mat3> node_turns(const TextureSet& from, const TextureSet& to, const LightChart& chart) {
  std::vector<Mat3> turns(chart.nodes.size(), Mat3::Identity());
  if (from.soup.shared_positions() == to.soup.shared_positions()) return turns;
  const auto *before = from.soup.rotations(), *after = to.soup.rotations();
  // Previews of large cages move vertices only: their rotations are those of before.
  const bool kept = after != nullptr && after != before;
  tbb::parallel_for(std::size_t{0}, chart.nodes.size(), [&](std::size_t i) {
    const LightChart::Node& node = chart.nodes[i];
    const Face &face = from.soup.faces()[node.face], &now = to.soup.faces()[node.face];
    if (kept) {
      Mat3 mean = Mat3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = static_cast<double>(node.weights[static_cast<Eigen::Index>(k)]);
        mean += before != nullptr ? Mat3(weight * (*after)[now[k]] * (*before)[face[k]].transpose())
                                  : Mat3(weight * (*after)[now[k]]);
      }
      turns[i] = rotation_near(mean);
      return;
    }
    const auto frame = [](const TextureSet& set, const Face& f) {
      const auto& positions = set.soup.positions();
      return frame_of(positions[f[0]], positions[f[1]], positions[f[2]]);
    };
    const Mat3 turn = frame(to, now) * frame(from, face).transpose();
    if (turn.allFinite()) turns[i] = turn;
  });
  return turns;
}

TurnedLight::TurnedLight(Start start) : start_(std::move(start)) {
  for (const BodyLight& body : start_.lights) products_.emplace_back(projected_sky(*body.light, body.to_light));
  std::vector<std::vector<Mat3>> turns;
  for (const auto& chart : start_.charts) turns.emplace_back(chart->nodes.size(), Mat3::Identity());
  for (std::size_t i = 0; i < start_.transfer.size(); ++i)
    unturned_.push_back(products_[start_.sites.body[i]](Mat3::Identity(), start_.transfer[i]));
  sunlit_ = suns_on(*start_.object, turns);
}

// Irradiance over π that suns give each site when it has turned.
std::vector<Radiance> TurnedLight::suns_on(const BakedObject& object,
                                           const std::vector<std::vector<Mat3>>& turns) const {
  std::vector<Radiance> result(start_.sites.size(), Radiance::Zero());
  if (std::all_of(start_.lights.begin(), start_.lights.end(), [](const BodyLight& b) { return b.light->suns.empty(); }))
    return result;
  std::vector<LightSite> sites = start_.sites.now;
  std::vector<std::uint8_t> sides(sites.size());
  for (std::size_t s = 0; s < start_.charts.size(); ++s) {
    const Soup& soup = object.sets[s].soup;
    for (std::size_t k = 0; k < turns[s].size(); ++k) {
      const LightChart::Node& node = start_.charts[s]->nodes[k];
      const Face& face = soup.faces()[node.face];
      const std::size_t i = start_.sites.first[s] + k;
      LightSite& site = sites[i];
      site.position = Vec3::Zero();
      for (std::size_t c = 0; c < 3; ++c)
        site.position += static_cast<double>(node.weights[static_cast<Eigen::Index>(c)]) * soup.positions()[face[c]];
      site.normal = turns[s][k] * site.normal;
      site.tangent = turns[s][k] * site.tangent;
      sides[i] = shown_sides(start_.facing[i]);
    }
  }
  std::vector<Occluder> occluders = start_.others;
  occluders.push_back({std::make_shared<const BakedObject>(object), Affine::Identity()});
  const SceneRays around = rays_among(occluders);
  constexpr int rays = 4;
  for (std::size_t b = 0; b < start_.lights.size(); ++b) {
    std::vector<std::uint8_t> wanted(sides.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = start_.sites.body[i] == b ? sides[i] : 0;
    const auto lit = traced_suns(sites, wanted, around, *start_.lights[b].light, start_.lights[b].to_light, rays);
    for (std::size_t i = 0; i < lit.size(); ++i) result[i] += shown_light(lit[i], start_.facing[i]);
  }
  return result;
}

bool TurnedLight::fits(const BakedObject& object) const {
  const auto &a = start_.object->sets, &b = object.sets;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TextureSet& x, const TextureSet& y) {
    if (x.texels != y.texels || x.soup.triangle_count() != y.soup.triangle_count()) return false;
    if (x.soup.shared_uvs() == y.soup.shared_uvs() && x.soup.shared_faces() == y.soup.shared_faces()) return true;
    // Where part of a surface moves, vertices at its border become two.
    const auto corners = [](const Face& f, const Soup& soup, std::size_t k) { return soup.uvs()[f[k]]; };
    for (std::size_t f = 0; f < x.soup.triangle_count(); ++f)
      for (std::size_t k = 0; k < 3; ++k)
        if (corners(x.soup.faces()[f], x.soup, k) != corners(y.soup.faces()[f], y.soup, k)) return false;
    return true;
  });
}

std::vector<Radiance> TurnedLight::light_on(const BakedObject& object) const {
  std::vector<std::vector<Mat3>> turns;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    turns.push_back(node_turns(start_.object->sets[s], object.sets[s], *start_.charts[s]));
  std::vector<Radiance> light = suns_on(object, turns);
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    tbb::parallel_for(std::size_t{0}, turns[s].size(), [&](std::size_t k) {
      const std::size_t i = start_.sites.first[s] + k;
      const Mat3& turn = turns[s][k];
      Radiance change = light[i] - sunlit_[i];
      if (!turn.isIdentity(0)) change += products_[start_.sites.body[i]](turn, start_.transfer[i]) - unturned_[i];
      light[i] = (start_.after[i] + change).cwiseMax(0.0);
    });
  return light;
}

std::vector<std::shared_ptr<const LightMap>> TurnedLight::maps(const BakedObject& object) const {
  std::vector<std::shared_ptr<const LightChart>> charts;
  for (std::size_t s = 0; s < start_.charts.size(); ++s)
    charts.push_back(of_vertices(start_.charts[s], start_.object->sets[s].soup, object.sets[s].soup));
  return light_maps(charts, start_.sites, start_.colors, start_.before, light_on(object));
}

}  // namespace rebake
