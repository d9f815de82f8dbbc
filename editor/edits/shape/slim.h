#pragma once

#include "editor/edits/support.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

/// Removes what nobody sees of objects, and packs what is left.
struct Slim {
  static constexpr const char* op = "slim";
  std::optional<NodeRef> node;
  std::vector<std::string> views;
  std::optional<BoxRegion> eyes;
  int rays = 16384;
  double psnr = 0;
};
template <>
const EditType& edit_type<Slim>();

Outcome apply(const Scene& scene, const Slim& edit, const Progress& progress);

}  // namespace rebake
