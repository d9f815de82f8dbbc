#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <utility>
#include <vector>

#include "mesh_ops/base/types.h"
#include "mesh_ops/scene/scene.h"
#include "mesh_ops/select/regions.h"

namespace rebake {

/// A node named in a field: by its name, or by its number as the journal writes it.
struct NodeRef {
  NodeId id = NodeId::none;
};

/// A rotation: a quaternion of length 1, made so once, here. Making one of another's quaternion keeps its bits, so that
/// what is written and read back turns alike.
class Rotation {
 public:
  Rotation() = default;
  /// Throws Error for a quaternion that is not finite or has no length.
  explicit Rotation(const Eigen::Quaterniond& turn);
  explicit Rotation(const Eigen::AngleAxisd& turn) : Rotation(Eigen::Quaterniond(turn)) {}

  const Eigen::Quaterniond& quaternion() const { return quaternion_; }
  Mat3 matrix() const { return quaternion_.toRotationMatrix(); }

 private:
  Eigen::Quaterniond quaternion_ = Eigen::Quaterniond::Identity();
};

/// A scale as one number or three.
struct Scale {
  Vec3 value{1, 1, 1};
};

/// A line through points in the world; none: no line.
struct PolyLine {
  std::vector<Vec3> points;
};

/// Corners of a polygon in pixels, x to the right and y down.
struct PixelPolygon {
  std::vector<Vec2> corners;
};
/// A round brush drawn through points, in pixels.
struct BrushStroke {
  std::vector<Vec2> points;
  double radius = 0;
};
/// Numbers from min to max.
struct Interval {
  double min = 0, max = 0;
};
/// Whole numbers from 0 on, as ranges that include both ends.
struct NumberRanges {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
};
struct PixelSize {
  int width = 800, height = 800;
};

/// Width of a decoder's hidden layers; none: found out.
struct FuseWidth {
  std::optional<int> neurons;
};

enum class SelectMode { set, add, remove, intersect };

/// How a struct describes a field: `visit(name, member, need, help)`, and a unit where it has one.
enum class Need { required, optional };
enum class Unit { none, degrees, length, object_length, pixels, share, factor };

}  // namespace rebake
