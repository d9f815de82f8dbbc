#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/base/types.h"
#include "mesh_ops/scene/scene.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

/// A node in a field. JSON contains its name, or its id as journals write it.
struct NodeRef {
  NodeId id = NodeId::none;
};

/// A rotation as a unit quaternion. The constructor normalises; a quaternion that is already normalised keeps its bits,
/// so that a rotation that is written and read back is the same.
class Rotation {
 public:
  Rotation() = default;
  /// Throws Error for a quaternion that is not finite or is zero.
  explicit Rotation(const Eigen::Quaterniond& turn);
  explicit Rotation(const Eigen::AngleAxisd& turn) : Rotation(Eigen::Quaterniond(turn)) {}

  const Eigen::Quaterniond& quaternion() const { return quaternion_; }
  Mat3 matrix() const { return quaternion_.toRotationMatrix(); }

 private:
  Eigen::Quaterniond quaternion_ = Eigen::Quaterniond::Identity();
};

/// Scale factors along x, y and z; never 0. JSON contains one number or three.
struct Scale {
  Vec3 value{1, 1, 1};
};

/// An open polyline in world space; may be empty.
struct PolyLine {
  std::vector<Vec3> points;
};

/// A closed polygon in a picture: corners in pixels, x to the right and y down.
struct PixelPolygon {
  std::vector<Vec2> corners;
};
/// A stroke of a round brush through points in a picture; points and radius in pixels.
struct BrushStroke {
  std::vector<Vec2> points;
  double radius = 0;
};
/// Closed interval [min, max].
struct Interval {
  double min = 0, max = 0;
};
/// A set of non-negative integers, as ranges [first, last] with both ends included.
struct NumberRanges {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
};
/// Size of a picture in pixels, 1 … 16384 each.
struct PixelSize {
  int width = 800, height = 800;
};

/// A flag that is only written if it is set, so that files without it can be read by earlier versions.
struct RareFlag {
  bool set = false;
};

/// Identifier of a format that scenes are written in; an entry of formats().
struct FormatName {
  std::string name = "mobilenerf";
};

/// Identifier of a format of camera files; an entry of camera_formats(). Empty: auto.
struct CameraFormatName {
  std::string name;
};

/// Edits that move an object, each as the JSON text of a line of a script.
struct PosingEdits {
  std::vector<std::string> lines;
};

/// Width of a fused decoder's hidden layers; nothing: chosen automatically.
struct FuseWidth {
  std::optional<int> neurons;
};

/// Combination of a new selection with the present one.
enum class SelectMode { set, add, remove, intersect };

/// Arguments of a field's description: `visit(name, member, need, help)`, and a unit if it has one.
enum class Need { required, optional };
/// length: scene units; object_length: units of the object's own space; share: 0 … 1; factor: a ratio.
enum class Unit { none, degrees, length, object_length, pixels, share, factor };

/// Direction of a deformation's axis: given, or found from the triangles.
struct AxisDirection {
  AxisDirection() = default;
  AxisDirection(const Vec3& given) : direction(given) {}
  Vec3 direction{0, 1, 0};  ///< any length but 0; unused if automatic
  bool automatic = false;
  bool operator==(const AxisDirection&) const = default;
};

}  // namespace rebake
