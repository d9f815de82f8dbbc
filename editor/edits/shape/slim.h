#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

/// Makes objects smaller: removes unseen and duplicate triangles, repacks the remaining texels, and with `psnr` merges
/// near-duplicate patches and removes feature bits. Visibility is tested per object; objects do not occlude each other.
struct Slim {
  static constexpr const char* op = "slim";
  std::optional<NodeRef> node;     ///< nothing: all visible, unlocked objects
  std::vector<std::string> views;  ///< eyes: these stored views
  std::optional<BoxRegion> eyes;   ///< eyes: anywhere in this world box; without both: all around the object
  int rays = 16384;                ///< maximum number of rays per triangle, 16 … 1048576
  double psnr = 0;                 ///< quality of texel colours in dB, 20 … 80; 0: lossless
};
template <>
const EditType& edit_type<Slim>();

Outcome apply(const Scene& scene, const Slim& edit, const Progress& progress);
/// See EditType::change_title.
std::string change_title(const Slim& edit, const SceneChange& change, const Slim* replaced);

}  // namespace rebake
