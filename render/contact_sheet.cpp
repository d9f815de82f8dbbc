#include "render/contact_sheet.h"

#include <algorithm>
#include <cstring>

namespace rebake {

Image contact_sheet(const std::vector<Image>& pictures, int columns, int gap,
                    const std::array<std::uint8_t, 3>& background) {
  const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
  const int width = pictures.front().width, height = pictures.front().height;
  Image sheet{columns * (width + gap) + gap, rows * (height + gap) + gap, {}, {}};
  const auto row_bytes = static_cast<std::size_t>(sheet.width) * 3;
  sheet.rgb.resize(row_bytes * static_cast<std::size_t>(sheet.height));
  for (std::size_t p = 0; p < sheet.rgb.size(); p += 3) std::copy(background.begin(), background.end(), &sheet.rgb[p]);
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    const int left = gap + static_cast<int>(k) % columns * (width + gap),
              top = gap + static_cast<int>(k) / columns * (height + gap);
    const auto bytes = static_cast<std::size_t>(width) * 3;
    for (int y = 0; y < height; ++y)
      std::memcpy(&sheet.rgb[static_cast<std::size_t>(top + y) * row_bytes + static_cast<std::size_t>(left) * 3],
                  &pictures[k].rgb[static_cast<std::size_t>(y) * bytes], bytes);
  }
  return sheet;
}

}  // namespace rebake
