#include "mesh_ops/light/transport/gloss.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh_ops/index/footprint.h"
#include "mesh_ops/light/transport/chromaticity.h"
#include "mesh_ops/light/transport/rotated_product.h"
#include "mesh_ops/light/transport/site_rays.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// Reflectance of a dielectric of index 1.5 at normal incidence.
constexpr double facing_reflectance = 0.04;

double fresnel(double cosine) {
  return facing_reflectance + (1 - facing_reflectance) * std::pow(1 - std::min(1.0, cosine), 5);
}

Radiance mirrored_sky(const Gloss& gloss, const Vec3& mirror) {
  const sh::Coefficients basis = sh::basis(mirror);
  return Radiance(gloss.sky[0].dot(basis), gloss.sky[1].dot(basis), gloss.sky[2].dot(basis)).cwiseMax(0.0);
}

Radiance mirrored_suns(const Gloss& gloss, const Vec3& mirror, double sharpness) {
  Radiance sum = Radiance::Zero();
  for (const Sun& sun : gloss.suns)
    if (const double cosine = mirror.dot(sun.direction); cosine > 0)
      sum += std::pow(cosine, sharpness) * sun.irradiance;
  return sum;
}

// View dependence of a site: its colours, and the reflections of the sky and of suns that may explain them. One value
// per channel and direction, minus the mean over the directions of a side.
struct Views {
  std::uint32_t material;
  Eigen::ArrayXd colors, sky;
  std::vector<Eigen::ArrayXd> suns;  // per candidate sharpness
};

// Candidate exponents. Broader lobes cannot be distinguished from diffuse colour.
constexpr std::array<double, 7> sharpnesses{4, 8, 16, 32, 64, 128, 256};
constexpr int views_per_side = 24;
constexpr std::size_t max_sites = 6000;
constexpr double few_sites = 50;

// Normal equations of the least-squares fit of one material.
struct Equations {
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  Eigen::Vector2d aims = Eigen::Vector2d::Zero();

  void add(const Views& seen, std::size_t sharpness) {
    const Eigen::ArrayXd& suns = seen.suns[sharpness];
    const double both = (seen.sky * suns).sum();
    products += (Eigen::Matrix2d() << seen.sky.square().sum(), both, both, suns.square().sum()).finished();
    aims += Eigen::Vector2d((seen.sky * seen.colors).sum(), (suns * seen.colors).sum());
  }
  Eigen::Vector2d solved() const {
    const double determinant = products.determinant();
    if (determinant > 1e-9 * products(0, 0) * products(1, 1)) {
      const Eigen::Vector2d both = products.inverse() * aims;
      if (both.minCoeff() >= 0) return both;
    }
    // Otherwise a single term, the one that explains more.
    Eigen::Vector2d best = Eigen::Vector2d::Zero();
    double most = 0;
    for (Eigen::Index k = 0; k < 2; ++k) {
      if (!(products(k, k) > 0) || !(aims[k] > 0)) continue;
      if (const double gain = aims[k] * aims[k] / products(k, k); gain > most) {
        most = gain;
        best = Eigen::Vector2d::Zero();
        best[k] = aims[k] / products(k, k);
      }
    }
    return best;
  }
  double accounted(const Eigen::Vector2d& amounts) const {
    return 2 * amounts.dot(aims) - amounts.dot(products * amounts);
  }
};

}  // namespace

Gloss gloss_environment(const Light& light) {
  Light open = light;
  open.bounce = Radiance::Zero();
  Gloss gloss;
  gloss.sky = projected_sky(open, Mat3::Identity());
  for (sh::Coefficients& channel : gloss.sky) channel = sh::windowed(channel, sh::Window::lanczos);
  gloss.suns = light.suns;
  std::stable_sort(gloss.suns.begin(), gloss.suns.end(),
                   [](const Sun& a, const Sun& b) { return a.irradiance.sum() > b.irradiance.sum(); });
  if (gloss.suns.size() > Gloss::max_suns) gloss.suns.resize(Gloss::max_suns);
  return gloss;
}

