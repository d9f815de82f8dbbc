#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/formats/images/color_image.h"
#include "mesh_ops/scene/object.h"

// Meshes without a decoder, as modelling programs write them: they become objects of ColorRule::diffuse.

namespace rebake {

/// A material as far as Rebake draws it: unlit, with nearest filtering.
struct MeshMaterial {
  std::string name;
  std::shared_ptr<const ColorImage> image;   ///< null: the factor alone
  std::array<double, 4> factor{1, 1, 1, 1};  ///< linear red, green, blue and alpha, multiplied with the image
  /// Texels of less alpha are holes; nullopt: all are opaque.
  std::optional<double> cutoff;
  std::array<bool, 2> repeats{true, true};  ///< along u and v: the image outside 0 … 1; otherwise its border
};

/// Largest texture that repeats of an image make, in texels.
inline constexpr std::int64_t largest_repeated = std::int64_t{8192} * 8192;

/// Triangles of one material.
struct TexturedMesh {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;  ///< v points up
  std::vector<Face> faces;
  MeshMaterial material;
};

/// An object with one texture set per mesh that has triangles; meshes without images share one. Appends decisions to
/// `assumptions`. Throws FileError, naming `file`, if there are no triangles, if a position is not finite, or if the
/// repeats of an image within triangles need more than largest_repeated texels.
std::shared_ptr<BakedObject> object_of_meshes(std::vector<TexturedMesh> meshes, const std::filesystem::path& file,
                                              std::vector<std::string>& assumptions);

}  // namespace rebake
