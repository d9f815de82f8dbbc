#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/select/mask_votes.h"

namespace rebake {

/// The mask of each photograph: in `folder`, named like the photograph with its folders ("left/a.png" or
/// "left/a.jpg.png"), or without them if no other photograph has the same name; without a folder, the file that the
/// camera names, relative to `base`. Empty where there is none. Throws FileError for a named mask outside `base`.
std::vector<std::filesystem::path> mask_files(const std::vector<PhotoCamera>& cameras,
                                              const std::filesystem::path& base, const std::filesystem::path& folder);

/// Reads a mask: the first channel of an image with 8 bits. Throws FileError.
LabelImage read_mask(const std::filesystem::path& file);

}  // namespace rebake
