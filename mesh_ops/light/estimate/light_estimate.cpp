#include "mesh_ops/light/estimate/light_estimate.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/light/transport/chromaticity.h"
#include "mesh_ops/light/transport/site_rays.h"

namespace rebake {

namespace {

using std::numbers::pi;
constexpr double golden = 0.6180339887498949;

std::vector<Vec3> sphere_points(int count) {
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) {
    const double y = 1 - 2 * (k + 0.5) / count, r = std::sqrt(1 - y * y), phi = 2 * pi * std::fmod(k * golden, 1.0);
    points.emplace_back(r * std::cos(phi), y, r * std::sin(phi));
  }
  return points;
}

// Spherical Gaussians about even directions, normalised to sum to 1 everywhere.
class Lobes {
 public:
  explicit Lobes(int count) : centers_(sphere_points(count)), sharpness_(count / 4.0) {}
  std::size_t size() const { return centers_.size(); }
  const Vec3& center(std::size_t k) const { return centers_[k]; }
  void weights(const Vec3& d, std::vector<double>& out) const {
    out.resize(size());
    double sum = 0;
    for (std::size_t k = 0; k < size(); ++k) sum += out[k] = std::exp(sharpness_ * (d.dot(centers_[k]) - 1));
    for (double& w : out) w /= sum;
  }

 private:
  std::vector<Vec3> centers_;
  double sharpness_;
};

struct Sample {
  std::uint32_t site;
  double facing = 0.5;
  std::uint32_t cluster = 0;
  std::uint32_t part = 0;  // connected component (LightSites::part)
  Eigen::VectorXd column;  // irradiance / π by each lobe of radiance 1; last: by occluders of radiance 1
};

// Non-negative least squares: minimises |A x − b|² over x ≥ 0, given AᵀA and Aᵀb, by coordinate descent (Franc, Hlaváč
// and Navara 2005).
Eigen::VectorXd non_negative(const Eigen::MatrixXd& squares, const Eigen::VectorXd& right, Eigen::VectorXd x) {
  Eigen::VectorXd slope = squares * x - right;
  for (int sweep = 0; sweep < 400; ++sweep) {
    double most = 0;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      if (!(squares(k, k) > 0)) continue;
      const double next = std::max(0.0, x[k] - slope[k] / squares(k, k)), step = next - x[k];
      if (step == 0) continue;
      slope += step * squares.col(k);
      x[k] = next;
      most = std::max(most, std::abs(step));
    }
    if (most < 1e-7 * std::max(1e-12, x.maxCoeff())) break;
  }
  return x;
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Weight of the smoothness between neighbouring lobes, relative to the mean weight of a lobe.
constexpr double smooth = 3;

// Alternating fit of the light (lobes, occluders, suns) and of one albedo per chromaticity cluster.
class Fit {
 public:
  Fit(const std::vector<Sample>& samples, const std::vector<Radiance>& colors, const Lobes& lobes)
      : samples_(samples), colors_(colors) {
    // Smoothness: difference of each lobe from the mean of its six nearest.
    const auto n = static_cast<Eigen::Index>(lobes.size());
    Eigen::MatrixXd differences = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
      std::vector<std::pair<double, Eigen::Index>> near;
      for (Eigen::Index j = 0; j < n; ++j)
        if (j != k)
          near.emplace_back(-lobes.center(static_cast<std::size_t>(k)).dot(lobes.center(static_cast<std::size_t>(j))),
                            j);
      constexpr std::ptrdiff_t neighbours = 6;
      std::partial_sort(near.begin(), near.begin() + std::min<std::ptrdiff_t>(neighbours, n - 1), near.end());
      for (std::size_t j = 0; j < std::min<std::size_t>(neighbours, near.size()); ++j)
        differences(k, near[j].second) -= 1.0 / neighbours;
    }
    smoothness_ = differences.transpose() * differences;
    std::uint32_t clusters = 0;
    std::uint32_t parts = 0;
    for (const Sample& sample : samples) {
      clusters = std::max(clusters, sample.cluster + 1);
      parts = std::max(parts, sample.part + 1);
    }
    albedo_.assign(clusters, Radiance::Constant(0.5));
    tone_.assign(parts, 1);
    weight_.assign(samples.size(), 1);
  }

