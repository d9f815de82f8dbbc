#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// The photograph with this name in a folder; its extension may be missing. Empty if it is not there, or if the name
/// leaves the folder.
std::filesystem::path photograph_at(const std::filesystem::path& folder, const std::string& name);

/// The folder that names of photographs and masks in a camera file are relative to: that of the file, or the folder
/// around COLMAP's sparse/0.
std::filesystem::path capture_folder(const std::filesystem::path& camera_file);

/// The photographs and masks of a capture that exist, also outside its folder, to be protected from being overwritten.
std::vector<std::filesystem::path> capture_files(const std::filesystem::path& camera_file,
                                                 const std::vector<PhotoCamera>& cameras);

/// The photographs, and after them the masks, that exist where the cameras name them.
std::vector<std::filesystem::path> named_files(const std::filesystem::path& camera_file,
                                               const std::vector<PhotoCamera>& cameras);

/// named_files(), and photographs that are not read because they lie outside of the capture; COLMAP names them in its
/// folder `images`. For guards.
std::vector<std::filesystem::path> protected_files(const std::filesystem::path& camera_file,
                                                   const std::vector<PhotoCamera>& cameras);

/// Returns files of a capture.
using FilesOfCapture = std::vector<std::filesystem::path> (*)(const std::filesystem::path& camera_file,
                                                              const std::vector<PhotoCamera>& cameras);
/// The files of captures whose camera files lie in a folder, or in the two folders around it.
std::vector<std::filesystem::path> captured_files_at(const std::filesystem::path& folder,
                                                     FilesOfCapture files_of = capture_files);

}  // namespace rebake
