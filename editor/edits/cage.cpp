#include "editor/edits/cage.h"

namespace rebake {

namespace {
constexpr const char* coordinate_names[] = {"mean_value", "green", "harmonic"};
}

const char* Codec<CageCoordinates>::type() { return "mean_value, green or harmonic"; }
CageCoordinates Codec<CageCoordinates>::read(const nlohmann::json& value, const Scene&) {
  if (value.is_string())
    for (int k = 0; k < 3; ++k)
      if (value.get<std::string>() == coordinate_names[k]) return static_cast<CageCoordinates>(k);
  throw Error("must be mean_value, green or harmonic");
}
nlohmann::json Codec<CageCoordinates>::write(CageCoordinates value) {
  return coordinate_names[static_cast<int>(value)];
}

Scene apply(const Scene& scene, const CageDeform& edit, const Progress& progress) {
  if (edit.moves.empty()) throw FieldError("moves", "must hold at least one move");
  const DeformSet set = deform_set(scene, edit.target);
  const Cage cage = cage_of(edit.cage, set, progress);
  const std::vector<Vec3> moved = moved_points(edit.moves, cage, edit.target.frame == CoordinateFrame::bounds);
  const auto coordinates = coordinates_of(cage, edit.coordinates, edit.resolution, progress);
  return with_deformed(
      scene, set, edit.target.falloff,
      [&](const std::vector<Vec3>& points) { return deform_points(*coordinates, cage, moved, points, true, progress); },
      notes_on(cage, moved));
}

}  // namespace rebake
