#pragma once

#include <filesystem>

#include "mesh_ops/formats/export.h"

namespace rebake {

/// Writes a scene as glTF 2.0 (.glb) for modelling programs and game engines: the visible nodes with their names and
/// transforms, stored views as cameras, and per texture set an unlit material (KHR_materials_unlit) whose base colour
/// is the mean over the directions from which each triangle is visible (mean_colors()). Keyframes become an animation
/// of nodes and of morph targets (motion_samples.h). The report says what this costs. Replaces only glTF files of this
/// function. Throws EditError for a scene without triangles, FieldError for options that do not apply, FileError.
ExportReport write_gltf(const Scene& scene, const std::filesystem::path& file, const ExportOptions& options,
                        const Progress& progress);

/// As write_gltf(), and carries the features, decoders, exact geometry and the whole scene in an extension, so that
/// read_gltf_features() gives the same scene. Its textures are those of the objects, not packed.
ExportReport write_gltf_features(const Scene& scene, const std::filesystem::path& file, const ExportOptions& options,
                                 const Progress& progress);

}  // namespace rebake
