#include "editor/edits/handles.h"

#include <fmt/format.h>

#include <map>

#include "mesh_ops/deform/handles.h"

namespace rebake {

Scene apply(const Scene& scene, const HandlesDeform& edit, const Progress& progress) {
  if (edit.iterations < 1 || edit.iterations > 1000) throw FieldError("iterations", "must lie between 1 and 1000");
  if (edit.moves.empty()) throw FieldError("moves", "must hold at least one move");
  const DeformSet set = deform_set(scene, edit.target);
  const Cage cage = cage_of(edit.cage, set, progress);
  const bool shares = edit.target.frame == CoordinateFrame::bounds;
  const std::vector<Vec3> asked = moved_points(edit.moves, cage, shares);
  std::map<std::uint32_t, Vec3> held;
  for (const CageMove& move : edit.fixed)
    for (const std::uint32_t v : points_of(move, cage, shares)) held.insert_or_assign(v, cage.vertices[v]);
  for (const CageMove& move : edit.moves)
    for (const std::uint32_t v : points_of(move, cage, shares)) held.insert_or_assign(v, asked[v]);
  std::vector<HandledVertex> places;
  for (const auto& [vertex, place] : held) places.push_back({vertex, place});
  const HandledCage moved = as_rigid_as_possible(cage, places, edit.iterations);
  std::vector<std::string> notes = notes_on(cage, moved.vertices);
  if (moved.free_components > 0)
    notes.push_back(fmt::format("{} parts of the cage hold no point and stay", moved.free_components));
  const auto coordinates = mean_value_coordinates(cage);
  return with_deformed(
      scene, set, edit.target.falloff,
      [&](const std::vector<Vec3>& points) {
        return deform_points(*coordinates, cage, moved.vertices, points, true, progress);
      },
      notes);
}

}  // namespace rebake
