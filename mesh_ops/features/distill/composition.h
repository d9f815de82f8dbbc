#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A scene prepared for fuse(): all visible triangles in world space, with their texels repacked into pages. Each
/// triangle belongs to a part, which states the source of its texels' colours.
struct Composition {
  /// Triangles of one node whose colours follow from one decoder.
  struct Part {
    NodeId node;
    std::string name;     ///< name of the node
    std::size_t teacher;  ///< index of its decoder
    bool bent;            ///< whether vertices have their own rotations; view directions are rotated back by them
    std::size_t triangles = 0;
    bool plain_alpha = false;  ///< some of its texels use all 8 bits of features 3 and 7
    /// Correction of its colours by light; null for colours as baked. A part with light is of one texture set.
    std::shared_ptr<const LightMap> light = nullptr;
    /// For parts with specular changes: rotation from directions that the decoder takes to those at baking, and from
    /// world to object space.
    Mat3 to_baked = Mat3::Identity(), to_object = Mat3::Identity();
  };
  /// A rectangle of texels of one patch, at most `block_side` wide and high, whose triangles belong to one part.
  struct Block {
    std::uint32_t page, part;
    TexelRect rect;
    std::uint32_t first_face, face_count;  ///< range of Composition::faces
    std::uint32_t opaque;                  ///< number of opaque texels
  };
  static constexpr int block_side = 32;

  std::vector<Part> parts;
  /// Decoders that take world directions; for bent parts, directions rotated back by the vertices' rotations.
  std::vector<std::shared_ptr<const Decoder>> teachers;
  /// Per teacher: the mean rotation of its triangles; the identity unless all of them are bent.
  std::vector<Mat3> frames;
  /// Original texels, repacked, with plain alpha, which stores all values exactly.
  std::vector<TextureSet> pages;
  std::vector<Block> blocks;         ///< blocks with opaque texels, in page order
  std::vector<std::uint32_t> faces;  ///< indices of faces in their page, in the order of blocks
  std::uint64_t opaque_texels = 0;
  bool forward = false;  ///< whether all parts are forward-facing
  bool recoded = false;  ///< whether objects with plain colours were given a network (with_networks())

  /// Whether one decoder reproduces everything without a fit.
  bool exact() const;
};

/// Decomposes a scene for one plain folder. If a texel is used with different rotations, each use gets its own copy;
/// other uses share the texel, which counts for the first part. An exact composition has parts and teachers only.
/// `lighting` is applied to colours. Throws EditError if nothing visible is opaque, and for nodes whose texels cannot
/// be moved.
Composition composed(const Scene& scene, int largest_side, const Progress& progress = {},
                     const Lighting* lighting = nullptr);

/// One opaque texel of a block.
struct TexelSite {
  int x, y;
  Vec3 position, normal;  ///< in world space; the normal is unit, or 0 for a triangle without area
  Mat3 turn;              ///< fed direction = turn · world direction, then normalised
  /// Light correction: linear colour → gain · colour + offset.
  Eigen::Vector3f gain = Eigen::Vector3f::Ones(), offset = Eigen::Vector3f::Zero();
  GlossPlace gloss{};  ///< change of the specular reflection, if the part has one
};

/// The block's opaque texels near triangles, in pairs of rows, so that four consecutive ones are mostly a 2×2 square.
std::vector<TexelSite> sites_of(const Composition& composition, const Composition::Block& block);

}  // namespace rebake
