#include "editor/training/checkpoint.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr const char* mark = "Rebake training";
constexpr int version = 1;

}  // namespace

void write_checkpoint(const fs::path& file, const nlohmann::json& head, const std::string& state) {
  const nlohmann::json line = {{"checkpoint", mark},
                               {"version", version},
                               {"head", head},
                               {"hash", hash_text(content_hash(head.dump() + state))}};
  write_file_atomically(file, line.dump() + "\n" + state, {});
}

std::optional<std::string> read_checkpoint(const fs::path& file, nlohmann::json& head) {
  std::error_code error;
  if (!fs::exists(file, error)) return std::nullopt;
  std::string bytes = read_file(file);
  const std::size_t end = bytes.find('\n');
  const auto damaged = [&](const std::string& why) {
    return FileError(file, why + "; start again with fresh (--fresh)");
  };
  nlohmann::json line;
  if (end != std::string::npos)
    line = nlohmann::json::parse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end), nullptr, false);
  if (!line.is_object() || !line.contains("checkpoint") || line["checkpoint"] != mark)
    throw damaged("is no checkpoint of a training");
  if (!line.contains("version") || line["version"] != version)
    throw damaged("is a checkpoint of another version of Rebake");
  bytes.erase(0, end + 1);
  if (!line.contains("head") || !line.contains("hash") ||
      line["hash"] != hash_text(content_hash(line["head"].dump() + bytes)))
    throw damaged("is damaged");
  head = line["head"];
  return bytes;
}

bool is_checkpoint(const fs::path& file) {
  const std::string begins = fmt::format("{{\"checkpoint\":\"{}\"", mark);
  std::string read(begins.size(), ' ');
  std::ifstream in(file, std::ios::binary);
  return static_cast<bool>(in.read(read.data(), static_cast<std::streamsize>(read.size()))) && read == begins;
}

}  // namespace rebake
