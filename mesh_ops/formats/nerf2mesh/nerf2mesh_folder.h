#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "mesh_ops/base/files.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

// Folders of nerf2mesh, stage 1 (Tang et al. 2023): mesh_k.obj with shared charts, feat0_k (diffuse) and feat1_k
// (specular) as PNG or JPEG, and mlp.json.

namespace rebake {

/// Origin::format of these folders.
inline constexpr const char* nerf2mesh_format = "nerf2mesh";

/// Rotation from the capture's frame (z up) to Rebake's (y up): (x, y, z) becomes (x, z, −y).
Affine nerf2mesh_to_y_up();

/// Whether a folder has an mlp.json and meshes of nerf2mesh. Examines names only.
bool is_nerf2mesh_folder(const std::filesystem::path& folder);
/// Whether its mlp.json is that of nerf2mesh.
bool has_nerf2mesh_decoder(const std::filesystem::path& folder);
/// Names of the files in a folder that are read with its scene; none if the scene is damaged.
std::set<std::string> own_nerf2mesh_files(const std::filesystem::path& folder);
/// The files that read_nerf2mesh_folder() reads, relative to the folder.
std::vector<std::filesystem::path> nerf2mesh_files(const std::filesystem::path& folder);

/// Reads a folder as one object in the capture's frame, of ColorRule::diffuse_and_network: feat0 is (255, diffuse RGB),
/// feat1 (specular RGB, 255). Throws FileError.
std::shared_ptr<const BakedObject> read_nerf2mesh_folder(const std::filesystem::path& folder,
                                                         const Progress& progress = {});

/// Writes an object in the capture's frame. Unchanged files are copied; textures that must be encoded become PNG.
/// Appends sentences for the user to `notes`. Throws EditError if the format cannot represent the object exactly.
void write_nerf2mesh_folder(AtomicFolder& out, const BakedObject& object, std::vector<std::string>& notes,
                            const Progress& progress = {});

}  // namespace rebake
