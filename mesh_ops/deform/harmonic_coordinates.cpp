#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/coordinates.h"

namespace rebake {

namespace {

constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// Distance from a triangle (Ericson 2005, 5.1.5: by the region that the projection falls into).
double distance_to(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto to_segment = [&](const Vec3& s, const Vec3& e) {
    const Vec3 along = e - s;
    const double square = along.squaredNorm();
    const double t = square > 0 ? std::clamp((p - s).dot(along) / square, 0.0, 1.0) : 0.0;
    return (p - s - t * along).norm();
  };
  const Vec3 n = (b - a).cross(c - a);
  const bool inside = n.squaredNorm() > 0 && n.cross(b - a).dot(p - a) >= 0 && n.cross(c - b).dot(p - b) >= 0 &&
                      n.cross(a - c).dot(p - c) >= 0;
  if (inside) return std::abs(n.dot(p - a)) / n.norm();
  return std::min({to_segment(a, b), to_segment(b, c), to_segment(c, a)});
}

// Nodes at the surface, and those outside that cells of inside points use, get mean value weights: exact on the
// surface, and exact for linear functions everywhere. Nodes inside solve Laplace's equation from there on; linear
// functions solve it on a grid, so they stay exact.
class Harmonic final : public Coordinates {
 public:
  Harmonic(const Cage& cage, int resolution, const Progress& progress)
      : Coordinates(cage.vertices.size()), frame_(frame_of(cage)) {
    if (resolution < 8 || resolution > 256) throw FieldError("resolution", "must lie between 8 and 256");
    Box box;
    for (const Vec3& v : frame_.vertices) box.extend(v);
    step_ = box.sizes().maxCoeff() / resolution;
    origin_ = box.min() - Vec3::Constant(2.5 * step_);
    for (int axis = 0; axis < 3; ++axis)
      size_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(box.sizes()[axis] / step_)) + 6;
    const std::size_t nodes =
        static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) * static_cast<std::size_t>(size_[2]);
    std::vector<float> distance(nodes, std::numeric_limits<float>::infinity());
    find_distances(cage, distance);
    // From a corner through all that is clear of the surface: the outside.
    std::vector<std::uint8_t> outside(nodes, 0);
    std::vector<std::size_t> open{0};
    outside[0] = 1;
    while (!open.empty()) {
      const std::size_t node = open.back();
      open.pop_back();
      for_neighbours(node, [&](std::size_t next) {
        if (outside[next] != 0 || distance[next] <= surface_band * step_) return;
        outside[next] = 1;
        open.push_back(next);
      });
    }
    row_of_.assign(nodes, none);
    std::vector<std::size_t> given, inside;
    for (std::size_t node = 0; node < nodes; ++node) {
      const bool near = distance[node] <= surface_band * step_;
      if (near || (outside[node] != 0 && distance[node] <= cell_reach * step_)) {
        row_of_[node] = static_cast<std::uint32_t>(given.size());
        given.push_back(node);
      }
    }
    for (std::size_t node = 0; node < nodes; ++node)
      if (row_of_[node] == none && outside[node] == 0) {
        row_of_[node] = static_cast<std::uint32_t>(given.size() + inside.size());
        inside.push_back(node);
      }
    // Every node inside keeps a weight for every cage point.
    constexpr std::size_t most_bytes = std::size_t{2} << 30U;
    if ((given.size() + inside.size()) * rows() > most_bytes / sizeof(double))
      throw FieldError(
          "resolution",
          fmt::format("{} would need {:.1f} GB for this cage, 2 at most; choose a lower one or a coarser cage",
                      resolution, static_cast<double>((given.size() + inside.size()) * rows()) * 8e-9));
    values_.resize((given.size() + inside.size()) * rows());
    tbb::parallel_for(std::size_t{0}, given.size(), [&](std::size_t k) {
      std::vector<double> weights;
      mean_value_weights(frame_, place_of(given[k]), weights);
      std::copy(weights.begin(), weights.end(), values_.begin() + static_cast<std::ptrdiff_t>(k * rows()));
    });
    solve(given.size(), inside, progress);
  }

