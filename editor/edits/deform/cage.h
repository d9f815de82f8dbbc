#pragma once

#include "editor/edits/deform/deforming.h"

namespace rebake {

/// Deforms triangles by a cage around them: its points move, what is inside follows, colours turn along.
struct CageDeform {
  static constexpr const char* op = "cage";
  DeformTarget target;
  CageSource cage;
  CageMoves moves;
  CageCoordinates coordinates = CageCoordinates::mean_value;
  int resolution = 32;
};
template <>
const EditType& edit_type<CageDeform>();

template <>
struct Codec<CageCoordinates> {
  static FieldType type();
  static CageCoordinates read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(const CageCoordinates& value);
};

Outcome apply(const Scene& scene, const CageDeform& edit, const Progress& progress = {});

}  // namespace rebake
