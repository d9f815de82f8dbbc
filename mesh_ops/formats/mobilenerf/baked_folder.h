#pragma once

#include <filesystem>
#include <memory>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Reads a MobileNeRF folder of any layout. Its files do not state `axes`. Throws FileError.
std::shared_ptr<const BakedObject> read_baked_folder(const std::filesystem::path& folder, Axes axes,
                                                     const Progress& progress = {});

/// Number of texture sets in a split or chunked folder. Counts geometry files from shape0 on, whatever mlp.json says.
/// Sets beyond its `obj_num` count only if their textures exist too. Throws FileError for a gap among the first
/// `obj_num` sets, since sets after it would be lost.
std::size_t count_texture_sets(const std::filesystem::path& folder, std::size_t obj_num);

/// File names in a layout. `chunk` is used by the chunked layout only; `image` is 0 or 1.
std::string geometry_name(Layout layout, std::size_t set, std::size_t chunk);
std::string feature_name(Layout layout, std::size_t set, int image);

/// More sets than any capture has; a larger count means that a file is damaged.
inline constexpr std::size_t max_texture_sets = 4096;

/// Number of chunks per set; chunk viewers load exactly this many.
inline constexpr std::size_t chunks_per_set = 8;

}  // namespace rebake
