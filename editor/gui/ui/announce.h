#pragma once

#include <imgui.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rebake {

/// Tells other programs what the window shows, so that they need not guess from pixels or clocks: with REBAKE_ANNOUNCE
/// set to a named pipe, a line of JSON is written there for every frame that differs from the one before
/// (tests/gui/README.md). Without it, nothing here does anything.
namespace announce {

bool on();
/// Where something can be clicked: the last item of Dear ImGui. Names are those of the present parts, then `name`.
void item(const std::string& name);
/// The same for a point of the picture, in the window's pixels.
void point(const std::string& name, const ImVec2& at);
/// A part of the window: what is announced while this lives begins with its name and a slash.
class Part {
 public:
  explicit Part(const std::string& name);
  ~Part();
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;
};
/// Writes what was announced since the last call, joined with `state`, where it differs from the last.
void frame(const nlohmann::json& state);

}  // namespace announce

}  // namespace rebake
