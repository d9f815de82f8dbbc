#include "mesh_ops/deform/deform_positions.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh_ops/base/polar.h"
#include "mesh_ops/deform/falloff.h"
#include "mesh_ops/index/opacity.h"

namespace rebake {

FlaggedPositions flagged_positions(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                                   const TriangleSet& flags) {
  FlaggedPositions places;
  places.number_of.assign(corners.place_count, FlaggedPositions::none);
  places.shared.assign(corners.place_count, 0);
  std::size_t triangle = 0;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t place = corners.places[triangle * 3 + k];
        if (flags[triangle] == 0) {
          places.shared[place] = 1;
        } else if (places.number_of[place] == FlaggedPositions::none) {
          places.number_of[place] = static_cast<std::uint32_t>(places.world.size());
          places.world.push_back(to_world * set.soup.positions()[face[k]]);
        }
      }
      ++triangle;
    }
  return places;
}

DeformedPositions deform_positions(const BakedObject& object, const WeldedCorners& corners, const Affine& to_world,
                                   const TriangleSet& flags, const FlaggedPositions& places, double falloff,
                                   const SpaceDeformation& deformation) {
  const std::vector<Vec3>& world = places.world;
  const std::size_t count = world.size();
  DeformedPoints moved = deformation(world);
  if (falloff > 0) fade_out(world, border_of(corners, flags, places), falloff, moved);

  DeformedPositions result;
  DeformationReport& report = result.report;
  report.points = count;
  // Rotations are stored in object space and must be orthogonal. The transform is split into `scales` · `frame`, and
  // only the orthogonal factor changes the space of a rotation.
  const Mat3 frame = orthogonal_factor(to_world.linear());
  const Mat3 scales = to_world.linear() * frame.transpose();
  std::vector<Mat3>& rotations = result.rotations;
  rotations.assign(count, Mat3::Identity());
  std::vector<double>& determinants = result.determinants;
  determinants.assign(count, 1);
  std::vector<std::uint8_t> defined(count, 1), is_number(count, 1), changed(count, 0);
  constexpr double rounding = 1e-13;  // of rotations between frames
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (!world[i].allFinite() || !moved.points[i].allFinite() || !moved.jacobians[i].allFinite()) {
      moved.points[i] = world[i];
      is_number[i] = 0;
      return;
    }
    determinants[i] = moved.jacobians[i].determinant();
    if (moved.points[i] == world[i] && moved.jacobians[i].isIdentity(0)) return;
    const LocalRotation local = local_orthogonal(moved.jacobians[i] * scales);
    defined[i] = local.defined ? 1 : 0;
    rotations[i] = frame.transpose() * local.rotation * frame;
    changed[i] = moved.points[i] != world[i] || !rotations[i].isIdentity(rounding) ? 1 : 0;
  });
  if (std::any_of(moved.outside.begin(), moved.outside.end(), [](auto flag) { return flag != 0; })) {
    std::vector<std::uint8_t> shows(count, 0);
    std::size_t t = 0;
    for (const TextureSet& set : object.sets)
      for (const std::uint8_t opaque : faces_with_opaque_texels(set)) {
        if (flags[t] != 0 && opaque != 0)
          for (std::size_t k = 0; k < 3; ++k) shows[places.number_of[corners.places[t * 3 + k]]] = 1;
        ++t;
      }
    for (std::size_t i = 0; i < count; ++i) report.opaque_outside += shows[i] & moved.outside[i];
  }
  bool any = false;  // any finite place so far
  for (std::size_t i = 0; i < count; ++i) {
    report.changed += changed[i];
    report.not_finite += is_number[i] != 0 ? 0 : 1;
    report.outside += !moved.outside.empty() && moved.outside[i] != 0 ? 1 : 0;
    report.folded += determinants[i] <= 0 ? 1 : 0;
    report.undefined += defined[i] == 0 ? 1 : 0;
    if (is_number[i] == 0) continue;
    report.min_determinant = any ? std::min(report.min_determinant, determinants[i]) : determinants[i];
    any = true;
  }
  // Places without a unique nearest rotation take a neighbour's: breadth-first from the places that have one.
  if (report.undefined > 0) {
    std::vector<std::vector<std::uint32_t>> beside(count);
    for (std::size_t t = 0; t < flags.size(); ++t) {
      if (flags[t] == 0) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = places.number_of[corners.places[t * 3 + k]],
                            b = places.number_of[corners.places[t * 3 + (k + 1) % 3]];
        if (defined[a] != 0 && defined[b] != 0) continue;
        beside[a].push_back(b);
        beside[b].push_back(a);
      }
    }
    std::vector<std::uint32_t> next;
    for (std::uint32_t i = 0; i < count; ++i)
      if (defined[i] != 0 && !beside[i].empty()) next.push_back(i);
    for (std::size_t at = 0; at < next.size(); ++at)
      for (const std::uint32_t i : beside[next[at]]) {
        if (defined[i] != 0) continue;
        rotations[i] = rotations[next[at]];
        defined[i] = 1;
        next.push_back(i);
      }
  }
  result.world = std::move(moved.points);
  return result;
}

}  // namespace rebake
