#include "mesh_ops/formats/cameras/camera_mark.h"

#include <nlohmann/json.hpp>

#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

using nlohmann::json;

constexpr const char *software = "software", *own_name = "Rebake", *hash = "content_hash";

std::string hash_of(const json& file) {
  return hash_text(content_hash(file.dump(-1, ' ', false, json::error_handler_t::replace)));
}

}  // namespace

std::string marked_camera_text(json file) {
  file[software] = own_name;
  file[hash] = hash_of(file);
  return file.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

bool has_camera_mark(json file) {
  if (!file.is_object() || file.value(software, json()) != own_name || !file.contains(hash)) return false;
  const json written = file.at(hash);
  file.erase(hash);
  return written == hash_of(file);
}

}  // namespace rebake
