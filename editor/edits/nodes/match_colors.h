#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Changes a capture's colours to those of another one, where both have the same surfaces.
struct MatchColors {
  static constexpr const char* op = "match_colors";
  static constexpr const char* done = "Matched the colours of";
  NodeRef node;
  std::optional<NodeRef> to;  ///< node whose colours stay; nothing: all other visible objects
  bool gain = true;           ///< whether the contrast may change, too
  double distance = 0.005;    ///< largest distance of paired points, as a share of the smaller capture's diagonal
};
template <>
const EditType& edit_type<MatchColors>();

Outcome apply(const Scene& scene, const MatchColors& edit, const Progress& progress);

}  // namespace rebake
