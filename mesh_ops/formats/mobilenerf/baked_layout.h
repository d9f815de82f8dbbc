#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// File names in a layout. `chunk` is used by the chunked layout only; `image` is 0 or 1.
std::string geometry_name(Layout layout, std::size_t set, std::size_t chunk);
std::string feature_name(Layout layout, std::size_t set, int image);

/// More sets than any capture has; a larger count means that a file is damaged.
inline constexpr std::size_t max_texture_sets = 4096;

/// Number of chunks per set; chunk viewers load exactly this many.
inline constexpr std::size_t chunks_per_set = 8;

/// The files of a MobileNeRF folder, as it spells them.
struct BakedLayout {
  struct Set {
    std::vector<std::string> geometry;    ///< the whole file first, if it exists; then its chunks in order
    std::array<std::string, 2> textures;  ///< empty: missing
    bool has_whole = false;               ///< whether geometry begins with a whole file
    bool needs_repair = false;            ///< chunks are missing or have other numbers; exports must not copy them
  };
  bool unsplit = false;
  std::vector<Set> sets;
  std::vector<std::string> assumptions;  ///< sentences about files that are missing, renamed or not read
  std::string missing;                   ///< a file without which the folder cannot be read; empty if there is none
  std::string problem;                   ///< why, after the name of that file
};

/// Finds the files of a folder. `obj_num`: as in mlp.json; nothing for the unsplit layout. Throws FileError for names
/// that are ambiguous.
BakedLayout find_baked_layout(const std::filesystem::path& folder, std::optional<int> obj_num);

}  // namespace rebake
