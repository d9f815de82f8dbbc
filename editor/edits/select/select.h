#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Selects triangles by their centres.
struct Select {
  static constexpr const char* op = "select";
  static constexpr bool selects = true;
  std::optional<NodeRef> node;
  bool all = false;
  bool none = false;
  bool invert = false;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  std::optional<Vec3> connected;
  std::optional<int> texture_set;
  std::string saved;
  SelectMode mode = SelectMode::set;
  CoordinateFrame frame = CoordinateFrame::world;
};
template <>
const EditType& edit_type<Select>();

Scene apply(const Scene& scene, const Select& edit);

}  // namespace rebake
