#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace rebake {

// A checkpoint of a training: a line of JSON, then the state as bytes.

/// Replaces the file atomically. `head`: data by which a training recognises its own checkpoint. Throws FileError.
void write_checkpoint(const std::filesystem::path& file, const nlohmann::json& head, const std::string& state);

/// Reads a checkpoint to `head`, and returns its state; nothing if there is no file. Throws FileError for a damaged
/// one.
std::optional<std::string> read_checkpoint(const std::filesystem::path& file, nlohmann::json& head);

/// Whether a file is a checkpoint by how it begins.
bool is_checkpoint(const std::filesystem::path& file);

}  // namespace rebake
