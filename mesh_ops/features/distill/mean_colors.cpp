#include "mesh_ops/features/distill/mean_colors.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// Sums of colours over the triangles that use a texel.
struct Sum {
  std::array<float, 3> color{};
  float weight = 0;
};

// A direction to an eye, with the share of the triangle's area that is seen from there.
struct Eye {
  Vec3 direction;
  double weight;
};

// The eyes at `distance` that see a point of a surface; two-sided. `normal` of any length.
std::vector<Eye> seeing(const SceneRays& rays, const Vec3& point, const Vec3& normal, double distance,
                        const std::vector<Vec3>& all) {
  std::vector<Eye> found;
  const double length = normal.norm();
  for (const Vec3& direction : all) {
    const double weight = length > 0 ? std::abs(normal.dot(direction)) / length : 1;
    if (weight > 0 && !rays.blocked(point + distance * direction, point)) found.push_back({direction, weight});
  }
  return found;
}

// Texels that no triangle's centre rule covers take a neighbour's colour, twice.
void dilate(std::vector<Sum>& sums, int width, int height) {
  for (int round = 0; round < 2; ++round) {
    const std::vector<Sum> before = sums;
    tbb::parallel_for(0, height, [&](int y) {
      for (int x = 0; x < width; ++x) {
        Sum& sum = sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        if (sum.weight > 0) continue;
        for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
          const int nx = x + dx, ny = y + dy;
          if (nx < 0 || ny < 0 || nx >= width || ny >= height) continue;
          const Sum& other =
              before[static_cast<std::size_t>(ny) * static_cast<std::size_t>(width) + static_cast<std::size_t>(nx)];
          if (other.weight > 0) sum = other;
        }
      }
    });
  }
}

// One set while its colours are summed.
class Averager {
 public:
  Averager(const TextureSet& set, const PlacedNode& placed, const SceneRays& rays, double scene_size,
           std::size_t directions, const std::optional<Vec3>& eye)
      : eye_(eye),
        set_(set),
        placed_(placed),
        rays_(rays),
        texels_(*set.texels),
        all_(even_directions(directions)),
        colors_(*placed.node->object->decoder, {}),
        turn_(orthogonal_factor(placed.to_world.linear())),
        axes_(axes_matrix(placed.node->object->axes)),
        distance_(2 * scene_size),
        sums_(static_cast<std::size_t>(set.texels->width()) * static_cast<std::size_t>(set.texels->height())) {}

