// Contrast of colours.
#include <gtest/gtest.h>

#include "editor/gui/ui/theme.h"

namespace rebake::test {
namespace {

TEST(ThemeColors, TextContrastMeetsWcag) {
  EXPECT_NEAR(contrast({0, 0, 0}, {255, 255, 255}), 21, 1e-9);
  EXPECT_NEAR(contrast({119, 119, 119}, {255, 255, 255}), 4.48, 0.01) << "a reference value of WCAG";
  for (const Theme* theme : {&dark_theme(), &light_theme()})
    for (const auto& [text, ground] : text_pairs(*theme))
      EXPECT_GE(contrast(text, ground), 4.5) << int{text.r} << "," << int{text.g} << "," << int{text.b} << " on "
                                             << int{ground.r} << "," << int{ground.g} << "," << int{ground.b};
}

}  // namespace
}  // namespace rebake::test
