#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace rebake {

/// Whether a file name belongs to a MobileNeRF folder, or to the files that Rebake adds to one.
bool is_baked_file_name(const std::string& name);

/// Names of the files in a folder that belong to its MobileNeRF scene, or that Rebake adds there. Geometry and textures
/// belong to it if they are read with it, since another program's file may have such a name. None in a folder where
/// that is unclear.
std::set<std::string> own_baked_files(const std::filesystem::path& folder);

/// Hash of the names and contents of baked_files(). Throws FileError.
std::uint64_t baked_hash(const std::filesystem::path& folder);

/// Whether the decoder of a folder (mlp.json) is one by its content, not only by its name.
bool has_baked_decoder(const std::filesystem::path& folder);

/// The files that read_baked_folder() reads, relative to the folder; empty without mlp.json. Throws FileError as
/// find_baked_layout().
std::vector<std::filesystem::path> baked_files(const std::filesystem::path& folder);

}  // namespace rebake
