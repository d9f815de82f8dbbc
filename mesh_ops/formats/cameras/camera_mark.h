#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rebake {

/// The text of a JSON file with cameras, marked by the software's name and a hash of all other content.
std::string marked_camera_text(nlohmann::json file);

/// Whether a JSON file has that mark, and its content is as it was written.
bool has_camera_mark(nlohmann::json file);

}  // namespace rebake
