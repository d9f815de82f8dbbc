#pragma once

#include <array>
#include <string>
#include <vector>

#include "render/picture.h"

namespace rebake {

/// Names of the passes.
inline constexpr std::array<const char*, 7> image_pass_names{"color", "alpha",    "depth", "normal",
                                                             "node",  "position", "light"};

/// Channels of a picture as floats.
struct ImagePasses {
  struct Channel {
    std::string name;  ///< as in an OpenEXR file: "R", "depth.Z"
    bool half = false;
    std::vector<float> values;  ///< width × height, row 0 at the top
  };
  int width = 0, height = 0;
  std::vector<Channel> channels;
  std::vector<std::pair<std::string, std::string>> attributes;  ///< text: the names of nodes

  const Channel* find(const std::string& name) const;
};

/// Throws FieldError for an unknown name of a pass; the message lists all.
void check_pass_names(const std::vector<std::string>& names);

/// Renders passes:
/// - color: R, G, B in linear light, multiplied by alpha if that is a pass too, else over the background;
/// - alpha: A, the share of covered samples;
/// - depth: depth.Z, distance along the view axis in scene units; 1e10 where nothing is;
/// - normal: normal.X, .Y, .Z of the triangle in world space, towards the camera; 0 where nothing is;
/// - node: node.ID, from 1 in the order of the scene; 0 where nothing is. The attribute rebake/nodes has the names as
///   JSON;
/// - position: position.X, .Y, .Z in the object's space; 0 where nothing is;
/// - light: light.R, .G, .B, by how much `lighting` changes the linear colours.
/// Depth, normal, node and position are those of the nearest of the pixel's samples, computed in double by rays through
/// their positions. Throws FieldError.
ImagePasses render_passes(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
                          const Lighting* lighting, const std::vector<std::string>& names);

/// The files of passes that are written separately: picture.depth.exr, …; alpha is in that of the colours if both are
/// written.
std::vector<std::filesystem::path> pass_files(const std::vector<std::string>& names, const std::filesystem::path& path);

/// The passes as one OpenEXR file, or as a file each beside `path` (picture.depth.exr). Throws FileError.
void write_passes(const ImagePasses& passes, const std::filesystem::path& path, bool separate,
                  const SourceGuard& guard);

}  // namespace rebake