Radiance mirrored(const Gloss& gloss, const Vec3& direction, const Vec3& normal, double sky, double suns) {
  if (normal.isZero(0)) return Radiance::Zero();
  const double along = normal.dot(direction);
  const Vec3 mirror = direction - 2 * along * normal;
  Radiance sum = Radiance::Zero();
  if (sky > 0) sum += sky * mirrored_sky(gloss, mirror);
  if (suns > 0) sum += suns * mirrored_suns(gloss, mirror, gloss.sharpness);
  return fresnel(std::abs(along)) * sum;
}

SiteVisibility surface_visibility(const SiteLight& lit, float facing) {
  SiteVisibility result(facing * lit.open[0] + (1 - facing) * lit.open[1], 0);
  if (facing > 0) result[1] = lit.sun_visibility[0];
  // A sun is above one side only.
  if (facing < 1) result[1] = std::max(result[1], lit.sun_visibility[1]);
  return result;
}

namespace {

// Views of one object's sites for the fit.
class SiteViewer {
 public:
  SiteViewer(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
             const LightSites& sites, const std::vector<float>& facing, const std::vector<SiteLight>& baked,
             const SceneRays& body, const Gloss& gloss)
      : object_(object),
        charts_(charts),
        sites_(sites),
        facing_(facing),
        baked_(baked),
        body_(body),
        gloss_(gloss),
        axes_(axes_matrix(object.axes)),
        look_(*object.decoder, {}),
        disk_(disk_points(views_per_side)) {}

  // The colours of site `i` from many directions, and what the sky and the suns would add. Empty if its texel is
  // transparent or it is occluded all around.
  Views views_of(std::size_t i) const {
    Views seen;
    const auto features = features_at(i);
    if (!features) return seen;
    std::vector<Eigen::Index> sides{0};  // end of each side's directions
    const std::vector<Vec3> directions = open_directions(i, sides);
    const std::size_t count = directions.size();
    if (count == 0) return seen;
    std::vector<Vec3> fed;
    for (const Vec3& d : directions) fed.push_back(axes_ * d);
    std::vector<Color> decoded(count);
    look_.decode_each(std::vector<TexelColors::Features>(count, *features), fed, decoded);
    const auto size = static_cast<Eigen::Index>(3 * count);
    seen.colors.resize(size);
    seen.sky.resize(size);
    seen.suns.assign(sharpnesses.size(), Eigen::ArrayXd(size));
    const SiteVisibility open = surface_visibility(baked_[i], facing_[i]);
    const Vec3& normal = sites_.baked[i].normal;
    for (std::size_t k = 0; k < count; ++k) {
      const double along = normal.dot(directions[k]), share = fresnel(std::abs(along));
      const Vec3 mirror = directions[k] - 2 * along * normal;
      const Radiance sky = share * static_cast<double>(open[0]) * mirrored_sky(gloss_, mirror);
      const auto row = [&](int c) {
        return static_cast<Eigen::Index>(c) * static_cast<Eigen::Index>(count) + static_cast<Eigen::Index>(k);
      };
      for (int c = 0; c < 3; ++c) {
        seen.colors[row(c)] = to_linear(decoded[k][c]);
        seen.sky[row(c)] = sky[c];
      }
      for (std::size_t j = 0; j < sharpnesses.size(); ++j) {
        const Radiance suns = share * static_cast<double>(open[1]) * mirrored_suns(gloss_, mirror, sharpnesses[j]);
        for (int c = 0; c < 3; ++c) seen.suns[j][row(c)] = suns[c];
      }
    }
    // The mean over the directions of a side is diffuse colour, so it is subtracted.
    const auto less_mean = [&](Eigen::ArrayXd& values) {
      for (Eigen::Index c = 0; c < 3; ++c)
        for (std::size_t side = 1; side < sides.size(); ++side)
          if (const Eigen::Index first = sides[side - 1], some = sides[side] - first; some > 0) {
            auto own = values.segment(c * static_cast<Eigen::Index>(count) + first, some);
            own -= own.mean();
          }
    };
    less_mean(seen.colors);
    less_mean(seen.sky);
    for (Eigen::ArrayXd& one : seen.suns) less_mean(one);
    return seen;
  }

