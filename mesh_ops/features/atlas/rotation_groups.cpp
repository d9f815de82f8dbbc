#include "mesh_ops/features/atlas/rotation_groups.h"

namespace rebake {

namespace {

// Rotations that differ by less give the same colours to the last bit.
constexpr double rotation_tolerance = 1e-9;

}  // namespace

RotationGroups rotation_groups(const BakedObject& object) {
  RotationGroups result;
  std::uint32_t last = 0;
  for (const TextureSet& set : object.sets)
    for (const Face& face : set.soup.faces()) {
      const auto turn = [&](std::size_t k) {
        return set.soup.rotations() == nullptr ? Mat3(Mat3::Identity()) : (*set.soup.rotations())[face[k]].matrix();
      };
      const Mat3 first = turn(0);
      if ((turn(1) - first).norm() > rotation_tolerance || (turn(2) - first).norm() > rotation_tolerance) {
        result.group_of.push_back(RotationGroups::bent);
        result.any_bent = true;
        continue;
      }
      const auto fits = [&](std::uint32_t g) { return (result.groups[g].turn - first).norm() <= rotation_tolerance; };
      if (last >= result.groups.size() || !fits(last)) {
        for (last = 0; last < result.groups.size() && !fits(last);) ++last;
        if (last == result.groups.size()) result.groups.push_back({first, 0});
      }
      ++result.groups[last].faces;
      result.group_of.push_back(last);
    }
  // If there are bent faces, small groups of equal rotation among them are not a part of their own.
  if (result.any_bent)
    for (std::uint32_t& group : result.group_of)
      if (group != RotationGroups::bent && result.groups[group].faces * 100 < result.group_of.size())
        group = RotationGroups::bent;
  return result;
}

bool nearly_equal(const Decoder& a, const Decoder& b) {
  if (a == b) return true;
  Decoder same = a;
  same.weights0 = b.weights0;
  return same == b && (a.weights0 - b.weights0).cwiseAbs().maxCoeff() <= 1e-13 * a.weights0.cwiseAbs().maxCoeff();
}

}  // namespace rebake
