#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Name and version of the extension with which a glTF file carries a whole scene (gltf_features.schema.json).
inline constexpr const char* gltf_features_extension = "REBAKE_neural_texture";
inline constexpr int gltf_features_version = 1;

/// An object of the extension: its decoder as mlp.json, axes, layout, dialect and texture sets.
nlohmann::json object_json(const BakedObject& object, const nlohmann::json& sets);

/// The scene that a glTF file carries in the extension, with the same bytes of features, decoders and geometry as were
/// written; nothing if the file has no such extension. Throws FileError for damaged ones.
std::optional<Scene> read_gltf_features(const std::filesystem::path& file, const Progress& progress = {});

/// The scene without hidden nodes.
Scene visible_part(const Scene& scene);

}  // namespace rebake
