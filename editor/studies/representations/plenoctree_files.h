#pragma once

#include <filesystem>

#include "editor/studies/representations/plenoctree.h"
#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// Writes a tree as svox does: data_dim, data_format, child, parent_depth, data (half floats), invradius3, offset and
/// others. Throws FileError. Source of the format: sxyu/svox and sxyu/volrend.
void write_plenoctree(const PlenOctree& tree, const std::filesystem::path& file, const SourceGuard& guard);

/// Writes the form that is quantised for the web: per harmonic, a table of 65536 colours found by median cut over the
/// leaves, instead of `data` (quant_colors, quant_map, sigma). Throws FileError.
void write_quantised_plenoctree(const PlenOctree& tree, const std::filesystem::path& file, const SourceGuard& guard);

/// Reads either form, with `invradius3` or `invradius`. Throws FileError that names the array for missing, truncated or
/// contradictory ones, and for formats other than spherical harmonics to degree 3.
PlenOctree read_plenoctree(const std::filesystem::path& file);

}  // namespace rebake
