#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "mesh_ops/texture/decoder.h"

namespace rebake {

struct MlpFile {
  Decoder decoder;
  std::optional<int> obj_num;  ///< number of texture sets; absent in unsplit folders
  std::map<std::string, std::string> others =
      {};  ///< members that the format does not know: key → JSON as it was spelt
};

/// Reads mlp.json. Throws FileError for missing keys, wrong sizes, more than three layers and numbers that are not
/// finite, naming key, row and column.
MlpFile read_mlp_json(std::string_view text, const std::filesystem::path& name);

/// Writes it with the digits that a round trip needs; other members as they were spelt.
std::string write_mlp_json(const MlpFile& file);

}  // namespace rebake
