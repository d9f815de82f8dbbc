#include "mesh_ops/deform/cage_coordinates/coordinates.h"

#include <algorithm>
#include <mutex>

namespace rebake {

namespace {

// Entry of the cache of shared_coordinates(): coordinates that some caller holds, and the inputs they were computed
// from.
struct Held {
  Cage cage;
  CageCoordinates kind;
  int resolution;
  std::weak_ptr<const Coordinates> coordinates;

  bool of(const Cage& other, CageCoordinates other_kind, int other_resolution) const {
    return kind == other_kind && (kind != CageCoordinates::harmonic || resolution == other_resolution) &&
           cage.faces == other.faces && cage.vertices == other.vertices;
  }
};

}  // namespace

std::vector<Vec3> Coordinates::row_motions(const Cage& rest, const std::vector<Vec3>& moved) const {
  std::vector<Vec3> motions(rows_, Vec3(0, 0, 0));
  const std::vector<std::uint8_t> used = used_vertices(rest);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v)
    if (used[v] != 0) motions[v] = moved[v] - rest.vertices[v];
  return motions;
}

std::unique_ptr<Coordinates> coordinates_of(const Cage& cage, CageCoordinates kind, int resolution,
                                            const Progress& progress) {
  switch (kind) {
    case CageCoordinates::green:
      return green_coordinates(cage);
    case CageCoordinates::harmonic:
      return harmonic_coordinates(cage, resolution, progress);
    default:
      return mean_value_coordinates(cage);
  }
}

std::shared_ptr<const Coordinates> shared_coordinates(const Cage& cage, CageCoordinates kind, int resolution,
                                                      const Progress& progress) {
  static std::mutex mutex;
  static std::vector<Held> held;
  {
    const std::scoped_lock lock(mutex);
    std::erase_if(held, [](const Held& one) { return one.coordinates.expired(); });
    for (const Held& one : held)
      if (one.of(cage, kind, resolution))
        if (auto coordinates = one.coordinates.lock()) return coordinates;
  }
  std::shared_ptr<const Coordinates> made = coordinates_of(cage, kind, resolution, progress);
  const std::scoped_lock lock(mutex);
  held.push_back({cage, kind, resolution, made});
  return made;
}

}  // namespace rebake
