#include <cmath>
#include <cstring>
#include <numbers>

#include "editor/studies/dprt/animated_object.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/simulation/cloth.h"

namespace rebake {

namespace {

// Changes when the simulation or its settings do: files of earlier versions are then made again.
constexpr std::uint64_t cloth_version = 1;

}  // namespace

AnimatedObject animated_cloth(int frames, const Progress& progress) {
  const SheetOptions options{.side = 49, .stretching = 1e-6, .shearing = 2e-6, .bending = 3e-5};
  Cloth cloth = hanging_sheet(options);
  // Held at two corners, which come together and apart and sway.
  constexpr std::size_t rings = 2;
  std::vector<Vec3> at_rest;
  for (std::size_t k = 0; k < rings; ++k) {
    const std::size_t point = k * static_cast<std::size_t>(options.side - 1) / (rings - 1);
    cloth.masses[point] = 0;
    at_rest.push_back(cloth.positions[point]);
  }
  cloth.drag = 1.5;
  cloth.wind = [](const Vec3& place, double time) {
    const double gust = std::sin(1.1 * time) + 0.5 * std::sin(1.9 * time + 1.5 * place.x());
    return Vec3(0.3 * std::sin(0.9 * time), 0, 0.7 * gust);
  };
  AnimatedObject object{"cloth", {cloth.positions, {}}, {}};
  const auto side = static_cast<std::uint32_t>(options.side);
  for (std::uint32_t row = 0; row + 1 < side; ++row)
    for (std::uint32_t column = 0; column + 1 < side; ++column) {
      const std::uint32_t a = row * side + column, b = a + side;
      object.rest.faces.push_back({a, b, b + 1});
      object.rest.faces.push_back({a, b + 1, a + 1});
    }
  if (frames == 0) return object;  // the shape at rest takes no time
  constexpr double rate = 30;      // frames per second
  constexpr int settling = 60;     // frames before the first one
  for (int frame = -settling; frame < frames; ++frame) {
    progress.at("simulating the cloth", static_cast<double>(frame + settling) / (frames + settling));
    const double time = (frame + settling) / rate, ease = std::min(1.0, time / 2);
    const double narrower = 1 - ease * (0.13 + 0.09 * std::sin(0.7 * time));
    std::vector<Vec3> held;
    for (std::size_t k = 0; k < rings; ++k) {
      const double forth = k % 2 == 0 ? 1 : -1;
      held.push_back(Vec3(narrower * at_rest[k].x(), at_rest[k].y(),
                          ease * (0.03 * forth + 0.08 * std::sin(1.3 * time + 0.8 * static_cast<double>(k)))));
    }
    cloth.advance(1 / rate, 30, &held);
    if (frame >= 0) object.frames.push_back(cloth.positions);
  }
  return object;
}

AnimatedObject cached_cloth(int frames, const std::filesystem::path& file, const Progress& progress) {
  AnimatedObject object = animated_cloth(0);
  const std::size_t points = object.rest.vertices.size(), values = 3 * points * static_cast<std::size_t>(frames);
  std::array<std::uint64_t, 3> head{cloth_version, points, static_cast<std::uint64_t>(frames)};
  std::error_code error;
  // Links to other files are removed, so that those are not written to.
  if (std::filesystem::is_symlink(file, error)) std::filesystem::remove(file);
  const std::size_t size = sizeof head + values * sizeof(double);
  if (std::filesystem::is_regular_file(file, error) &&
      std::filesystem::file_size(file, error) == size + sizeof(std::uint64_t)) {
    const std::string bytes = read_file(file);
    std::uint64_t hash = 0;
    std::memcpy(&hash, bytes.data() + size, sizeof hash);
    if (std::memcmp(bytes.data(), head.data(), sizeof head) == 0 &&
        content_hash(std::string_view(bytes).substr(0, size)) == hash) {
      object.frames.assign(static_cast<std::size_t>(frames), std::vector<Vec3>(points));
      const char* at = bytes.data() + sizeof head;
      for (std::vector<Vec3>& frame : object.frames)
        for (Vec3& place : frame) {
          std::memcpy(place.data(), at, 3 * sizeof(double));
          at += 3 * sizeof(double);
        }
      return object;
    }
  }
  object = animated_cloth(frames, progress);
  std::string bytes(reinterpret_cast<const char*>(head.data()), sizeof head);
  for (const std::vector<Vec3>& frame : object.frames)
    for (const Vec3& place : frame) bytes.append(reinterpret_cast<const char*>(place.data()), 3 * sizeof(double));
  const std::uint64_t hash = content_hash(bytes);
  bytes.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  write_file_atomically(file, bytes, {});
  return object;
}

}  // namespace rebake
