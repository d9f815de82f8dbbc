#pragma once

#include <cstddef>
#include <cstdint>

namespace rebake {

/// Number of points per batch (SIMD lanes).
inline constexpr std::size_t batch_lanes = 16;

/// A cage frame as plain arrays. The implementation is also compiled for newer processors and must share no inline
/// function with other files.
struct BatchCage {
  std::size_t vertex_count, edge_count, face_count;
  const double* vertices;      ///< x, y, z per vertex
  const std::uint32_t* edges;  ///< 2 vertices per edge
  const double* edge_frames;   ///< 4 per edge: tangent (3), length
  const std::uint32_t* faces;  ///< 3 vertices and 3 edges per face
  const double* face_frames;   ///< batch_face_numbers per face
};
/// Numbers per face: normal, tangent, outward (9), length, height, apex (3); edge_t, edge_o, normal_t, normal_o for
/// three edges each (12), lengths (3), and the sine of half the smallest angle.
inline constexpr std::size_t batch_face_numbers = 28;

/// Size of the workspace of a batch, in doubles.
std::size_t batch_workspace(const BatchCage& cage, bool gradients);
/// Offset in the workspace of the unnormalised weights: vertex_count rows of lanes, each followed by the three rows of
/// its gradient if `gradients`. One row follows with the sums of the magnitudes of each lane's terms. Divided by the
/// magnitude of the terms' sum, these give the number of rounding errors in the weights.
std::size_t batch_sums_at(const BatchCage& cage, bool gradients);

/// A face that the batch leaves out for one lane: the lane's point is near the face or near the line of one of its
/// edges.
struct SkippedFace {
  std::uint32_t face, lane;
  bool on;  ///< whether the point is near the face itself
};

/// Computes normalised mean value weights of batch_lanes finite points (local; all x, then all y, then all z) as
/// weights[vertex][lane], and gradients[vertex][axis][lane] if `gradients` is not null. `start`, if not null, has the
/// unnormalised weights of faces that are not in `cage`, laid out as the sums in the workspace. Returns the number of
/// faces left out, listed in `near` (at most face_count · batch_lanes); weights of their lanes are incomplete. Every
/// implementation gives the same bits: lanes do not mix, and no operation is contracted or reordered.
using MeanValueBatch = std::size_t (*)(const BatchCage& cage, const double* points, const double* start,
                                       double* workspace, double* weights, double* gradients, SkippedFace* near);

// One source file, compiled once per processor level.
std::size_t mean_value_batch_baseline(const BatchCage& cage, const double* points, const double* start,
                                      double* workspace, double* weights, double* gradients, SkippedFace* near);
#ifdef REBAKE_WIDE_VECTORS
std::size_t mean_value_batch_v3(const BatchCage& cage, const double* points, const double* start, double* workspace,
                                double* weights, double* gradients, SkippedFace* near);
std::size_t mean_value_batch_v4(const BatchCage& cage, const double* points, const double* start, double* workspace,
                                double* weights, double* gradients, SkippedFace* near);
#endif

}  // namespace rebake
