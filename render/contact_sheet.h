#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/image.h"

namespace rebake {

/// Pictures of equal size in rows of `columns`, with gaps of `gap` pixels in the colour `background` around and between
/// them. Missing pictures at the end leave background. `pictures` must not be empty.
Image contact_sheet(const std::vector<Image>& pictures, int columns, int gap,
                    const std::array<std::uint8_t, 3>& background);

}  // namespace rebake
