#pragma once

#include "editor/edits/support.h"

namespace rebake {

/// Gives the scene a real scale: the distance of two points becomes a known length.
struct SetLength {
  static constexpr const char* op = "set_length";
  PolyLine points;
  double length = 1;
};
template <>
const EditType& edit_type<SetLength>();

Outcome apply(const Scene& scene, const SetLength& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const SetLength& edit);

}  // namespace rebake
