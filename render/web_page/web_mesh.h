#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "mesh_ops/light/relight/relighting.h"
#include "render/gpu_scene/surface.h"
#include "render/web_page/web_image.h"

namespace rebake {

/// Steps per texel of texture coordinates.
inline constexpr double web_texel_steps = 1024;

/// A texture set's triangles in the binary layout of the web page (README.md).
struct WebMesh {
  std::string bytes;  ///< all streams, one after the other, compressed (gzip)
  std::size_t triangles = 0, vertices = 0;
};

/// Encodes the triangles of a surface that may show opaque texels. `step`: spacing of the grid of positions, in object
/// units. `rotates`: with rotations, of vertices without any too. `light`: its light map, or null. Adds "vertices",
/// "triangles", "streams", "step", "origin" to `manifest`.
WebMesh web_mesh(const PreparedSurface& surface, double step, bool rotates, const LightMap* light,
                 nlohmann::json& manifest);

/// Positions and rotations of the vertices of web_mesh() in several poses of the same surface, in the same way
/// and order. Fills in the streams: x0, y0, z0, qx0 … of the first pose, and so on.
std::string web_poses(const PreparedSurface& surface, double step, bool rotates, const std::vector<const Soup*>& poses,
                      nlohmann::json& manifest);

/// The texels of a surface as two images, packed as on the GPU. All bytes of transparent texels are 0.
struct WebTexels {
  WebImage image0, image1;
  int width = 0, height = 0;
};
WebTexels web_texels(const PreparedSurface& surface, WebImageCoding coding);

/// Compresses bytes in the format gzip (RFC 1952), which browsers unpack by DecompressionStream.
std::string gzipped(std::string_view bytes);

/// Gains or offsets of a light map, 4 half floats per node, compressed.
std::string web_light_texels(const LightChart& chart, const std::vector<Eigen::Vector3f>& values);
/// One side of a gloss map, 4 half floats per node, and the sun amounts of both sides, 2 half floats per node.
std::string web_gloss_normals(const std::vector<Eigen::Vector4f>& normals);
std::string web_gloss_suns(const GlossMap& map);

}  // namespace rebake
