#pragma once

#include <filesystem>

#include "editor/studies/representations/snerg_scene.h"
#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// Writes the published files into an existing folder: scene_params.json, atlas_indices.png, rgba_%03d.png and
/// feature_%03d.png (four planes of the atlas each). Throws FileError. Source of the format: google-research/snerg,
/// export.py.
void write_snerg(const SnergScene& scene, const std::filesystem::path& folder, const SourceGuard& guard);

/// Reads these files. Throws FileError that names the file for missing, truncated or contradictory ones, and for scenes
/// in normalised device coordinates (`ndc`), which are not supported.
SnergScene read_snerg(const std::filesystem::path& folder);

}  // namespace rebake
