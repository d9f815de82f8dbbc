#pragma once

#include <filesystem>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Reads scene.json and the object folders it names. Throws FileError.
Scene read_scene_folder(const std::filesystem::path& folder, const Progress& progress = {});

/// Writes every node as it is: scene.json, and one MobileNeRF folder for each distinct object. Replaces the folder
/// whole or not at all. Where light follows edits, what objects were when their light was baked is written too, as
/// folders of their own. Returns sentences for people. Throws FileError.
std::vector<std::string> save_scene_folder(const Scene& scene, const std::filesystem::path& folder,
                                           const SourceGuard& guard, const Progress& progress = {});

/// The text of scene.json; `folder_of` names each object's folder, and with `with_bodies` each body's.
std::string write_scene_json(const Scene& scene, const std::map<const BakedObject*, std::string>& folder_of,
                             bool with_bodies = false);

/// `name` as a folder name: letters, digits, dot, dash and underscore, at most 200, different from all in `taken`.
std::string folder_name(const std::string& name, const std::vector<std::string>& taken);

}  // namespace rebake
