#pragma once

#include <array>
#include <cstdint>

namespace rebake {

/// A display colour.
struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};

/// WCAG 2.1's contrast of two colours, 1 … 21. Text wants 4.5 at least.
double contrast(Rgb a, Rgb b);

/// Every colour of the window. Whatever is drawn takes its colours from here.
struct Theme {
  Rgb panel;        ///< behind everything
  Rgb field;        ///< what can be typed into, and lists
  Rgb raised;       ///< buttons at rest
  Rgb hovered;      ///< under the pointer
  Rgb pressed;      ///< held
  Rgb border;       ///< between panels
  Rgb popup;        ///< dialogs, menus, tooltips
  Rgb text;         ///< on all of the above
  Rgb muted;        ///< text that explains
  Rgb accent;       ///< the one primary action, the tool in hand, what is chosen
  Rgb on_accent;    ///< text on it
  Rgb accent_text;  ///< text that leads somewhere, on panel and popup
  Rgb danger;       ///< text that says what failed, on panel and popup
  Rgb viewport;     ///< behind the scene
};
const Theme& dark_theme();
const Theme& light_theme();

/// Where text stands on what, of a theme: pairs whose contrast must suffice.
std::array<std::array<Rgb, 2>, 15> text_pairs(const Theme& theme);

/// Distances in pixels of a plain screen.
namespace space {
constexpr float gap = 6;                             ///< between things that belong together
constexpr float section = 14;                        ///< between groups
constexpr float panel = 10;                          ///< inside a panel's edge
constexpr float rounding = 4;                        ///< of corners
constexpr float text = 15, heading = 18, icon = 20;  ///< heights of fonts
}  // namespace space

}  // namespace rebake
