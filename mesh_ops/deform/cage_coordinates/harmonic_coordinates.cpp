#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/cage_coordinates/coordinates.h"
#include "mesh_ops/deform/cage_coordinates/dirichlet_grid.h"

namespace rebake {

namespace {

// Limits in bytes: stored weights (one per cage vertex and grid node), and memory of the solver.
constexpr double max_bytes = 2e9, max_solver_bytes = 8e9;
constexpr double solver_bytes = 450;  // bytes per node, for eight functions together

// Each weight is the harmonic function that is 1 at one cage vertex, 0 at the others, and linear on every face.
class Harmonic final : public Coordinates {
 public:
  Harmonic(const Cage& cage, int resolution, const Progress& progress)
      : Coordinates(cage.vertices.size()), frame_(frame_of(cage)) {
    if (resolution < 8 || resolution > 256) throw FieldError("resolution", "must lie between 8 and 256");
    const Cage local{frame_.vertices, cage.faces};
    const double step = surface_box(local).sizes().maxCoeff() / resolution;
    check_memory(resolution, volume(local) / (step * step * step));
    check_fineness(local, resolution, step);
    grid_ = std::make_unique<DirichletGrid>(local, resolution, progress);
    check_memory(resolution, static_cast<double>(grid_->nodes()));
    values_.resize(grid_->nodes() * rows());
    std::vector<GridLanes> surface, values;
    std::string words = "harmonic coordinates";
    for (std::size_t first = 0; first < rows(); first += grid_lanes) {
      const auto start = std::chrono::steady_clock::now();
      surface.assign(grid_->surface().size(), GridLanes::Zero());
      for (std::size_t k = 0; k < surface.size(); ++k) {
        const SurfacePoint& point = grid_->surface()[k];
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::size_t lane = cage.faces[point.face][corner] - first;
          if (lane < grid_lanes) surface[k][static_cast<Eigen::Index>(lane)] += point.corners[corner];
        }
      }
      const double share = static_cast<double>(first) / static_cast<double>(rows());
      grid_->solve(surface, values, [&] { progress.at(words, share); });
      const std::size_t lanes = std::min(grid_lanes, rows() - first);
      for (std::size_t node = 0; node < values.size(); ++node)
        std::copy_n(values[node].data(), lanes, &values_[node * rows() + first]);
      if (first == 0) {
        // All groups of cage vertices take the same time.
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        const std::size_t groups = (rows() - lanes + grid_lanes - 1) / grid_lanes;
        const double rest = took.count() * static_cast<double>(groups);
        if (rest > 2) words += about + duration_text(rest);
      }
      progress.at(words, static_cast<double>(first + lanes) / static_cast<double>(rows()));
    }
    tbb::parallel_for(std::size_t{0}, grid_->isolated_nodes().size(), [&](std::size_t k) {
      const std::size_t node = grid_->isolated_nodes()[k];
      std::vector<double> weights;
      mean_value_weights(frame_, grid_->place(node), weights);
      std::copy(weights.begin(), weights.end(), &values_[node * rows()]);
    });
  }

  void compute_weights(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
                       std::uint8_t* outside) const override {
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      const Vec3 at = frame_.to_local(points[lane]);
      DirichletGrid::Cell cell;
      outside[lane] = at.allFinite() && grid_->find_cell(at, cell) ? 0 : 1;
      for (std::size_t row = 0; row < rows(); ++row) {
        double value = 0;
        std::array<double, 3> slope{};
        if (outside[lane] == 0)
          for (std::size_t k = 0; k < 8; ++k) {
            const double w = values_[cell.nodes[k] * rows() + row];
            const bool right = (k & 1U) != 0, up = (k & 2U) != 0, far = (k & 4U) != 0;
            const double x = right ? cell.at.x() : 1 - cell.at.x(), y = up ? cell.at.y() : 1 - cell.at.y(),
                         z = far ? cell.at.z() : 1 - cell.at.z();
            value += w * x * y * z;
            slope[0] += (right ? w : -w) * y * z;
            slope[1] += (up ? w : -w) * x * z;
            slope[2] += (far ? w : -w) * x * y;
          }
        weights[row * batch_lanes + lane] = value;
        if (gradients != nullptr)
          for (std::size_t axis = 0; axis < 3; ++axis)
            gradients[(row * 3 + axis) * batch_lanes + lane] = slope[axis] / grid_->step() * frame_.scale;
      }
    }
  }

 private:
  // Throws FieldError if cells are far larger than the cage is thick. Few nodes would then lie inside, and weights
  // would be extrapolated from outer nodes, far beyond 0 … 1.
  static void check_fineness(const Cage& local, int resolution, double step) {
    double area = 0;
    for (const Face& face : local.faces)
      area += (local.vertices[face[1]] - local.vertices[face[0]])
                  .cross(local.vertices[face[2]] - local.vertices[face[0]])
                  .norm() /
              2;
    const double thickness = 2 * volume(local) / area;  // thickness of a flat box; half the thickness of a rod
    constexpr double least = 0.5;
    if (thickness >= least * step) return;
    const double wanted = std::ceil(resolution * least * step / thickness);
    throw FieldError(
        "resolution",
        fmt::format("{} is too coarse: the thickness of the cage is {:.2g} of its longest side; {}", resolution,
                    thickness / (step * resolution),
                    wanted <= 256 ? fmt::format("use at least {:.0f}", wanted)
                                  : std::string("use mean_value or green coordinates, or a thicker cage")));
  }

  void check_memory(int resolution, double nodes) const {
    const auto check = [&](const char* what, double bytes, double most) {
      if (bytes > most)
        throw FieldError(
            "resolution",
            fmt::format(
                "{} would {} {:.1f} GB for this cage, at most {:.0f} GB are allowed; use a lower resolution or a "
                "coarser cage",
                resolution, what, bytes * 1e-9, most * 1e-9));
    };
    check("need", nodes * static_cast<double>(rows() * sizeof(double)), max_bytes);
    check("temporarily need", nodes * solver_bytes, max_solver_bytes);
  }

  CageFrame frame_;
  std::unique_ptr<DirichletGrid> grid_;
  std::vector<double> values_;  ///< [node][row]
};

}  // namespace

std::unique_ptr<Coordinates> harmonic_coordinates(const Cage& cage, int resolution, const Progress& progress) {
  return std::make_unique<Harmonic>(cage, resolution, progress);
}

}  // namespace rebake
