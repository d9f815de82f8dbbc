#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/deform/cage_coordinates/cage_frame.h"
#include "mesh_ops/deform/cage_coordinates/dual.h"
#include "mesh_ops/deform/cage_coordinates/mean_value_batch.h"

namespace rebake {

/// Kinds of cage coordinates. Errors and times of each: `rebake study cage`.
enum class CageCoordinates {
  mean_value,  ///< defined everywhere; smooth, but may act across gaps of concave cages (Ju, Schaefer, Warren 2005)
  green,       ///< inside only; preserves shapes, but results may leave the cage (Lipman, Levin, Cohen-Or 2008)
  harmonic     ///< inside only; acts around corners of concave cages, not across gaps (Joshi et al. 2007); on a grid
};

/// Mean value weights of one point in the cage frame, one per vertex. They sum to 1 and reproduce linear functions to a
/// few rounding errors of T everywhere. With DualOf types, each weight carries its gradient in local units. Returns the
/// sum of the terms' magnitudes divided by the magnitude of their sum: about the number of rounding errors in the
/// weights. Returns 0 for points near the surface, where faces are evaluated exactly.
template <class T>
double mean_value_weights(const CageFrame& cage, const Vec3& local, std::vector<T>& weights);

/// Green's coordinates of one point in the space of the cage: φ per vertex, and ψ per face of the cage (`face_count` of
/// them, in local units of length). Returns false if the point is outside; the weights are then meaningless.
template <class T>
bool green_weights(const CageFrame& cage, const Vec3& point, std::size_t face_count, std::vector<T>& phi,
                   std::vector<T>& psi);

/// Cage coordinates: weights of points for the rows of a cage. A deformed point is x + Σ weight[row] · motion[row],
/// with motions from row_motions().
class Coordinates {
 public:
  virtual ~Coordinates() = default;

  /// Number of rows: one per cage vertex, and with Green's coordinates one per cage face after them.
  std::size_t rows() const { return rows_; }
  /// Computes weights of batch_lanes points, given in the space of the cage, as weights[row][lane], and
  /// gradients[row][axis][lane] if `gradients` is not null. Sets outside[lane] to 1 and all weights to 0 if the
  /// coordinates are undefined at a point. Thread-safe.
  virtual void compute_weights(const std::array<Vec3, batch_lanes>& points, double* weights, double* gradients,
                               std::uint8_t* outside) const = 0;
  /// Motion per row when the cage's vertices go from `rest` to `moved` (same faces). Zero for rows that
  /// do not move, and for vertices that no face uses.
  virtual std::vector<Vec3> row_motions(const Cage& rest, const std::vector<Vec3>& moved) const;

 protected:
  explicit Coordinates(std::size_t rows) : rows_(rows) {}

 private:
  std::size_t rows_;
};

/// Implementations of mean value weights that this processor can run, the fastest first.
std::vector<MeanValueBatch> mean_value_batches();

/// Mean value coordinates. `batch`: implementation to use, for comparisons.
std::unique_ptr<Coordinates> mean_value_coordinates(const Cage& cage, MeanValueBatch batch = mean_value_batches()[0]);
std::unique_ptr<Coordinates> green_coordinates(const Cage& cage);
/// Harmonic coordinates, solved on a DirichletGrid with `resolution` cells along the cage's longest side (8 … 256). The
/// error is of second order in the cell size up to the surface; sums and linear functions are exact to rounding. Parts
/// closer to each other than a cell follow each other. Throws
/// FieldError for a resolution that is out of range, too coarse for the cage, or needs too much memory.
std::unique_ptr<Coordinates> harmonic_coordinates(const Cage& cage, int resolution, const Progress& progress = {});

/// Coordinates of a kind; `resolution` is for harmonic ones.
std::unique_ptr<Coordinates> coordinates_of(const Cage& cage, CageCoordinates kind, int resolution,
                                            const Progress& progress = {});

/// As coordinates_of(), but returns existing coordinates of an equal cage while any caller holds them, since harmonic
/// ones take seconds to compute. Thread-safe.
std::shared_ptr<const Coordinates> shared_coordinates(const Cage& cage, CageCoordinates kind, int resolution,
                                                      const Progress& progress = {});

}  // namespace rebake
