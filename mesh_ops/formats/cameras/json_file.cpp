#include "mesh_ops/formats/cameras/json_file.h"

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

nlohmann::json read_json_object(const std::filesystem::path& path) {
  nlohmann::json read;
  try {
    read = nlohmann::json::parse(read_file(path));
  } catch (const nlohmann::json::exception& error) {
    throw FileError(path, std::string("is not valid JSON: ") + error.what());
  }
  if (!read.is_object()) throw FileError(path, "is not a JSON object");
  return read;
}

}  // namespace rebake
