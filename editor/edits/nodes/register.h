#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Moves, rotates and scales a node so that its surfaces coincide with those of another capture: first by point pairs,
/// then by the surfaces themselves.
struct Register {
  static constexpr const char* op = "register";
  static constexpr const char* done = "Registered";
  NodeRef node;
  std::optional<NodeRef> to;  ///< node that stays; nothing: all other visible objects
  PolyLine points;            ///< at least three points of the node, in world space; empty: it is nearly in place
  PolyLine onto;              ///< the same points of the capture that stays
  bool scale = true;          ///< whether the size may change
  bool refine = true;         ///< whether the surfaces refine what the pairs give
  std::optional<double> overlap;
  int samples = 20000;
};
template <>
const EditType& edit_type<Register>();

Outcome apply(const Scene& scene, const Register& edit, const Progress& progress);

}  // namespace rebake
