#include "editor/gui/tools/falloff_overlay.h"

#include <algorithm>
#include <cmath>

#include "editor/edits/deform/deforming.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/deform/deform_positions.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

// Limit for all triangles of objects with a selection, since the search for the border visits all of them.
constexpr std::size_t max_triangles = 100000;

void add(const PlacedNode& placed, const TriangleSet& flags, double falloff, std::vector<Guides::Triangle>& triangles) {
  const BakedObject& object = *placed.node->object;
  const auto corners = corners_of(object);
  const FlaggedPositions places = flagged_positions(object, *corners, placed.to_world, flags);
  // Translate everything by `size` along x: a place's motion divided by `size` is its falloff weight.
  const double size = transformed(object.bounds(), placed.to_world).diagonal().norm();
  if (!(size > 0) || !std::isfinite(size)) return;
  const DeformedPositions moved =
      deform_positions(object, *corners, placed.to_world, flags, places, falloff, [&](const std::vector<Vec3>& world) {
        DeformedPoints all{world, std::vector<Mat3>(world.size(), Mat3::Identity()), {}};
        for (Vec3& p : all.points) p.x() += size;
        return all;
      });
  for (std::size_t t = 0; t < flags.size(); ++t) {
    if (flags[t] == 0) continue;
    Guides::Triangle triangle;
    double least = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t i = places.number_of[corners->places[t * 3 + k]];
      const double share = std::clamp((moved.world[i].x() - places.world[i].x()) / size, 0.0, 1.0);
      triangle.corners[k] = places.world[i];
      triangle.opacity[k] = 0.75 * (1 - share);
      least = std::min(least, share);
    }
    if (least < 1) triangles.push_back(triangle);
  }
}

}  // namespace

Guides::Triangles FalloffOverlay::of(const Scene& scene, const std::vector<DeformTarget>& targets, double falloff) {
  std::vector<NodeRef> nodes;
  for (const DeformTarget& target : targets) {
    if (!target.selection) return nullptr;  // a whole object has no border
    if (target.node) nodes.push_back(*target.node);
  }
  if (!(falloff > 0) || targets.empty()) return nullptr;
  const auto same = [](const NodeRef& a, const NodeRef& b) { return a.id == b.id; };
  if (roots_ == scene.roots && falloff_ == falloff &&
      std::equal(nodes.begin(), nodes.end(), nodes_.begin(), nodes_.end(), same))
    return made_;
  roots_ = scene.roots;
  nodes_ = nodes;
  falloff_ = falloff;
  made_.reset();
  std::size_t all = 0;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.node->object && placed.node->selection) all += placed.node->object->triangle_count();
  if (all > max_triangles) return nullptr;
  try {
    auto triangles = std::make_shared<std::vector<Guides::Triangle>>();
    for (const DeformTarget& target : targets) {
      const DeformSet set = deform_set(scene, target);
      for (std::size_t k = 0; k < set.nodes.size(); ++k) add(set.nodes[k], set.flags[k], falloff, *triangles);
    }
    made_ = std::move(triangles);
  } catch (const Error&) {
    // The deformation itself will report the error.
  }
  return made_;
}

}  // namespace rebake
