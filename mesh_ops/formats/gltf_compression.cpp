#include "mesh_ops/formats/gltf_compression.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh_ops/base/error.h"

namespace rebake {

GltfCompression gltf_compression(const std::vector<std::string>& words) {
  GltfCompression result;
  for (const std::string& word : words) {
    if (word == "quantized")
      result.quantized = true;
    else if (word == "meshopt")
      result.meshopt = true;
    else if (word == "webp")
      result.webp = true;
    else
      throw FieldError("compress", fmt::format("\"{}\" is not known; use quantized, meshopt and webp", word));
  }
  return result;
}

QuantizedPositions quantized_positions(const std::vector<Vec3>& positions) {
  constexpr int largest = 32767;
  QuantizedPositions result;
  double scale = 0;
  for (const Vec3& p : positions) scale = std::max(scale, p.cwiseAbs().maxCoeff());
  if (scale > 0) result.scale = scale;
  result.least.fill(largest);
  result.most.fill(-largest);
  for (const Vec3& p : positions) {
    auto& value = result.values.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto step = static_cast<int>(std::lround(p[static_cast<Eigen::Index>(axis)] / result.scale * largest));
      value[axis] = static_cast<std::int16_t>(step);
      result.least[axis] = std::min(result.least[axis], step);
      result.most[axis] = std::max(result.most[axis], step);
    }
  }
  return result;
}

std::vector<std::array<std::uint16_t, 2>> quantized_uvs(const std::vector<Vec2>& uvs) {
  constexpr double largest = 65535;
  std::vector<std::array<std::uint16_t, 2>> result;
  for (const Vec2& uv : uvs) {
    if (!(uv.x() >= 0 && uv.x() <= 1 && uv.y() >= 0 && uv.y() <= 1)) return {};
    result.push_back({static_cast<std::uint16_t>(std::lround(uv.x() * largest)),
                      static_cast<std::uint16_t>(std::lround((1 - uv.y()) * largest))});
  }
  return result;
}

}  // namespace rebake
