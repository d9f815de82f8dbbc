#pragma once

#include "editor/edits/deform/deforming.h"

namespace rebake {

/// Cage-based deformation: moved cage vertices deform the triangles inside by generalised barycentric coordinates.
/// View-dependent colours rotate with the surface.
struct CageDeform {
  static constexpr const char* op = "cage";
  static constexpr const char* done = "Deformed by a cage:";
  static constexpr bool deforms = true;
  static constexpr AdjustableField adjustable[] = {{"falloff", "Falloff", AdjustableField::Kind::length}};
  DeformTarget target;
  CageSource cage;
  CageMoves moves;  ///< applied one after another
  CageCoordinates coordinates = CageCoordinates::mean_value;
  int resolution = 32;  ///< harmonic: grid cells along the cage's longest side, 8 … 256
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
/// See EditType::change_title.
std::string change_title(const CageDeform& edit, const SceneChange& change, const CageDeform* replaced);

}  // namespace rebake
