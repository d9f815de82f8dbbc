#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "mesh_ops/texture/decoder.h"

namespace rebake {

struct MlpFile {
  Decoder decoder;
  std::optional<int> obj_num;  ///< number of texture sets; absent in unsplit folders
};

/// Reads mlp.json. Throws FileError for missing keys, wrong sizes and numbers that are not finite.
MlpFile read_mlp_json(std::string_view text, const std::filesystem::path& name);

/// Writes it with the digits that a round trip needs.
std::string write_mlp_json(const MlpFile& file);

}  // namespace rebake
