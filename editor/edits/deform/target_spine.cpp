#include "editor/edits/deform/target_spine.h"

namespace rebake {

Spine spine_of_targets(const Scene& scene, const std::vector<DeformTarget>& targets) {
  std::vector<WeightedPoint> part, rest;
  for (const DeformTarget& target : targets) {
    DeformSet set = deform_set(scene, target);
    for (const bool selected : {true, false}) {
      const TriangleList list = set.opaque_triangles();
      for (const Face& face : list.faces) {
        const Vec3 &a = list.points[face[0]], &b = list.points[face[1]], &c = list.points[face[2]];
        const WeightedPoint point{(a + b + c) / 3, (b - a).cross(c - a).norm()};
        if (point.at.allFinite() && point.weight > 0) (selected ? part : rest).push_back(point);
      }
      for (TriangleSet& flags : set.flags)
        for (std::uint8_t& flag : flags) flag = flag == 0 ? 1 : 0;
    }
  }
  return spine_of(part, rest).value_or(Spine{});
}

}  // namespace rebake