 private:
  // The features of the site's texel; nothing if it is transparent.
  std::optional<TexelColors::Features> features_at(std::size_t i) const {
    const auto s =
        static_cast<std::size_t>(std::upper_bound(sites_.first.begin(), sites_.first.end(), i) - sites_.first.begin()) -
        1;
    const TextureSet& set = object_.sets[s];
    const LightChart::Node& node = charts_[s]->nodes[i - sites_.first[s]];
    const auto corners = texel_corners(set, node.face);
    const Vec2 at = static_cast<double>(node.weights[0]) * corners[0] +
                    static_cast<double>(node.weights[1]) * corners[1] +
                    static_cast<double>(node.weights[2]) * corners[2];
    const int x = std::clamp(static_cast<int>(std::floor(at.x())), 0, set.texels->width() - 1),
              y = std::clamp(static_cast<int>(std::floor(at.y())), 0, set.texels->height() - 1);
    if (!set.texels->opaque(x, y)) return std::nullopt;
    return decode_features(TexelReader(*set.texels).at(x, y), set.texels->alpha_code());
  }

  // View directions from which the site is visible. Occluded ones are skipped: the decoder was not fitted to them.
  std::vector<Vec3> open_directions(std::size_t i, std::vector<Eigen::Index>& sides) const {
    std::vector<Vec3> directions;
    for (const bool back : {false, true}) {
      if ((back ? 1 - facing_[i] : facing_[i]) == 0) continue;
      const SiteFrame frame(sites_.baked[i], i, back);
      for (const DiskPoint& p : disk_)
        if (const Vec3 d = frame.direction(p); !body_.shaded(frame.from(), d)) directions.push_back(-d);
      sides.push_back(static_cast<Eigen::Index>(directions.size()));
    }
    return directions;
  }

  const BakedObject& object_;
  const std::vector<std::shared_ptr<const LightChart>>& charts_;
  const LightSites& sites_;
  const std::vector<float>& facing_;
  const std::vector<SiteLight>& baked_;
  const SceneRays& body_;
  const Gloss& gloss_;
  Mat3 axes_;
  TexelColors look_;
  std::vector<DiskPoint> disk_;
};

// How much of the squared colours amounts of sky and sun per material explain, with one sharpness.
struct MaterialFit {
  double explained = 0;
  std::vector<Eigen::Vector2d> amounts;
};
MaterialFit fit_materials(const std::vector<Views>& views, std::size_t materials, std::size_t sharpness) {
  std::vector<Equations> equations(materials);
  Equations together;
  for (const Views& seen : views) {
    if (seen.colors.size() == 0) continue;
    for (Equations* e : {&equations[seen.material], &together}) e->add(seen, sharpness);
  }
  MaterialFit fit;
  for (const Equations& e : equations) {
    // Regularisation: clusters of few sites follow the fit of all sites.
    Equations held = e;
    held.products += few_sites / static_cast<double>(views.size()) * together.products;
    held.aims += few_sites / static_cast<double>(views.size()) * together.aims;
    fit.amounts.push_back(held.solved());
    fit.explained += e.accounted(fit.amounts.back());
  }
  return fit;
}

}  // namespace