  // Alternates between light and albedos for `rounds` rounds. `suns`: one sun_column() per sun.
  void run(const std::vector<Eigen::VectorXd>& suns, int rounds) {
    suns_ = suns;
    const Eigen::Index n = samples_.front().column.size() + static_cast<Eigen::Index>(suns.size());
    for (auto& x : x_) x.conservativeResizeLike(Eigen::VectorXd::Zero(n));
    for (int round = 0; round < rounds; ++round) {
      for (int c = 0; c < 3; ++c) solve(c);
      reweigh();
      if (toned_) tones();
      albedos();
    }
  }
  Radiance light(Eigen::Index k) const { return {x_[0][k], x_[1][k], x_[2][k]}; }

  // Enables a brightness factor, the tone, per connected component.
  void enable_tones() { toned_ = true; }

  // Weighted sum of the squared errors of all samples.
  double error() const {
    double sum = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) sum += weight_[i] * residual(i).squaredNorm();
    return sum;
  }
  // error() with one more sun, after refitting the light with fixed albedos. freeze_equations() must be called first:
  // it computes the terms that all candidate suns share.
  double error_with(const Eigen::VectorXd& sun) const {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const Equations& held = held_[c];
      const Eigen::Index n = held.rows.cols();
      const Eigen::VectorXd column = held.scale.cwiseProduct(sun);
      Eigen::MatrixXd squares(n + 1, n + 1);
      squares.topLeftCorner(n, n) = held.squares;
      squares.col(n).head(n) = held.rows.transpose() * column;
      squares.row(n).head(n) = squares.col(n).head(n).transpose();
      squares(n, n) = column.squaredNorm() + held.damping;
      Eigen::VectorXd right(n + 1), x = Eigen::VectorXd::Zero(n + 1);
      right << held.right, column.dot(held.wanted);
      x.head(n) = x_[c];
      x = non_negative(squares, right, x);
      sum += (held.rows * x.head(n) + column * x[n] - held.wanted).squaredNorm();
    }
    return sum;
  }
  void freeze_equations() {
    for (std::size_t c = 0; c < 3; ++c) held_[c] = equations(static_cast<int>(c));
  }
  double explained() const {
    // Baseline: one constant colour per cluster, scaled by the tones of its parts.
    std::vector<Radiance> mean(albedo_.size(), Radiance::Zero());
    std::vector<double> count(albedo_.size(), 0);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double tone = tone_[samples_[i].part];
      mean[samples_[i].cluster] += weight_[i] * tone * colors_[samples_[i].site];
      count[samples_[i].cluster] += weight_[i] * tone * tone;
    }
    double all = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::uint32_t k = samples_[i].cluster;
      all += weight_[i] * (colors_[samples_[i].site] - tone_[samples_[i].part] * mean[k] / count[k]).squaredNorm();
    }
    return all > 0 ? std::clamp(1 - error() / all, 0.0, 1.0) : 0;
  }

 private:
  Eigen::VectorXd row(std::size_t i) const {
    const Eigen::VectorXd& own = samples_[i].column;
    Eigen::VectorXd r(own.size() + static_cast<Eigen::Index>(suns_.size()));
    r.head(own.size()) = own;
    for (std::size_t s = 0; s < suns_.size(); ++s)
      r[own.size() + static_cast<Eigen::Index>(s)] = suns_[s][static_cast<Eigen::Index>(i)];
    return r;
  }
  // Least-squares system of one channel, for the current weights and albedos.
  struct Equations {
    Eigen::MatrixXd rows, squares;         // squares: rowsᵀ · rows, with smoothness and damping
    Eigen::VectorXd scale, wanted, right;  // scale: per row, √weight · albedo; wanted: √weight · colour
    double damping = 0;
  };
  Equations equations(int c) const {
    const Eigen::Index n = x_[0].size();
    const auto count = static_cast<Eigen::Index>(samples_.size());
    Equations made{Eigen::MatrixXd(count, n), {}, Eigen::VectorXd(count), Eigen::VectorXd(count), {}};
    for (Eigen::Index i = 0; i < count; ++i) {
      const Sample& sample = samples_[static_cast<std::size_t>(i)];
      const double root = std::sqrt(weight_[static_cast<std::size_t>(i)]);
      made.scale[i] = root * albedo_of(sample)[c];
      made.rows.row(i) = made.scale[i] * row(static_cast<std::size_t>(i)).transpose();
      made.wanted[i] = root * colors_[sample.site][c];
    }
    made.squares = made.rows.transpose() * made.rows;
    made.right = made.rows.transpose() * made.wanted;
    const double usual = made.squares.diagonal().head(smoothness_.rows()).mean();
    made.damping = 1e-3 * usual;
    made.squares.topLeftCorner(smoothness_.rows(), smoothness_.rows()) += smooth * usual * smoothness_;
    made.squares.diagonal().array() += made.damping;
    return made;
  }
  void solve(int c) {
    const Equations made = equations(c);
    x_[c] = non_negative(made.squares, made.right, x_[c]);
  }
  Radiance predicted(std::size_t i) const {
    const Eigen::VectorXd r = row(i);
    return Radiance(r.dot(x_[0]), r.dot(x_[1]), r.dot(x_[2])).cwiseProduct(albedo_of(samples_[i]));
  }
  Radiance residual(std::size_t i) const { return colors_[samples_[i].site] - predicted(i); }
  // Weights errors relative to the predicted colour, because albedos vary by factors. Outliers (highlights, other
  // albedos) get Huber weights.
  void reweigh() {
    std::vector<double> expected, sizes;
    double mean = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      expected.push_back(predicted(i).norm());
      mean += expected.back() / static_cast<double>(samples_.size());
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      expected[i] += 0.2 * mean;
      sizes.push_back(residual(i).norm() / expected[i]);
    }
    const double usual = std::max(1e-12, 1.5 * median(sizes));
    for (std::size_t i = 0; i < samples_.size(); ++i)
      weight_[i] = std::min(1.0, usual / std::max(usual, sizes[i])) * mean * mean / (expected[i] * expected[i]);
  }
  Radiance albedo_of(const Sample& sample) const { return albedo_[sample.cluster] * tone_[sample.part]; }
  // Tone of each part: its brightness relative to its cluster, shrunk towards 1 by the ratio of the variance within
  // parts to that between parts (after DerSimonian and Laird 1986, with 1 as mean).
  void tones() {
    std::vector<double> top(tone_.size(), 0), bottom(tone_.size(), 0);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::uint32_t k = samples_[i].part;
      const Radiance usual = predicted(i) / tone_[k];
      top[k] += weight_[i] * usual.dot(colors_[samples_[i].site]);
      bottom[k] += weight_[i] * usual.squaredNorm();
    }
    double sum = 0, squares = 0, spread = 0, parts = 0;
    for (std::size_t k = 0; k < tone_.size(); ++k) {
      if (!(bottom[k] > 0)) continue;
      sum += bottom[k];
      squares += bottom[k] * bottom[k];
      spread += bottom[k] * (top[k] / bottom[k] - 1) * (top[k] / bottom[k] - 1);
      parts += 1;
    }
    if (parts < 2) return;
    const double within = error() / static_cast<double>(samples_.size()),
                 between = (spread - within * parts) / (sum - squares / sum);
    for (std::size_t k = 0; k < tone_.size(); ++k) {
      const double held = between > 0 ? within / between : std::numeric_limits<double>::infinity();
      tone_[k] = std::isfinite(held) && bottom[k] + held > 0 ? (top[k] + held) / (bottom[k] + held) : 1;
    }
  }
  void albedos() {
    std::vector<Radiance> top(albedo_.size(), Radiance::Zero()), bottom = top;
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const std::uint32_t k = samples_[i].cluster;
      const Radiance light = predicted(i).cwiseQuotient(albedo_[k]);
      top[k] += weight_[i] * light.cwiseProduct(colors_[samples_[i].site]);
      bottom[k] += weight_[i] * light.cwiseProduct(light);
    }
    Radiance sum = Radiance::Zero();
    double count = 0;
    for (std::size_t k = 0; k < albedo_.size(); ++k)
      for (int c = 0; c < 3; ++c)
        if (bottom[k][c] > 0) albedo_[k][c] = std::max(1e-4, top[k][c] / bottom[k][c]);
    for (const Sample& sample : samples_) {
      sum += albedo_[sample.cluster];
      count += 1;
    }
    // The scale is undetermined: the mean albedo is set to ½.
    const Radiance scale = (sum / count * 2).cwiseInverse();
    for (Radiance& a : albedo_) a = a.cwiseProduct(scale);
    for (int c = 0; c < 3; ++c) x_[c] /= scale[c];
  }

  const std::vector<Sample>& samples_;
  const std::vector<Radiance>& colors_;
  std::vector<Eigen::VectorXd> suns_;
  std::array<Eigen::VectorXd, 3> x_{Eigen::VectorXd::Zero(0), Eigen::VectorXd::Zero(0), Eigen::VectorXd::Zero(0)};
  std::vector<Radiance> albedo_;  // per cluster
  std::vector<double> tone_;      // per part: brightness relative to its cluster
  bool toned_ = false;
  std::vector<double> weight_;
  Eigen::MatrixXd smoothness_;
  std::array<Equations, 3> held_;
};

