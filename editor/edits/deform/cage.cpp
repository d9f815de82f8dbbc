#include "editor/edits/deform/cage.h"

#include "editor/edits/describe_edit.h"

namespace rebake {

namespace {
constexpr const char* coordinate_names[] = {"mean_value", "green", "harmonic"};
}

FieldType Codec<CageCoordinates>::type() {
  return choice_type({std::begin(coordinate_names), std::end(coordinate_names)});
}
CageCoordinates Codec<CageCoordinates>::read(const nlohmann::json& value, const Scene&) {
  if (value.is_string())
    for (int k = 0; k < 3; ++k)
      if (value.get<std::string>() == coordinate_names[k]) return static_cast<CageCoordinates>(k);
  throw Error("must be mean_value, green or harmonic");
}
nlohmann::json Codec<CageCoordinates>::write(const CageCoordinates& value) {
  return coordinate_names[static_cast<int>(value)];
}

Outcome apply(const Scene& scene, const CageDeform& edit, const Progress& progress) {
  if (edit.moves.empty()) throw FieldError("moves", "must contain at least one move");
  const DeformSet set = deform_set(scene, edit.target);
  const Cage cage = cage_of(edit.cage, set, progress);
  const std::vector<Vec3> moved = moved_points(edit.moves, cage, edit.target.frame == CoordinateFrame::bounds);
  const auto coordinates = shared_coordinates(cage, edit.coordinates, edit.resolution, progress);
  return with_deformed(
      scene, set, edit.target.falloff,
      [&](const std::vector<Vec3>& points) { return deform_points(*coordinates, cage, moved, points, true, progress); },
      cage_warnings(cage, moved));
}

REBAKE_DESCRIBE_EDIT(
    CageDeform,
    "Deforms triangles by a cage: moving its vertices deforms the inside; view-dependent colours rotate along.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      CageSource::fields(edit.cage, visit);
      visit("moves", edit.moves, Need::required,
            "moves of cage vertices, applied in order; regions are in world units, or relative to the cage's box if "
            "the edit's field frame is bounds");
      visit("coordinates", edit.coordinates, Need::optional,
            "mean_value: everywhere; green: conformal, inside only; harmonic: follows the cage's shape, inside only, "
            "solved on a grid");
      visit("resolution", edit.resolution, Need::optional,
            "harmonic: grid cells along the cage's longest side, 8 to 256; finer is more accurate and slower");
    })

}  // namespace rebake
