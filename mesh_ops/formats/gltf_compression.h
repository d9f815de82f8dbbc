#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Ways to make glTF files smaller. Each needs an extension that the reader must know.
struct GltfCompression {
  bool quantized = false;  ///< positions and texture coordinates in 16 bits (KHR_mesh_quantization)
  bool meshopt = false;    ///< EXT_meshopt_compression of vertices and triangles, without loss
  bool webp = false;       ///< colours as lossless WebP (EXT_texture_webp)
  bool any() const { return quantized || meshopt || webp; }
};

/// Reads the words quantized, meshopt and webp. Throws FieldError("compress") for another one.
GltfCompression gltf_compression(const std::vector<std::string>& words);

/// Positions as normalised 16-bit integers: place = value / 32767 · scale.
struct QuantizedPositions {
  std::vector<std::array<std::int16_t, 4>> values;  ///< the fourth fills up to 8 bytes
  double scale = 1;                                 ///< largest coordinate
  std::array<int, 3> least{}, most{};
};
/// Errors are at most scale / 65534 per coordinate.
QuantizedPositions quantized_positions(const std::vector<Vec3>& positions);

/// Texture coordinates as normalised 16-bit integers, with v down; errors are at most 1 / 131070. Empty if one lies
/// outside 0 … 1.
std::vector<std::array<std::uint16_t, 2>> quantized_uvs(const std::vector<Vec2>& uvs);

}  // namespace rebake
