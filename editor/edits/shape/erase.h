#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Makes texels inside a region transparent, to cut through triangles. The region is a box, a sphere, a half-space or a
/// region of a picture; exactly one must be given. All other texels stay bit for bit.
struct Erase {
  static constexpr const char* op = "erase";
  static constexpr const char* done = "Erased in";
  std::optional<NodeRef> node;  ///< nothing: all visible, unlocked objects
  std::vector<NodeRef> nodes;   ///< several nodes, in place of `node`
  std::optional<BoxRegion> box;
  std::optional<SphereRegion> sphere;
  std::optional<HalfSpaceRegion> half_space;
  CoordinateFrame frame = CoordinateFrame::world;  ///< coordinates of box, sphere and half-space
  PictureFields picture;
  bool through = false;  ///< in a picture: also occluded texels
};
template <>
const EditType& edit_type<Erase>();

Outcome apply(const Scene& scene, const Erase& edit);
/// See EditType::change_title.
std::string change_title(const Erase& edit, const SceneChange& change, const Erase* replaced);

}  // namespace rebake
