#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/features/atlas.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// All that is visible of a scene as one soup in world space, each triangle with what gives its texels their colours.
struct Composition {
  /// Triangles whose colours follow from one decoder.
  struct Part {
    NodeId node;
    std::string name;     ///< the node's
    std::size_t teacher;  ///< number of its decoder
    bool bent;            ///< turned apart: rays are turned back by the vertices' rotations first
    std::size_t triangles = 0;
    bool plain_alpha = false;  ///< some of its texels have all bits of features 3 and 7
    /// What light does to its colours, of one texture set then; null where they are as they were baked.
    std::shared_ptr<const LightMap> light = nullptr;
    /// Of what mirrors light: turn fed directions into those that its surface was baked with, and directions of the
    /// world into the object's.
    Mat3 to_baked = Mat3::Identity(), to_object = Mat3::Identity();
  };
  /// A rectangle of texels of one patch, at most `block_side` a side, whose triangles are of one part.
  struct Block {
    std::uint32_t page, part;
    TexelRect rect;
    std::uint32_t first_face, face_count;  ///< those that come near it, among `faces`
    std::uint32_t opaque;                  ///< texels
  };
  static constexpr int block_side = 32;

  std::vector<Part> parts;
  /// Fed directions of the world; for bent parts those that the vertices' rotations turned back.
  std::vector<std::shared_ptr<const Decoder>> teachers;
  /// For each teacher the turn that its triangles have on the whole: the identity unless all of them are bent.
  std::vector<Mat3> frames;
  /// Texels as they were, moved; alpha plain, which holds all values exactly.
  std::vector<TextureSet> pages;
  std::vector<Block> blocks;         ///< those with opaque texels, page by page
  std::vector<std::uint32_t> faces;  ///< of the blocks' pages
  std::uint64_t opaque_texels = 0;
  bool forward = false;  ///< all of it is forward-facing

  /// Whether one decoder shows all of it without a fit.
  bool exact() const;
};

/// Takes a scene apart for one plain folder: where two uses of a texel are turned differently, each gets its own; where
/// they are not, they share it, and it counts as the first one's. Of an exact one there are parts and teachers only.
/// With `lighting`, colours are those that light makes of them. Throws EditError where nothing visible shows anything,
/// and for nodes whose texels cannot be moved.
Composition composed(const Scene& scene, int largest_side, const Progress& progress = {},
                     const Lighting* lighting = nullptr);

/// One opaque texel of a block.
struct TexelSite {
  int x, y;
  Vec3 position, normal;  ///< in the world; the normal is of length 1, or 0 for a triangle without area
  Mat3 turn;              ///< fed direction = turn · world direction, then normalised
  /// In linear light colours become gain · colour + offset.
  Eigen::Vector3f gain = Eigen::Vector3f::Ones(), offset = Eigen::Vector3f::Zero();
  GlossPlace gloss{};  ///< and what its part's light mirrors is added
};

/// The block's opaque texels that triangles come near: two rows at a time, so that a run of four is mostly a square.
std::vector<TexelSite> sites_of(const Composition& composition, const Composition::Block& block);

}  // namespace rebake
