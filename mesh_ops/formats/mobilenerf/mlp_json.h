#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/texture/decoder.h"

namespace rebake {

/// Contents of mlp.json.
struct MlpFile {
  Decoder decoder;
  std::optional<int> obj_num;  ///< number of texture sets; empty for unsplit folders
  /// Unknown members of the file: key → JSON text as spelt.
  std::map<std::string, std::string> others = {};
  std::vector<std::string> assumptions = {};  ///< sentences about skipped parts
  bool needs_repair = false;                  ///< other programs cannot read the file
};

/// Reads mlp.json, also with commas after last elements. Throws FileError, naming key, row and column, for missing
/// keys, wrong shapes, more than three layers and numbers that are not finite as 32-bit floats.
MlpFile read_mlp_json(std::string_view text, const std::filesystem::path& name);

/// Writes mlp.json with the digits that a round trip of doubles needs; other members as spelt.
std::string write_mlp_json(const MlpFile& file);

}  // namespace rebake
