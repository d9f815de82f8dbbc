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

/// Where the batch works: workspace of batch_workspace(cage, gradients) doubles.
std::size_t batch_workspace(const BatchCage& cage, bool gradients);

/// Normalised mean value weights of batch_lanes points (local; all x, then all y, then all z) into
/// weights[vertex][lane], and with `gradients` not null their gradients into gradients[vertex][axis][lane]. A flag in
/// `delicate` says that the lane's point is so near a face that plane_local must weigh it. `start`, where not null:
/// what faces that are not in `cage` weigh before normalising, as vertex_count rows of lanes, each followed by its
/// gradient's three rows if `gradients` is not null.
using MeanValueBatch = void (*)(const BatchCage& cage, const double* points, const double* start, double* workspace,
                                double* weights, double* gradients, std::uint8_t* delicate);

// One source, compiled once for each kind of processor.
void mean_value_batch_baseline(const BatchCage& cage, const double* points, const double* start, double* workspace,
                               double* weights, double* gradients, std::uint8_t* delicate);
#ifdef REBAKE_WIDE_VECTORS
void mean_value_batch_v3(const BatchCage& cage, const double* points, const double* start, double* workspace,
                         double* weights, double* gradients, std::uint8_t* delicate);
void mean_value_batch_v4(const BatchCage& cage, const double* points, const double* start, double* workspace,
                         double* weights, double* gradients, std::uint8_t* delicate);
#endif

}  // namespace rebake
