#pragma once

#include <array>
#include <cstdint>

namespace rebake {

/// An sRGB display colour.
struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};

/// Contrast ratio of two colours (WCAG 2.1), 1 … 21. Readable text needs at least 4.5.
double contrast(Rgb a, Rgb b);

/// All colours of panels and widgets.
struct Theme {
  Rgb panel;        ///< background of panels
  Rgb field;        ///< background of text fields and lists
  Rgb raised;       ///< background of buttons
  Rgb hovered;      ///< background of widgets under the pointer
  Rgb pressed;      ///< background of pressed widgets
  Rgb border;       ///< lines between panels
  Rgb popup;        ///< background of dialogs, menus and tooltips
  Rgb text;         ///< normal text, on all of these backgrounds
  Rgb muted;        ///< secondary text, on panels, fields and popups
  Rgb accent;       ///< background of the primary button, the current tool and selected items
  Rgb on_accent;    ///< text on `accent`
  Rgb accent_text;  ///< highlighted text, on panels and popups
  Rgb danger;       ///< text of errors, on panels, popups and fields
  Rgb viewport;     ///< default background of the scene
};
const Theme& dark_theme();
const Theme& light_theme();

/// All pairs {text colour, background colour} that the window uses, for tests of contrast().
std::array<std::array<Rgb, 2>, 15> text_pairs(const Theme& theme);

/// Distances in logical pixels; px() converts them.
namespace space {
constexpr float gap = 6;                             ///< between related items
constexpr float section = 14;                        ///< between groups of items
constexpr float panel = 10;                          ///< padding of panels
constexpr float rounding = 4;                        ///< radius of corners
constexpr float text = 15, heading = 18, icon = 20;  ///< font sizes
}  // namespace space

}  // namespace rebake
