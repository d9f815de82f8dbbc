#include "editor/gui/ui/theme.h"

#include <algorithm>
#include <cmath>

namespace rebake {

namespace {

double luminance(Rgb color) {
  const auto linear = [](std::uint8_t byte) {
    const double value = byte / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.r) + 0.7152 * linear(color.g) + 0.0722 * linear(color.b);
}

}  // namespace

double contrast(Rgb a, Rgb b) {
  const double one = luminance(a), other = luminance(b);
  return (std::max(one, other) + 0.05) / (std::min(one, other) + 0.05);
}

const Theme& dark_theme() {
  static const Theme theme = {
      .panel = {32, 33, 36},
      .field = {23, 24, 26},
      .raised = {48, 50, 54},
      .hovered = {60, 63, 68},
      .pressed = {72, 76, 82},
      .border = {17, 18, 19},
      .popup = {41, 42, 46},
      .text = {232, 234, 237},
      .muted = {168, 173, 180},
      .accent = {41, 105, 204},
      .on_accent = {255, 255, 255},
      .accent_text = {122, 178, 255},
      .danger = {255, 138, 128},
      .viewport = {46, 48, 51},
  };
  return theme;
}

const Theme& light_theme() {
  static const Theme theme = {
      .panel = {243, 244, 246},
      .field = {255, 255, 255},
      .raised = {226, 229, 233},
      .hovered = {212, 216, 222},
      .pressed = {197, 202, 210},
      .border = {203, 207, 213},
      .popup = {252, 252, 253},
      .text = {28, 30, 33},
      .muted = {82, 88, 97},
      .accent = {33, 94, 190},
      .on_accent = {255, 255, 255},
      .accent_text = {24, 80, 170},
      .danger = {176, 32, 32},
      .viewport = {58, 60, 64},
  };
  return theme;
}

std::array<std::array<Rgb, 2>, 15> text_pairs(const Theme& theme) {
  return {{{theme.text, theme.panel},
           {theme.text, theme.field},
           {theme.text, theme.raised},
           {theme.text, theme.hovered},
           {theme.text, theme.pressed},
           {theme.text, theme.popup},
           {theme.muted, theme.panel},
           {theme.muted, theme.field},
           {theme.muted, theme.popup},
           {theme.on_accent, theme.accent},
           {theme.accent_text, theme.panel},
           {theme.accent_text, theme.popup},
           {theme.danger, theme.panel},
           {theme.danger, theme.popup},
           {theme.danger, theme.field}}};
}

}  // namespace rebake
