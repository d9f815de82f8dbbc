#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Clears the opacity of texels inside a region or in a picture, where an object's edge runs through triangles; all
/// other texels stay bit for bit.
struct Erase {
  static constexpr const char* op = "erase";
  std::optional<NodeRef> node;
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  CoordinateFrame frame = CoordinateFrame::world;
  PictureFields picture;
  bool through = false;
};
template <>
const EditType& edit_type<Erase>();

Outcome apply(const Scene& scene, const Erase& edit);

}  // namespace rebake
