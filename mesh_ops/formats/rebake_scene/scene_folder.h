#pragma once

#include <filesystem>
#include <functional>

#include "mesh_ops/base/files.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Reads scene.json and the object folders that it names. An object with children becomes a group of it and them.
/// Throws FileError.
Scene read_scene_folder(const std::filesystem::path& folder, const Progress& progress = {});

/// Reads a scene from the text of scene.json whose objects are elsewhere: `object_of` gives that of a folder name.
/// `name`: for messages. Throws FileError.
Scene read_scene_json(const std::string& text, const std::filesystem::path& name,
                      const std::function<std::shared_ptr<const BakedObject>(const std::string&)>& object_of);

/// Writes a scene to `out` without conversion: scene.json, and one MobileNeRF folder per distinct object. If the
/// scene's light follows edits, the bodies on which light was baked are written too, as folders of their own. Returns
/// sentences for the user about data that was left out. Throws FileError.
std::vector<std::string> save_scene_folder(const Scene& scene, AtomicFolder& out, const Progress& progress = {});

/// Sentences about parts of a scene that scene.json cannot hold: stored selections, and keyframes that need them.
std::vector<std::string> unsaved_parts(const Scene& scene);

/// Sentences about the unedited shapes of edited objects, which are not saved while light does not follow edits.
std::vector<std::string> unsaved_shapes(const Scene& scene);

/// The text of scene.json. `folder_of`: folder name per object, and with `with_bodies` also per body.
std::string write_scene_json(const Scene& scene, const std::map<const BakedObject*, std::string>& folder_of,
                             bool with_bodies = false);

/// Makes a folder name from `name`: letters, digits, dot, dash and underscore, at most 200 characters plus a number
/// that makes it different from all in `taken`.
std::string folder_name(const std::string& name, const std::vector<std::string>& taken);

}  // namespace rebake
