#include "editor/studies/representations/plenoctree_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "editor/studies/representations/cell_adam.h"
#include "editor/studies/representations/voxel_cells.h"

namespace rebake {

namespace {

constexpr std::size_t basis = 9, channels = 3 * basis + 1, density = 3 * basis;
constexpr float darkest = 0.01F;  // light at which a ray ends
constexpr int margin = 1;

// A cell that a ray crosses. Densities are per cell side, lengths in cell sides.
struct Crossing {
  std::size_t cell;
  float length, through, light;  // share of light that passes; light that reaches it
  std::array<float, 3> color;
};

class Fit {
 public:
  Fit(const TruthRays& rays, int resolution)
      : rays_(rays),
        resolution_(resolution),
        cells_(cells_around(rays.hits, resolution, margin, true)),
        adam_(cells_.count(), rates()),
        most_seen_(cells_.count(), 0) {
    const std::vector<std::array<float, 3>> colors = mean_colors(cells_, rays.hits, rays.hit_colors);
    const auto constant = static_cast<float>(tree_harmonics(Vec3::UnitX())[0]);
    for (std::size_t cell = 0; cell < cells_.count(); ++cell) {
      float* value = adam_.values(cell);
      value[density] = cells_.surface[cell] != 0 ? 1.5F : 0.05F;
      for (std::size_t c = 0; c < 3; ++c) {
        const float color = std::clamp(colors[cell][c], 0.02F, 0.98F);
        value[c * basis] = std::log(color / (1 - color)) / constant;
      }
    }
  }

  void pass(int number, const Progress& progress) {
    const std::size_t batch = batch_size(rays_.rays.size());
    for (std::size_t begin = 0; begin < rays_.rays.size(); begin += batch) {
      progress.at("fitting a PlenOctree", static_cast<double>(begin) / static_cast<double>(rays_.rays.size()));
      const std::size_t end = std::min(begin + batch, rays_.rays.size());
      const std::size_t per_lane = (end - begin + CellAdam::lanes - 1) / CellAdam::lanes;
      tbb::parallel_for(std::size_t{0}, CellAdam::lanes, [&](std::size_t lane) {
        std::vector<Crossing> crossings;
        for (std::size_t k = begin + lane * per_lane; k < std::min(end, begin + (lane + 1) * per_lane); ++k)
          learn(rays_.rays[k], lane, crossings);
      });
      adam_.step(end - begin, fit_rate(number + static_cast<double>(begin) / static_cast<double>(rays_.rays.size())),
                 [](float* values) { values[density] = std::max(values[density], 0.0F); });
    }
  }

  PlenOctree packed(int /*passes*/, const Progress& /*progress*/) {
    mark_seen();
    PlenOctree tree;
    tree.basis = static_cast<int>(basis);
    tree.scale = Vec3::Constant(1 / (cells_.voxel * resolution_));
    tree.offset = -cells_.min.cwiseProduct(tree.scale);
    add_node(tree, {0, 0, 0}, resolution_);
    return tree;
  }

  // The state between two passes.
  std::string save() const {
    std::string bytes;
    adam_.save(bytes);
    return bytes;
  }
  void load(std::string_view bytes) { adam_.load(bytes); }

 private:
  static constexpr float least_seen = 0.005F;

  static std::vector<float> rates() {
    std::vector<float> result(channels, 0.05F);
    result[density] = 0.1F;
    return result;
  }

  // Cells along a ray until it leaves the grid or its light ends. Returns the light that is left.
  float march(const TruthRay& ray, const std::array<float, basis>& harmonics, std::vector<Crossing>& crossings) const {
    crossings.clear();
    const Eigen::Vector3f origin = ((ray.origin.cast<double>() - cells_.min) / cells_.voxel).cast<float>();
    const Eigen::Vector3f inverse = ray.direction.cwiseInverse();
    const auto range = [&](const Eigen::Vector3f& low, float size) {
      const Eigen::Vector3f a = (low - origin).cwiseProduct(inverse),
                            b = (low - origin + Eigen::Vector3f::Constant(size)).cwiseProduct(inverse);
      return std::pair{a.cwiseMin(b).maxCoeff(), a.cwiseMax(b).minCoeff()};
    };
    const auto [enter, leave] = range(Eigen::Vector3f::Zero(), static_cast<float>(resolution_));
    constexpr float nudge = 1e-3F;
    float light = 1;
    const auto blocks = cells_.blocks();
    for (float t = std::max(0.0F, enter); t < leave && light > darkest;) {
      const Eigen::Vector3f at = origin + t * ray.direction;
      std::array<int, 3> cell{};
      for (std::size_t a = 0; a < 3; ++a)
        cell[a] = std::clamp(static_cast<int>(at[static_cast<Eigen::Index>(a)]), 0, resolution_ - 1);
      constexpr int block = VoxelCells::block;
      const bool used = cells_.block_used[static_cast<std::size_t>(
                            ((cell[2] / block) * blocks[1] + cell[1] / block) * blocks[0] + cell[0] / block)] != 0;
      const int side = used ? 1 : block;
      const Eigen::Vector3f low =
          Eigen::Vector3i(cell[0] / side * side, cell[1] / side * side, cell[2] / side * side).cast<float>();
      const float end = std::max(t, range(low, static_cast<float>(side)).second) + nudge;
      if (const std::int32_t number = used ? cells_.number_at(cell[0], cell[1], cell[2]) : -1; number >= 0) {
        const auto occupied = static_cast<std::size_t>(number);
        const float* value = adam_.values(occupied);
        Crossing crossing{occupied, end - t, std::exp(-(end - t) * value[density]), light, {}};
        for (std::size_t c = 0; c < 3; ++c) {
          float sum = 0;
          for (std::size_t b = 0; b < basis; ++b) sum += harmonics[b] * value[c * basis + b];
          crossing.color[c] = 1 / (1 + std::exp(-sum));
        }
        light *= crossing.through;
        crossings.push_back(crossing);
      }
      t = end;
    }
    return light;
  }