  MeanColors run(MeanColorLoss& loss) {
    std::mutex mutex;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, set_.soup.triangle_count(), 64),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        MeanColorLoss part;
                        for (std::size_t f = range.begin(); f != range.end(); ++f) add_triangle(f, part, mutex);
                        const std::scoped_lock lock(mutex);
                        loss.squares += part.squares;
                        loss.weight += part.weight;
                        loss.hidden += part.hidden;
                      });
    const int width = set_.texels->width(), height = set_.texels->height();
    dilate(sums_, width, height);
    MeanColors made{width, height, std::vector<std::uint8_t>(4 * sums_.size(), 0)};
    for (std::size_t k = 0; k < sums_.size(); ++k) {
      const auto texel = static_cast<int>(k);
      if (sums_[k].weight == 0 || !set_.texels->opaque(texel % width, texel / width)) continue;
      for (std::size_t c = 0; c < 3; ++c)
        made.rgba[4 * k + c] =
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(sums_[k].color[c] / sums_[k].weight, 0.0F, 1.0F)));
      made.rgba[4 * k + 3] = 255;
    }
    return made;
  }

 private:
  void add_triangle(std::size_t f, MeanColorLoss& loss, std::mutex& mutex) {
    const Face& face = set_.soup.faces()[f];
    std::vector<std::array<int, 2>> places;
    std::vector<TexelColors::Features> features;
    const std::array<Vec2, 3> corners = texel_corners(set_, f);
    if (!corners[0].allFinite() || !corners[1].allFinite() || !corners[2].allFinite()) return;
    const auto add = [&](int x, int y) {
      const Texel& texel = texels_.at(x, y);
      if (!texel.opaque()) return;
      places.push_back({x, y});
      features.push_back(decode_features(texel, set_.texels->alpha_code()));
    };
    for_each_texel_inside(corners, set_.texels->width(), set_.texels->height(), add);
    // Triangles smaller than a texel.
    if (places.empty()) {
      const Vec2 middle = (corners[0] + corners[1] + corners[2]) / 3;
      add(texel_within(middle.x(), set_.texels->width()), texel_within(middle.y(), set_.texels->height()));
    }
    if (places.empty()) return;
    const auto& positions = set_.soup.positions();
    const std::array<Vec3, 3> p{placed_.to_world * positions[face[0]], placed_.to_world * positions[face[1]],
                                placed_.to_world * positions[face[2]]};
    const Vec3 normal = (p[1] - p[0]).cross(p[2] - p[0]);
    std::vector<Eye> eyes = seeing(rays_, (p[0] + p[1] + p[2]) / 3, normal, distance_, all_);
    if (eyes.empty()) {
      ++loss.hidden;
      for (const Vec3& direction : all_) eyes.push_back({direction, 1});
    }
    Mat3 to_fed = axes_;
    if (set_.soup.rotations() != nullptr) to_fed = axes_ * (*set_.soup.rotations())[face[0]].matrix().transpose();
    std::vector<Color> means(places.size(), Color(0, 0, 0)), shown(places.size());
    std::vector<std::vector<Color>> each;
    double total = 0;
    for (const Eye& eye : eyes) {
      const std::vector<Vec3> fed(places.size(), to_fed * (turn_.transpose() * -eye.direction));
      colors_.decode_each(features, fed, shown);
      for (std::size_t k = 0; k < places.size(); ++k) means[k] += eye.weight * shown[k];
      each.push_back(shown);
      total += eye.weight;
    }
    for (Color& mean : means) mean /= total;
    if (eye_) {
      const Vec3 direction = (*eye_ - (p[0] + p[1] + p[2]) / 3).stableNormalized();
      const std::vector<Vec3> fed(places.size(), to_fed * (turn_.transpose() * -direction));
      colors_.decode_each(features, fed, means);
    }
    for (std::size_t e = 0; e < eyes.size(); ++e)
      for (std::size_t k = 0; k < places.size(); ++k)
        loss.squares += eyes[e].weight * (each[e][k] - means[k]).squaredNorm() / 3;
    loss.weight += total * static_cast<double>(places.size());
    const std::scoped_lock lock(mutex);
    for (std::size_t k = 0; k < places.size(); ++k) {
      Sum& sum = sums_[static_cast<std::size_t>(places[k][1]) * static_cast<std::size_t>(set_.texels->width()) +
                       static_cast<std::size_t>(places[k][0])];
      for (std::size_t c = 0; c < 3; ++c) sum.color[c] += static_cast<float>(means[k][static_cast<Eigen::Index>(c)]);
      sum.weight += 1;
    }
  }

  const std::optional<Vec3>& eye_;
  const TextureSet& set_;
  const PlacedNode& placed_;
  const SceneRays& rays_;
  TexelReader texels_;
  std::vector<Vec3> all_;
  TexelColors colors_;
  Mat3 turn_, axes_;
  double distance_;
  std::vector<Sum> sums_;
};

}  // namespace

double MeanColorLoss::psnr_db() const {
  return weight == 0 || squares == 0 ? 100 : std::min(100.0, -10 * std::log10(squares / weight));
}

MeanColors mean_colors(const TextureSet& set, const PlacedNode& placed, const SceneRays& rays, double scene_size,
                       std::size_t directions, MeanColorLoss& loss, const std::optional<Vec3>& eye) {
  return Averager(set, placed, rays, scene_size, directions, eye).run(loss);
}

}  // namespace rebake
