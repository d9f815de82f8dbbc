#include "editor/edits/deform/cage.h"

#include "editor/edits/describe.h"

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
  if (edit.moves.empty()) throw FieldError("moves", "must hold at least one move");
  const DeformSet set = deform_set(scene, edit.target);
  const Cage cage = cage_of(edit.cage, set, progress);
  const std::vector<Vec3> moved = moved_points(edit.moves, cage, edit.target.frame == CoordinateFrame::bounds);
  const auto coordinates = shared_coordinates(cage, edit.coordinates, edit.resolution, progress);
  return with_deformed(
      scene, set, edit.target.falloff,
      [&](const std::vector<Vec3>& points) { return deform_points(*coordinates, cage, moved, points, true, progress); },
      notes_on(cage, moved));
}

REBAKE_DESCRIBE_EDIT(
    CageDeform, "Deforms triangles by a cage around them: its points move, what is inside follows, colours turn along.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      CageSource::fields(edit.cage, visit);
      visit("moves", edit.moves, Need::required,
            "what moves, one after the other; boxes and spheres in world units, or in shares of the cage's box where "
            "the edit's field frame is bounds");
      visit(
          "coordinates", edit.coordinates, Need::optional,
          "mean_value: anywhere; green: keeps shapes, inside only; harmonic: around corners, not across, inside only, "
          "on a grid");
      visit("resolution", edit.resolution, Need::optional,
            "harmonic: cells of the grid along the cage's longest side, 8 to 256; finer is nearer and slower");
    })

}  // namespace rebake
