#pragma once

struct ImFont;

namespace rebake {

/// The window's fonts: Inter, with the signs of icons.h among its letters; where Debian's packages are not there, what
/// there is.
struct Fonts {
  ImFont* text = nullptr;
  ImFont* heading = nullptr;
  ImFont* icons = nullptr;  ///< larger signs, for buttons of tools
  bool have_icons = false;  ///< else buttons show words
};
const Fonts& fonts();
/// Into the present Dear ImGui context, in place of those that were there. `scale`: pixels of the screen a pixel of a
/// plain one.
void load_fonts(float scale);

}  // namespace rebake
