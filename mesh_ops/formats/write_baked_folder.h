#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/files.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/object.h"

namespace rebake {

/// The side in texels that new textures may have: the one that the layout's viewers usually take, or that of the
/// largest texture of `objects`, which their viewers took already.
int largest_page_side(Layout layout, std::span<const BakedObject* const> objects);

/// Writes one object below `folder` (relative, may be empty) of an atomic folder: in object space, in `layout`. What is
/// still as it was read is copied and hash-checked, whatever its size; edited sets drop texels that nobody uses, into
/// textures of at most `page_side` texels a side (left out: largest_page_side). A given `page_side` also lays sets out
/// again that are larger. Turned triangles are kept
/// in turns.bin, and with `baked_places` where triangles were when their light was baked in baked.bin: only Rebake
/// reads these; then texels that nobody uses are kept, since light has it by texels what was erased. Appends sentences
/// for people to `notes`.
void write_baked_folder(AtomicFolder& out, const std::filesystem::path& folder, const BakedObject& object,
                        Layout layout, std::vector<std::string>& notes, const Progress& progress = {},
                        bool baked_places = false, std::optional<int> page_side = std::nullopt);

}  // namespace rebake
