#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace rebake {

/// Reads a JSON object from a file. Throws FileError.
nlohmann::json read_json_object(const std::filesystem::path& path);

}  // namespace rebake
