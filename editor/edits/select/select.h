#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles by exactly one criterion: all, none, the inverse, centres inside a region, connectivity, texture
/// set, or a stored selection.
struct Select {
  static constexpr const char* op = "select";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  bool all = false;
  bool none = false;
  bool invert = false;  ///< the unselected triangles
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  std::optional<Vec3> connected;   ///< connected, through shared vertices, to the triangle nearest to this point
  std::optional<int> texture_set;  ///< index, from 0
  std::string saved;               ///< name of a stored selection
  SelectMode mode = SelectMode::set;
  CoordinateFrame frame = CoordinateFrame::world;  ///< coordinates of the regions and of `connected`
};
template <>
const EditType& edit_type<Select>();

Scene apply(const Scene& scene, const Select& edit);

}  // namespace rebake
