#include "tests/support/light_pictures.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/picture_files.h"

namespace rebake::test {

void write_light_picture(const std::filesystem::path& path, int width,
                         const std::function<Radiance(const Vec3&)>& radiance) {
  using std::numbers::pi;
  const int height = width / 2;
  std::vector<float> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double height_angle = pi / 2 - (y + 0.5) / height * pi, heading = (x + 0.5) / width * 2 * pi - pi;
      const Vec3 forward(0, 0, -1), right(1, 0, 0), up(0, 1, 0);
      const Vec3 level = std::cos(heading) * forward + std::sin(heading) * right;
      for (const double c : radiance(std::cos(height_angle) * level + std::sin(height_angle) * up))
        pixels.push_back(static_cast<float>(c));
    }
  write_picture(path, {width, height, 3, path.extension() == ".exr" ? "float" : "uint8"}, pixels);
}

}  // namespace rebake::test
