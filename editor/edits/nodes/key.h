#pragma once

#include "editor/edits/deform/deforming_axis.h"

namespace rebake {

/// Sets or removes a keyframe: of the camera, of a node's place, or of the angle of a bend. Films, published pages and
/// glTF files move by keyframes; pictures do not.
struct Key {
  static constexpr const char* op = "key";
  double time = 0;  ///< seconds
  std::optional<NodeRef> node;
  std::optional<Vec3> position;  ///< relative to the parent
  std::optional<Rotation> rotation;
  std::optional<Scale> scale;
  std::optional<Camera> camera;
  std::string view;               ///< name of a stored view, in place of `camera`
  std::optional<double> degrees;  ///< angle of the bend `track`
  std::string track = "bend";
  std::string selection;  ///< name of a stored selection; empty: all triangles
  std::optional<BoxRegion> box;
  CoordinateFrame frame = CoordinateFrame::world;  ///< of `box`
  double falloff = 0;
  DeformAxis axis;
  Vec3 direction{1, 0, 0};
  Interpolation interpolation = Interpolation::smooth;  ///< to the next keyframe
  bool remove = false;
};
template <>
const EditType& edit_type<Key>();

Outcome apply(const Scene& scene, const Key& edit);
/// Title of a step: see EditType::title.
std::string whole_title(const Key& edit);

}  // namespace rebake