GlossFit fitted_gloss(const BakedObject& object, const std::vector<std::shared_ptr<const LightChart>>& charts,
                      const LightSites& sites, const std::vector<float>& facing, const std::vector<Radiance>& colors,
                      const Light& light, const std::vector<SiteLight>& baked, const SceneRays& body) {
  GlossFit fit;
  fit.gloss = gloss_environment(light);
  fit.amounts.assign(sites.size(), Eigen::Vector2f::Zero());
  if (sites.size() == 0) return fit;
  const std::vector<std::uint32_t> clusters = chromaticity_clusters(colors);
  const std::size_t materials = *std::max_element(clusters.begin(), clusters.end()) + 1;
  const std::size_t step = std::max<std::size_t>(1, sites.size() / max_sites);
  std::vector<std::size_t> looked_at;
  for (std::size_t i = 0; i < sites.size(); i += step)
    if (sites.baked[i].normal.squaredNorm() > 0.5) looked_at.push_back(i);
  const SiteViewer viewer(object, charts, sites, facing, baked, body, fit.gloss);
  std::vector<Views> views(looked_at.size());
  tbb::parallel_for(std::size_t{0}, looked_at.size(), [&](std::size_t n) {
    views[n] = viewer.views_of(looked_at[n]);
    views[n].material = clusters[looked_at[n]];
  });
  double all = 0, most = 0;
  for (const Views& seen : views) all += seen.colors.square().sum();
  std::vector<Eigen::Vector2d> best(materials, Eigen::Vector2d::Zero());
  for (std::size_t j = 0; j < sharpnesses.size(); ++j) {
    MaterialFit found = fit_materials(views, materials, j);
    if (!(found.explained > most)) continue;
    most = found.explained;
    best = std::move(found.amounts);
    fit.gloss.sharpness = sharpnesses[j];
  }
  constexpr double min_explained = 0.1;
  if (!(most >= min_explained * all) || !(all > 0)) return fit;
  fit.explained = most / all;
  for (std::size_t i = 0; i < sites.size(); ++i) fit.amounts[i] = best[clusters[i]].cast<float>();
  return fit;
}

std::shared_ptr<const GlossMap> gloss_map(const LightChart& chart, const LightSites& sites,
                                          const std::vector<LightSite>& now, std::size_t first,
                                          const std::shared_ptr<const GlossFit>& fit,
                                          const std::vector<SiteVisibility>& before,
                                          const std::vector<SiteVisibility>& after) {
  GlossMap map;
  map.gloss = {fit, &fit->gloss};
  for (GlossMap::Side* side : {&map.before, &map.after}) {
    side->normals.assign(chart.texel_count(), Eigen::Vector4f::Zero());
    side->suns.assign(chart.texel_count(), 0);
  }
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> patch_at(chart.texel_count(), none);
  bool any = false;
  for (std::size_t n = 0; n < chart.nodes.size(); ++n) {
    const std::size_t i = first + n, texel = chart.nodes[n].texel;
    Vec3 as_baked = sites.baked[i].normal, as_is = now[i].normal;
    // Normals are interpolated between nodes, but triangles of a soup may face either way. Reflection does not depend
    // on the normal's sign, so the sign follows that of a neighbour in the patch.
    const auto beside = [&](std::size_t other) {
      return map.before.normals[other].head<3>().dot(as_baked.cast<float>());
    };
    const auto width = static_cast<std::size_t>(chart.width);
    const auto same_patch = [&](std::size_t other) { return patch_at[other] == chart.nodes[n].patch; };
    patch_at[texel] = chart.nodes[n].patch;
    float along = 0;
    if (texel % width > 0 && same_patch(texel - 1))
      along = beside(texel - 1);
    else if (texel >= width && same_patch(texel - width))
      along = beside(texel - width);
    if (along < 0) {
      as_baked = -as_baked;
      as_is = -as_is;
    }
    const Eigen::Vector2f was = fit->amounts[i].cwiseProduct(before[i]), is = fit->amounts[i].cwiseProduct(after[i]);
    map.before.normals[texel] << as_baked.cast<float>(), was[0];
    map.after.normals[texel] << as_is.cast<float>(), is[0];
    map.before.suns[texel] = was[1];
    map.after.suns[texel] = is[1];
    any = any || was != is || (!was.isZero(0) && as_baked != as_is);
  }
  return any ? std::make_shared<const GlossMap>(std::move(map)) : nullptr;
}

Radiance gloss_change(const Gloss& gloss, const GlossPlace& place, const Radiance& gain, const Vec3& baked,
                      const Vec3& now) {
  const auto side = [&](const Eigen::Vector4f& normal, float suns, const Vec3& direction) {
    return mirrored(gloss, direction, normal.head<3>().cast<double>().stableNormalized(),
                    static_cast<double>(normal[3]), static_cast<double>(suns));
  };
  return side(place.after, place.suns_after, now) - gain.cwiseProduct(side(place.before, place.suns_before, baked));
}

}  // namespace rebake
