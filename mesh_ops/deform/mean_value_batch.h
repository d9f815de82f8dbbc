#pragma once

#include <cstddef>
#include <cstdint>

namespace rebake {

/// Points that are weighed together.
inline constexpr std::size_t batch_lanes = 16;

/// A cage frame as plain arrays: this crosses into a file that is compiled for newer processors too, which must share
/// no inline function with any other.
struct BatchCage {
  std::size_t vertex_count, edge_count, face_count;
  const double* vertices;      ///< 3 a vertex
  const std::uint32_t* edges;  ///< 2 vertices an edge
  const double* edge_frames;   ///< tangent (3), length: 4 an edge
  const std::uint32_t* faces;  ///< 3 vertices and 3 edges a face
  const double* face_frames;   ///< batch_face_numbers a face
};
/// normal, tangent, outward (9), length, height, apex (3), then for each edge: edge_t, edge_o, normal_t, normal_o (12),
/// lengths (3), and the sine of half the smallest angle.
inline constexpr std::size_t batch_face_numbers = 28;

/// Where the batch works, in doubles; batch_sums_at(cage, gradients) into it lie the weights before they are
/// normalised: vertex_count rows of lanes, each followed by its gradient's three rows if `gradients`; and behind them a
/// row of the sizes of all terms that a lane's weights are summed from. Divided by the size of their sum, these say how
/// many roundings the weights are off.
std::size_t batch_workspace(const BatchCage& cage, bool gradients);
std::size_t batch_sums_at(const BatchCage& cage, bool gradients);

/// A face that a lane's point is so near, or so near the line of one of its edges, that the batch leaves it out.
struct BatchNear {
  std::uint32_t face, lane;
  bool on;  ///< near the face itself
};

/// Normalised mean value weights of batch_lanes finite points (local; all x, then all y, then all z) into
/// weights[vertex][lane], and with `gradients` not null their gradients into gradients[vertex][axis][lane]. Returns how
/// many it left out, into `near` (face_count · batch_lanes at most): the weights of their lanes are not whole. `start`,
/// where not null: what faces that are not in `cage` weigh before normalising, laid out as the sums in the workspace.
/// Every implementation gives the same bits: lanes do not mix, and nothing is contracted or reordered.
using MeanValueBatch = std::size_t (*)(const BatchCage& cage, const double* points, const double* start,
                                       double* workspace, double* weights, double* gradients, BatchNear* near);

// One source, compiled once for each kind of processor.
std::size_t mean_value_batch_baseline(const BatchCage& cage, const double* points, const double* start,
                                      double* workspace, double* weights, double* gradients, BatchNear* near);
#ifdef REBAKE_WIDE_VECTORS
std::size_t mean_value_batch_v3(const BatchCage& cage, const double* points, const double* start, double* workspace,
                                double* weights, double* gradients, BatchNear* near);
std::size_t mean_value_batch_v4(const BatchCage& cage, const double* points, const double* start, double* workspace,
                                double* weights, double* gradients, BatchNear* near);
#endif

}  // namespace rebake
