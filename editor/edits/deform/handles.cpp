#include "editor/edits/deform/handles.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/deform/handles/as_rigid_as_possible.h"

namespace rebake {

namespace {

// The vertices that are fixed or moved. Moves by numbers and boxes are applied one after another, and moved vertices
// are not fixed. Of several spheres that contain a vertex, the one with the nearest centre counts; among equally near
// ones the last, moved rather than fixed.
std::vector<ConstrainedVertex> held_vertices(const HandlesDeform& edit, const Cage& cage) {
  const bool shares = edit.target.frame == CoordinateFrame::bounds;
  const Box box = surface_box(cage);
  constexpr double any_nearer = std::numeric_limits<double>::infinity();
  struct Hold {
    Vec3 place;
    double away;  // from the centre of its sphere
  };
  std::map<std::uint32_t, Hold> held;
  const auto hold = [&](const CageMove& move, const std::vector<Vec3>& places) {
    for (const std::uint32_t v : points_of(move, cage, shares)) {
      const double away = move.sphere ? distance_from_center(move, box, shares, cage.vertices[v]) : any_nearer;
      const auto [found, first] = held.try_emplace(v, Hold{places[v], away});
      if (!first && (away <= found->second.away || !move.sphere)) found->second = {places[v], away};
    }
  };
  for (const CageMove& move : edit.fixed) hold(move, cage.vertices);
  CageMoves others;
  std::copy_if(edit.moves.begin(), edit.moves.end(), std::back_inserter(others),
               [](const CageMove& move) { return !move.sphere; });
  const std::vector<Vec3> by_others = moved_points(others, cage, shares);
  for (const CageMove& move : others) hold(move, by_others);
  for (const CageMove& move : edit.moves) {
    if (!move.sphere) continue;
    CageMoves with_sphere = others;
    with_sphere.push_back(move);
    hold(move, moved_points(with_sphere, cage, shares));
  }
  std::vector<ConstrainedVertex> places;
  for (const auto& [vertex, one] : held) places.push_back({vertex, one.place});
  return places;
}

}  // namespace

Outcome apply(const Scene& scene, const HandlesDeform& edit, const Progress& progress) {
  if (edit.iterations < 1 || edit.iterations > 1000) throw FieldError("iterations", "must lie between 1 and 1000");
  if (edit.moves.empty()) throw FieldError("moves", "must contain at least one move");
  const DeformSet set = deform_set(scene, edit.target);
  const Cage cage = cage_of(edit.cage, set, progress);
  const std::vector<ConstrainedVertex> places = held_vertices(edit, cage);
  const ConstrainedCage moved = as_rigid_as_possible(cage, places, edit.iterations, progress);
  std::vector<std::string> notes = cage_warnings(cage, moved.vertices);
  if (moved.free_components > 0)
    notes.push_back(counted(moved.free_components, "part of the cage has", "parts of the cage have") +
                    " no handle and " + (moved.free_components == 1 ? "stays" : "stay"));
  if (moved.iterations > 0)
    notes.push_back(fmt::format("rigid to a residual of {:.1g} diagonals after {} iterations{}, energy {:.3g}",
                                moved.residual, moved.iterations,
                                moved.residual > handles_residual ? "; more iterations reduce it" : "", moved.energy));
  const auto coordinates = mean_value_coordinates(cage);
  return with_deformed(
      scene, set, edit.target.falloff,
      [&](const std::vector<Vec3>& points) {
        return deform_points(*coordinates, cage, moved.vertices, points, true, progress);
      },
      notes);
}

REBAKE_DESCRIBE_EDIT(
    HandlesDeform,
    "Deforms triangles as rigidly as possible: some vertices of a cage are fixed or moved, the others "
    "follow.",
    (auto& edit, auto& visit) {
      DeformTarget::fields(edit.target, visit);
      CageSource::fields(edit.cage, visit);
      visit("moves", edit.moves, Need::required,
            "moves of cage vertices; regions are in world units, or relative to the cage's box if "
            "the edit's field frame is bounds; a vertex in several spheres follows the one with the nearest centre");
      visit("fixed", edit.fixed, Need::optional, "cage vertices that stay fixed");
      visit("iterations", edit.iterations, Need::optional,
            "maximum number, 1 to 1000; stops earlier if no vertex moves by more than a millionth of the cage's size");
    })

}  // namespace rebake