// Per sample: its shadowed irradiance, in units of Sun::irradiance.
Eigen::VectorXd sun_column(const std::vector<Sample>& samples, const LightSites& sites, const SceneRays& body,
                           const Vec3& direction, double radius, int rays, const Progress& progress) {
  Eigen::VectorXd column = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples.size()));
  const std::vector<DiskPoint> disk = disk_points(rays);
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  const double r = std::tan(radius);
  for_each_site(samples.size(), progress, "estimating light", 0.8, 0.8, [&](std::size_t i) {
    for (int side = 0; side < 2; ++side) {
      const double share = side == 0 ? samples[i].facing : 1 - samples[i].facing;
      const SiteFrame frame(sites.baked[samples[i].site], samples[i].site, side == 1);
      if (share == 0 || frame.normal().dot(direction) <= -r) continue;
      for (const DiskPoint& point : disk) {
        const DiskPoint p = frame.turned(point);
        const Vec3 d = (direction + r * (p.x * u + p.y * v)).normalized();
        const double above = frame.normal().dot(d);
        if (above > 0 && !body.shaded(frame.from(), d))
          column[static_cast<Eigen::Index>(i)] += share * above / static_cast<double>(disk.size());
      }
    }
  });
  return column;
}

struct FoundSun {
  Vec3 direction;
  double radius = 0.09;
  Eigen::VectorXd column;
  double error = std::numeric_limits<double>::infinity();
};