  static std::array<float, basis> harmonics_of(const TruthRay& ray) {
    const auto all = tree_harmonics(ray.direction.cast<double>());
    std::array<float, basis> result{};
    for (std::size_t b = 0; b < basis; ++b) result[b] = static_cast<float>(all[b]);
    return result;
  }

  // Adds the gradient of a ray's squared error.
  void learn(const TruthRay& ray, std::size_t lane, std::vector<Crossing>& crossings) {
    const auto harmonics = harmonics_of(ray);
    const float rest = march(ray, harmonics, crossings);
    if (crossings.empty()) return;
    std::array<float, 3> slope{rest - ray.color[0], rest - ray.color[1], rest - ray.color[2]};
    for (const Crossing& crossing : crossings)
      for (std::size_t c = 0; c < 3; ++c) slope[c] += crossing.light * (1 - crossing.through) * crossing.color[c];
    for (float& value : slope) value *= 2;
    // What the light that passes a cell adds to the loss, from the last cell on.
    float behind = rest * (slope[0] + slope[1] + slope[2]);
    for (auto crossing = crossings.rbegin(); crossing != crossings.rend(); ++crossing) {
      const float share = crossing->light * (1 - crossing->through), passed = crossing->light * crossing->through;
      float* gradient = adam_.gradient(lane, crossing->cell);
      float own = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        own += slope[c] * crossing->color[c];
        const float inner = share * slope[c] * crossing->color[c] * (1 - crossing->color[c]);
        for (std::size_t b = 0; b < basis; ++b) gradient[c * basis + b] += inner * harmonics[b];
      }
      gradient[density] += crossing->length * (passed * own - behind);
      behind += share * own;
    }
  }

  // The largest share of a ray's light that each cell contributes.
  void mark_seen() {
    std::array<std::vector<float>, CellAdam::lanes> seen;
    const std::size_t per_lane = (rays_.rays.size() + CellAdam::lanes - 1) / CellAdam::lanes;
    tbb::parallel_for(std::size_t{0}, CellAdam::lanes, [&](std::size_t lane) {
      seen[lane].assign(cells_.count(), 0);
      std::vector<Crossing> crossings;
      for (std::size_t k = lane * per_lane; k < std::min(rays_.rays.size(), (lane + 1) * per_lane); ++k) {
        march(rays_.rays[k], harmonics_of(rays_.rays[k]), crossings);
        for (const Crossing& crossing : crossings)
          seen[lane][crossing.cell] = std::max(seen[lane][crossing.cell], crossing.light * (1 - crossing.through));
      }
    });
    most_seen_.assign(cells_.count(), 0);
    for (const auto& lane : seen)
      for (std::size_t cell = 0; cell < lane.size(); ++cell) most_seen_[cell] = std::max(most_seen_[cell], lane[cell]);
  }

  // Whether a cube of the grid has a cell that is seen.
  bool holds_any(const std::array<int, 3>& low, int side) const {
    for (int z = low[2]; z < low[2] + side; ++z)
      for (int y = low[1]; y < low[1] + side; ++y)
        for (int x = low[0]; x < low[0] + side; ++x)
          if (const std::int32_t number = cells_.number_at(x, y, z);
              number >= 0 && most_seen_[static_cast<std::size_t>(number)] >= least_seen)
            return true;
    return false;
  }

  void add_node(PlenOctree& tree, const std::array<int, 3>& low, int side) const {
    const std::size_t node = tree.children.size();
    tree.children.push_back({});
    tree.data.resize(tree.children.size() * 8 * channels, Eigen::half(0));
    const int half = side / 2;
    for (std::size_t k = 0; k < 8; ++k) {
      const std::array<int, 3> corner{low[0] + half * static_cast<int>(k >> 2 & 1),
                                      low[1] + half * static_cast<int>(k >> 1 & 1),
                                      low[2] + half * static_cast<int>(k & 1)};
      if (!holds_any(corner, half)) continue;
      if (half > 1) {
        tree.children[node][k] = static_cast<std::int32_t>(tree.children.size() - node);
        add_node(tree, corner, half);
        continue;
      }
      const float* value = adam_.values(static_cast<std::size_t>(cells_.number_at(corner[0], corner[1], corner[2])));
      Eigen::half* leaf = tree.leaf(node, k);
      for (std::size_t c = 0; c < density; ++c) leaf[c] = Eigen::half(value[c]);
      leaf[density] = Eigen::half(std::min(value[density] / static_cast<float>(cells_.voxel), 60000.0F));
    }
  }

  const TruthRays& rays_;
  int resolution_;
  VoxelCells cells_;
  CellAdam adam_;
  std::vector<float> most_seen_;
};

}  // namespace

PlenOctree fit_plenoctree(const TruthRays& rays, int resolution,
                          const std::function<bool(int, const PlenOctree&)>& goes_on, const Progress& progress,
                          const FitCheckpoints& checkpoints) {
  Fit fit(rays, resolution);
  return run_fit(fit, goes_on, progress, checkpoints);
}

}  // namespace rebake
