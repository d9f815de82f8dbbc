#pragma once

#include <imgui.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rebake {

/// Reports the window's state to test programs (tests/gui/README.md). If the environment variable REBAKE_ANNOUNCE names
/// a named pipe, one line of JSON is written to it for every frame that differs from the previous one. Otherwise all
/// functions here do nothing.
namespace announce {

/// Whether reports are written.
bool on();
/// Reports the rectangle of the last Dear ImGui item, if visible, as "part/part/name" in window pixels.
void item(const std::string& name);
/// Reports a point in window pixels, as item() does, with size 0.
void point(const std::string& name, const ImVec2& at);
/// RAII prefix: while an instance exists, reported names start with its name and a slash.
class Part {
 public:
  explicit Part(const std::string& name);
  ~Part();
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
};
/// Writes `state` and the items reported since the previous call, unless the line equals the previous one.
void frame(const nlohmann::json& state);

}  // namespace announce

}  // namespace rebake
