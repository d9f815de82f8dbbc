#pragma once

struct ImFont;

namespace rebake {

/// The window's fonts: Inter, else Noto Sans, DejaVu Sans or Dear ImGui's default font. The text font also has the
/// icons of icons.h.
struct Fonts {
  ImFont* text = nullptr;
  ImFont* heading = nullptr;
  ImFont* icons = nullptr;  ///< large icons for tool buttons
  bool have_icons = false;  ///< false: the icon font is not installed, and buttons show words
};
const Fonts& fonts();
/// Loads the fonts into the current Dear ImGui context and replaces earlier ones. `scale`: framebuffer pixels per
/// logical pixel.
void load_fonts(float scale);

}  // namespace rebake
