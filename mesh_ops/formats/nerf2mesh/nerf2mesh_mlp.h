#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "mesh_ops/texture/decoder.h"

namespace rebake {

/// Largest number of meshes of a folder.
inline constexpr int max_nerf2mesh_meshes = 64;

/// Contents of the mlp.json of a nerf2mesh folder.
struct Nerf2MeshMlp {
  Decoder decoder;  ///< ColorRule::diffuse_and_network
  int cascade = 1;  ///< number of meshes
  /// Other members, such as "bound": key → JSON text as spelt.
  std::map<std::string, std::string> others = {};
};

/// Whether the text has the weights of a nerf2mesh network. Never throws.
bool is_nerf2mesh_mlp(std::string_view text);

/// Reads `net.0.weight` (6 × h: direction, specular features) and `net.1.weight` (h × 3), rows are inputs; no biases.
/// The network has one hidden layer, so the decoder's second one is the identity. Throws FileError for other shapes.
Nerf2MeshMlp read_nerf2mesh_mlp(std::string_view text, const std::filesystem::path& name);

/// Whether a decoder has the form that read_nerf2mesh_mlp() returns, with any rotation folded in.
bool is_nerf2mesh_decoder(const Decoder& decoder);

/// Writes mlp.json. `mlp.decoder` must fulfil is_nerf2mesh_decoder().
std::string write_nerf2mesh_mlp(const Nerf2MeshMlp& mlp);

}  // namespace rebake
