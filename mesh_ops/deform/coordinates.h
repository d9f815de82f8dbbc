#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage_frame.h"
#include "mesh_ops/deform/dual.h"
#include "mesh_ops/deform/mean_value_batch.h"

namespace rebake {

/// Which coordinates carry a cage's motion to points. Errors and times of each: `rebake study cage`.
enum class CageCoordinates {
  mean_value,  ///< anywhere; smooth, but may reach across a concave cage's gaps (Ju, Schaefer, Warren 2005)
  green,       ///< inside only; keeps shapes, may leave the cage (Lipman, Levin, Cohen-Or 2008)
  harmonic     ///< inside only; reaches around corners of concave cages, not across; on a grid (Joshi et al. 2007)
};

/// Mean value weights of one point in the cage frame, one a vertex. Sum and linear precision hold to a few rounding
/// errors wherever the point lies. With T = float or long double that is their rounding; with DualOf them each
/// weight carries its gradient in local units. Returns the size of all faces' terms over the size of their sum: weights
/// are off by about as many roundings. 0 for points near the surface, whose faces are weighed exactly.
template <class T>
double mean_value_weights(const CageFrame& cage, const Vec3& local, std::vector<T>& weights);

/// Green's coordinates of one point of the cage's space: φ one a vertex and ψ one a face (by the cage's face numbers,
/// in local units of length). False where the point is outside, and the weights mean nothing.
template <class T>
bool green_weights(const CageFrame& cage, const Vec3& point, std::size_t face_count, std::vector<T>& phi,
                   std::vector<T>& psi);

/// Weights of many points. x' = x + Σ w_row · motion_row, over the rows' motions (see row_motions).
class Coordinates {
 public:
  virtual ~Coordinates() = default;

  /// One a cage vertex, and with Green's one a cage face after them.
  std::size_t rows() const { return rows_; }
  /// Weights of batch_lanes points (in the cage's space) into weights[row][lane] and, where `gradients` is not null,
  /// their gradients into gradients[row][axis][lane]. A flag in `outside` says where the coordinates hold nothing: all
  /// weights are 0 there. Callable from any thread.
  virtual void weigh(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
                     std::uint8_t* outside) const = 0;
  /// How far each row moves when the cage goes from `rest` to `moved` (same faces). All zero where nothing moves.
  virtual std::vector<Vec3> row_motions(const Cage& rest, const std::vector<Vec3>& moved) const;

 protected:
  explicit Coordinates(std::size_t rows) : rows_(rows) {}

 private:
  std::size_t rows_;
};

/// The implementations of mean value weights that this machine's processor can run, the fastest first.
std::vector<MeanValueBatch> mean_value_batches();

/// `batch`: another implementation than the one for this machine's processor, to compare them.
std::unique_ptr<Coordinates> mean_value_coordinates(const Cage& cage, MeanValueBatch batch = mean_value_batches()[0]);
std::unique_ptr<Coordinates> green_coordinates(const Cage& cage);
/// Solved on a grid of `resolution` cells along the cage's longest side (8 … 256), see DirichletGrid: of second order
/// up to the surface. Sums and linear functions are exact to rounding.
std::unique_ptr<Coordinates> harmonic_coordinates(const Cage& cage, int resolution, const Progress& progress = {});

std::unique_ptr<Coordinates> coordinates_of(const Cage& cage, CageCoordinates kind, int resolution,
                                            const Progress& progress = {});

/// As coordinates_of; but what anyone still holds of an equal cage is taken again, since harmonic ones take seconds.
/// Callable from any thread.
std::shared_ptr<const Coordinates> shared_coordinates(const Cage& cage, CageCoordinates kind, int resolution,
                                                      const Progress& progress = {});

}  // namespace rebake
