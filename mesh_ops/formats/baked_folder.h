#pragma once

#include <filesystem>
#include <memory>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads a MobileNeRF folder of any layout. Throws FileError.
std::shared_ptr<const BakedObject> read_baked_folder(const std::filesystem::path& folder, Axes axes,
                                                     const Progress& progress = {});

/// How many texture sets lie in a split or chunked folder, counted from shape0 on by their geometry, whatever mlp.json
/// says; beyond its `obj_num` only those whose textures are there too. Throws FileError for a gap among the first
/// `obj_num`, behind which a set would be lost.
std::size_t found_texture_sets(const std::filesystem::path& folder, std::size_t obj_num);

/// The names of a layout's files.
std::string geometry_name(Layout layout, std::size_t set, std::size_t chunk);
std::string feature_name(Layout layout, std::size_t set, int image);

/// More than any capture has: what claims more is damaged.
inline constexpr std::size_t most_texture_sets = 4096;

/// Chunk viewers load exactly this many chunks a set.
inline constexpr std::size_t chunks_a_set = 8;

}  // namespace rebake
