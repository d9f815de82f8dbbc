#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/base/files.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// Widest texture that a layout's viewers take.
int largest_texture_side(Layout layout);

/// Writes one object below `folder` (relative, may be empty) of an atomic folder: in object space, in `layout`. What is
/// still as it was read is copied and hash-checked; edited sets drop texels that nobody uses. Turned triangles are kept
/// in turns.bin, and with `baked_places` where triangles were when their light was baked in baked.bin: only Rebake
/// reads these; then texels that nobody uses are kept, since light has it by texels what was erased. Appends sentences
/// for people to `notes`.
void write_baked_folder(AtomicFolder& out, const std::filesystem::path& folder, const BakedObject& object,
                        Layout layout, std::vector<std::string>& notes, const Progress& progress = {},
                        bool baked_places = false);

}  // namespace rebake