  void weigh(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
             std::uint8_t* outside) const override {
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3 at = (frame_.to_local(points[lane]) - origin_) / step_;
      std::array<std::uint32_t, 8> corners{};
      std::array<std::array<double, 2>, 3> share{};
      outside[lane] = at.allFinite() && find_cell(at, corners, share) ? 0 : 1;
      for (std::size_t row = 0; row < rows(); ++row) {
        double value = 0;
        std::array<double, 3> slope{};
        if (outside[lane] == 0)
          for (std::size_t k = 0; k < 8; ++k) {
            const double w = values_[corners[k] * rows() + row];
            const std::size_t x = k & 1U, y = (k >> 1U) & 1U, z = k >> 2U;
            value += w * share[0][x] * share[1][y] * share[2][z];
            slope[0] += (x != 0 ? w : -w) * share[1][y] * share[2][z];
            slope[1] += (y != 0 ? w : -w) * share[0][x] * share[2][z];
            slope[2] += (z != 0 ? w : -w) * share[0][x] * share[1][y];
          }
        weights[row * batch_lanes + lane] = value;
        if (gradients != nullptr)
          for (std::size_t axis = 0; axis < 3; ++axis)
            gradients[(row * 3 + axis) * batch_lanes + lane] = slope[axis] / step_ * frame_.scale;
      }
    }
  }

 private:
  // In steps. Every step across the surface has an end within half a step of it.
  static constexpr double surface_band = 0.51;
  // The farthest corner of a cell that the surface cuts.
  static constexpr double cell_reach = 1.75;

  std::size_t number(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[0]) +
           static_cast<std::size_t>(x);
  }
  Vec3 place_of(std::size_t node) const {
    const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]);
    const std::array<std::size_t, 3> at{node % nx, node / nx % ny, node / nx / ny};
    return origin_ + step_ * Vec3(static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]));
  }
  template <class Visit>
  void for_neighbours(std::size_t node, Visit visit) const {
    const auto nx = static_cast<std::size_t>(size_[0]), ny = static_cast<std::size_t>(size_[1]),
               nz = static_cast<std::size_t>(size_[2]);
    const std::size_t x = node % nx, y = node / nx % ny, z = node / nx / ny;
    if (x > 0) visit(node - 1);
    if (x + 1 < nx) visit(node + 1);
    if (y > 0) visit(node - nx);
    if (y + 1 < ny) visit(node + nx);
    if (z > 0) visit(node - nx * ny);
    if (z + 1 < nz) visit(node + nx * ny);
  }

  void find_distances(const Cage& cage, std::vector<float>& distance) const {
    for (const Face& face : cage.faces) {
      const Vec3 &a = frame_.vertices[face[0]], &b = frame_.vertices[face[1]], &c = frame_.vertices[face[2]];
      std::array<int, 3> low, high;
      for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const double least = std::min({a[axis], b[axis], c[axis]}) - origin_[axis],
                     most = std::max({a[axis], b[axis], c[axis]}) - origin_[axis];
        low[k] = std::max(0, static_cast<int>(std::ceil(least / step_ - cell_reach)));
        high[k] = std::min(size_[k] - 1, static_cast<int>(std::floor(most / step_ + cell_reach)));
      }
      for (int z = low[2]; z <= high[2]; ++z)
        for (int y = low[1]; y <= high[1]; ++y)
          for (int x = low[0]; x <= high[0]; ++x) {
            float& nearest = distance[number(x, y, z)];
            nearest = std::min(nearest, static_cast<float>(distance_to(origin_ + step_ * Vec3(x, y, z), a, b, c)));
          }
    }
  }

  void solve(std::size_t given, const std::vector<std::size_t>& inside, const Progress& progress) {
    if (inside.empty()) return;
    using Sparse = Eigen::SparseMatrix<double>;
    const auto unknowns = static_cast<Eigen::Index>(inside.size());
    std::vector<Eigen::Triplet<double>> entries;
    struct Link {
      Eigen::Index unknown;
      std::uint32_t row;
    };
    std::vector<Link> links;  // of unknowns to given neighbours
    for (Eigen::Index k = 0; k < unknowns; ++k) {
      entries.emplace_back(k, k, 6.0);
      for_neighbours(inside[static_cast<std::size_t>(k)], [&](std::size_t next) {
        const std::uint32_t row = row_of_[next];
        if (row < given)
          links.push_back({k, row});
        else
          entries.emplace_back(k, static_cast<Eigen::Index>(row) - static_cast<Eigen::Index>(given), -1.0);
      });
    }
    Sparse laplace(unknowns, unknowns);
    laplace.setFromTriplets(entries.begin(), entries.end());
    // One a thread: a solver counts its iterations.
    using Solver = Eigen::ConjugateGradient<Sparse, Eigen::Lower | Eigen::Upper, Eigen::IncompleteCholesky<double>>;
    tbb::enumerable_thread_specific<std::unique_ptr<Solver>> solvers;
    std::atomic<std::size_t> done = 0;
    std::atomic<bool> failed = false;
    tbb::parallel_for(std::size_t{0}, rows(), [&](std::size_t v) {
      Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
      for (const Link& link : links) right[link.unknown] += values_[link.row * rows() + v];
      // A cage point that no given node knows has no say inside either.
      if (right.cwiseAbs().maxCoeff() == 0) return;
      std::unique_ptr<Solver>& solver = solvers.local();
      if (!solver) {
        solver = std::make_unique<Solver>(laplace);
        solver->setTolerance(1e-13);
      }
      const Eigen::VectorXd solution = solver->solve(right);
      if (!(solver->error() < 1e-10)) failed = true;
      for (Eigen::Index k = 0; k < unknowns; ++k)
        values_[(given + static_cast<std::size_t>(k)) * rows() + v] = solution[k];
      progress.at("harmonic coordinates", static_cast<double>(++done) / static_cast<double>(rows()));
    });
    if (failed) throw Error("the harmonic coordinates did not converge; try a coarser resolution");
  }

  bool find_cell(const Vec3& at, std::array<std::uint32_t, 8>& corners,
                 std::array<std::array<double, 2>, 3>& share) const {
    std::array<int, 3> cell;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      const double floor = std::floor(at[axis]);
      if (!(floor >= 0 && floor + 1 < size_[k])) return false;
      cell[k] = static_cast<int>(floor);
      share[k] = {1 - (at[axis] - floor), at[axis] - floor};
    }
    for (std::size_t k = 0; k < 8; ++k) {
      corners[k] = row_of_[number(cell[0] + static_cast<int>(k & 1U), cell[1] + static_cast<int>((k >> 1U) & 1U),
                                  cell[2] + static_cast<int>(k >> 2U))];
      if (corners[k] == none) return false;
    }
    return true;
  }

  CageFrame frame_;
  double step_ = 0;
  Vec3 origin_;
  std::array<int, 3> size_{};
  std::vector<std::uint32_t> row_of_;  ///< of each node into values_
  std::vector<double> values_;         ///< a row of weights a node
};

}  // namespace

std::unique_ptr<Coordinates> harmonic_coordinates(const Cage& cage, int resolution, const Progress& progress) {
  return std::make_unique<Harmonic>(cage, resolution, progress);
}

}  // namespace rebake
