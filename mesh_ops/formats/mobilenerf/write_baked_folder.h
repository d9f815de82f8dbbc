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

/// Largest side of new textures, in texels: the usual limit of the layout's viewers, or the side of the largest texture
/// of `objects`, which their viewers already accept.
int largest_page_side(Layout layout, std::span<const BakedObject* const> objects);

/// Writes one object, in object space and in `layout`, below `folder` (relative, may be empty) of an atomic folder.
/// Unchanged parts are copied from the source files after checking their hashes, whatever their size. Edited sets are
/// repacked without unused texels if that saves texels, into textures of at most `page_side` texels per side (default:
/// largest_page_side()). A given `page_side` also repacks larger sets.
/// Rotations of triangles are written to turns.bin. With `baked_places`, baked.bin gets the positions on which light
/// was baked; unused texels then stay, since lighting finds erased triangles by their texels. Only Rebake reads
/// these two files. Appends sentences for the user to `notes`. Throws Error if the object has no triangles, or if an
/// unsplit folder needs more than one texture.
void write_baked_folder(AtomicFolder& out, const std::filesystem::path& folder, const BakedObject& made, Layout layout,
                        std::vector<std::string>& notes, const Progress& progress = {}, bool baked_places = false,
                        std::optional<int> page_side = std::nullopt);

/// The object as scene.json needs it, which does not record dialects: as published, or with plain alpha where the
/// decoder has another rule, which mlp.json records.
BakedObject published(BakedObject object);

}  // namespace rebake