// At most `most` samples, spread evenly over the usable sites; empty if there are fewer than 8.
std::vector<Sample> spread_samples(const LightSites& sites, const std::vector<Radiance>& colors, std::size_t most) {
  std::vector<Sample> samples;
  std::vector<std::uint32_t> usable;
  for (std::uint32_t i = 0; i < sites.size(); ++i)
    if (sites.baked[i].normal.squaredNorm() > 0.5 && colors[i].sum() > 0) usable.push_back(i);
  const std::size_t count = std::min(most, usable.size());
  if (count < 8) return samples;
  for (std::size_t k = 0; k < count; ++k)
    samples.push_back(
        {usable[(k * usable.size() + mixed(k, 1, 2) % usable.size()) / count % usable.size()], 0.5, 0, 0, {}});
  for (Sample& sample : samples) sample.part = sites.part[sample.site];
  std::vector<Radiance> own;
  for (const Sample& sample : samples) own.push_back(colors[sample.site]);
  const std::vector<std::uint32_t> clusters = chromaticity_clusters(own);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].cluster = clusters[i];
  return samples;
}

// Sets each sample's visible side, and its irradiance by each lobe; the last entry is the occluded share.
void trace_lobes(std::vector<Sample>& samples, const LightSites& sites, const SceneRays& body, const Lobes& lobes,
                 int rays, const Progress& progress) {
  const auto lobe_count = static_cast<Eigen::Index>(lobes.size());
  std::vector<std::array<Eigen::VectorXd, 2>> sides(samples.size());
  const std::vector<DiskPoint> disk = disk_points(rays);
  for_each_site(samples.size(), progress, "estimating light", 0, 0.6, [&](std::size_t i) {
    std::vector<double> weights;
    for (std::size_t side = 0; side < 2; ++side) {
      const SiteFrame frame(sites.baked[samples[i].site], samples[i].site, side == 1);
      Eigen::VectorXd& column = sides[i][side];
      column = Eigen::VectorXd::Zero(lobe_count + 1);
      for (const DiskPoint& point : disk) {
        const Vec3 d = frame.direction(point);
        if (body.shaded(frame.from(), d)) {
          column[lobe_count] += 1.0 / rays;
          continue;
        }
        lobes.weights(d, weights);
        for (Eigen::Index j = 0; j < lobe_count; ++j) column[j] += weights[static_cast<std::size_t>(j)] / rays;
      }
    }
  });
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].facing = facing_by_visibility(1 - sides[i][0][lobe_count], 1 - sides[i][1][lobe_count]);
    samples[i].column = samples[i].facing * sides[i][0] + (1 - samples[i].facing) * sides[i][1];
  }
}

