#pragma once

#include <cstdint>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/photo_camera.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A label per pixel of a photograph, row by row from the top.
struct LabelImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> labels;
};

/// A photograph's camera with its mask. The mask may have another size than the photograph, but the same frame.
struct MaskedPhoto {
  PhotoCamera camera;
  LabelImage mask;
};

/// Votes of photographs for the triangles of one object.
struct MaskVotes {
  std::vector<std::uint32_t> seen;                ///< per triangle: votes for any label or none
  std::vector<std::vector<std::uint32_t>> votes;  ///< [index of the label][triangle]
};

/// Lets photographs vote for labels. A vote is the label of the pixel at which an opaque point of a triangle appears,
/// if nothing in `occluders` hides it; up to four points per triangle vote in each photograph. Triangles without an
/// opaque point among 16 samples get no votes. `objects` must be among `occluders`; poses and lenses are in world
/// space.
std::vector<MaskVotes> mask_votes(const std::vector<PlacedNode>& objects, const std::vector<PlacedNode>& occluders,
                                  const std::vector<MaskedPhoto>& photos, const std::vector<std::uint8_t>& labels,
                                  const Progress& progress = {});

/// Adds the votes of other photographs.
void add_votes(std::vector<MaskVotes>& votes, const std::vector<MaskVotes>& more);

/// A decision by votes.
struct MaskDecision {
  std::vector<TriangleSet> chosen;  ///< per label: the triangles whose votes for it reach the threshold
  TriangleSet any;                  ///< the triangles whose votes for all labels together reach the threshold
  std::size_t seen = 0;             ///< number of triangles with votes
  double consistency = 1;           ///< mean share of the votes that agree with the most common one of their triangle
};
/// Decides for each triangle on the label with the most votes (the first of equals) if their share reaches `threshold`
/// (0 … 1).
MaskDecision decide(const MaskVotes& votes, double threshold);

}  // namespace rebake
