#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// A file as it is when it is read.
SourceFile source_file(const std::string& name, std::string_view bytes);

/// The bytes of a source file, if they have not changed since it was read; nothing if they have, or if it is gone.
std::optional<std::string> unchanged_bytes(const Origin& origin, const SourceFile& file);

}  // namespace rebake