// Searches around the brightest lobe for a sun that explains the colours better than lobes alone.
std::optional<FoundSun> find_sun(const std::vector<Sample>& samples, const LightSites& sites, const SceneRays& body,
                                 const Lobes& lobes, Fit& fit, const Progress& progress) {
  const auto lobe_count = static_cast<Eigen::Index>(lobes.size());
  Eigen::Index brightest = 0;
  for (Eigen::Index k = 1; k < lobe_count; ++k)
    if (fit.light(k).sum() > fit.light(brightest).sum()) brightest = k;
  constexpr int rough_rays = 6;
  FoundSun best;
  best.direction = lobes.center(static_cast<std::size_t>(brightest));
  const double without = fit.error();
  fit.freeze_equations();
  const auto consider = [&](FoundSun other) {
    other.column = sun_column(samples, sites, body, other.direction, other.radius, rough_rays, progress);
    other.error = fit.error_with(other.column);
    if (other.error < best.error) best = std::move(other);
  };
  constexpr double first_step = 0.16;  // radians
  for (const double step : {first_step, 0.06, 0.025}) {
    const Vec3 center = best.direction, u = center.unitOrthogonal(), v = center.cross(u);
    const int reach = step == first_step ? 3 : 2;
    for (int a = -reach; a <= reach; ++a)
      for (int b = -reach; b <= reach; ++b) {
        if (step != first_step && a == 0 && b == 0) continue;
        FoundSun other;
        other.direction = (center + step * (a * u + b * v)).normalized();
        consider(std::move(other));
      }
  }
  for (const double radius : {0.02, 0.2}) {
    FoundSun other = best;
    other.radius = radius;
    consider(std::move(other));
  }
  // A sun must reduce the error by 3 %, because lobes alone explain soft light.
  if (!(best.error < 0.97 * without)) return std::nullopt;
  return best;
}

}  // namespace

LightEstimate estimated_light(const LightSites& sites, const std::vector<Radiance>& colors, const SceneRays& body,
                              const EstimateOptions& options, const Progress& progress) {
  LightEstimate result;
  std::vector<Sample> samples = spread_samples(sites, colors, options.sites);
  if (samples.empty()) return result;
  const Lobes lobes(options.lobes);
  const auto lobe_count = static_cast<Eigen::Index>(lobes.size());
  trace_lobes(samples, sites, body, lobes, options.rays, progress);
  Fit fit(samples, colors, lobes);
  fit.run({}, 12);
  // Tones are fitted before the search for a sun: otherwise bright leaves count as sunlit, and the sun is off by
  // degrees.
  fit.enable_tones();
  fit.run({}, 12);
  progress.at("estimating light", 0.7);

  std::optional<FoundSun> sun;
  if (options.sun) sun = find_sun(samples, sites, body, lobes, fit, progress);
  if (sun) fit.run({sun_column(samples, sites, body, sun->direction, sun->radius, 48, progress)}, 12);
  result.confidence = fit.explained();
  result.light.sky = SkyMap(32, [&](const Vec3& d) -> Radiance {
    std::vector<double> weights;
    lobes.weights(d, weights);
    Radiance sum = Radiance::Zero();
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * fit.light(static_cast<Eigen::Index>(k));
    return sum;
  });
  result.light.bounce = fit.light(lobe_count);
  if (sun) {
    result.sun = true;
    result.light.suns.push_back({sun->direction, sun->radius, fit.light(lobe_count + 1)});
  }
  progress.at("estimating light", 1);
  return result;
}

}  // namespace rebake
