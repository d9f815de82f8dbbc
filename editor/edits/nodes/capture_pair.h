#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Two captures of one place: a node that an edit changes, and objects that stay.
struct CapturePair {
  std::vector<PlacedNode> changed, fixed;
  std::vector<NodeId> hidden;  ///< hidden objects in the node that is changed
};

/// The visible objects in `node`, and those in `to`; without `to`, all other visible objects stay. Throws FieldError
/// for "node" or "to" if there are none, or if the nodes contain each other.
CapturePair capture_pair(const Scene& scene, NodeId node, const std::optional<NodeRef>& to);

}  // namespace rebake
