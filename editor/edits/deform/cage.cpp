#include "editor/edits/deform/cage.h"

#include <fmt/format.h>

#include <map>

#include "editor/edits/describe_edit.h"
#include "editor/edits/scene_change.h"

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

namespace {

bool translates_only(const CageMove& move) {
  return move.rotate.quaternion().isApprox(Eigen::Quaterniond::Identity(), 0) && move.scale.value == Vec3::Ones();
}

// Number of cage points whose translation differs from that in `replaced` (if not null). 0 if an edit does not list its
// points by number, moves one of them twice, or rotates or scales them.
std::size_t moved_points(const CageDeform& edit, const CageDeform* replaced) {
  std::map<std::uint64_t, Vec3> motions, known;
  const auto collect = [](const CageDeform& from, std::map<std::uint64_t, Vec3>& into) {
    for (const CageMove& move : from.moves) {
      if (move.points.ranges.empty() || !translates_only(move)) return false;
      for (const auto& [first, last] : move.points.ranges)
        for (std::uint64_t k = first; k <= last; ++k)
          if (!into.emplace(k, move.translate).second) return false;
    }
    std::erase_if(into, [](const auto& motion) { return motion.second.isZero(0); });
    return true;
  };
  if (!collect(edit, motions) || (replaced != nullptr && !collect(*replaced, known))) return 0;
  std::size_t moved = 0;
  for (const auto& [k, motion] : motions) moved += !known.contains(k) || known.at(k) != motion ? 1 : 0;
  for (const auto& [k, motion] : known) moved += motions.contains(k) ? 0 : 1;
  return moved;
}

}  // namespace

std::string change_title(const CageDeform& edit, const SceneChange& change, const CageDeform* replaced) {
  const std::size_t moved = moved_points(edit, replaced);
  if (moved == 0 || change.moved == 0) return "";
  return fmt::format("Moved {} cage point{} of {}", moved, moved == 1 ? "" : "s", listed(change.with_moved));
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
