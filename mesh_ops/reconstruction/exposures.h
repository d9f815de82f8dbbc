#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Estimates the exposures of photographs (a gain per channel, in linear light) while a scene is trained on them, from
/// the pixels of its steps.
class Exposures {
 public:
  explicit Exposures(std::size_t photographs) : sums_(9 * photographs) {}
  /// Adds a pixel: its display colour in the photograph, and that of the scene. Those that the
  /// photograph clips do not count.
  void add(std::size_t photograph, const Vec3& in_photograph, const Vec3& in_scene);
  /// Gains per photograph, whose geometric means per channel are `mean`. The mean where nothing was added.
  std::vector<Vec3> gains() const;
  Vec3 mean = Vec3::Ones();
  /// Halves the weight of all pixels that were added so far.
  void fade();
  /// Whether exposures differ: gains have a spread() of at least 4 %, and explain at least a third of the error.
  bool differ() const;
  /// Share of the squared error, after one gain for all photographs, that a gain for each removes; 0 … 1.
  double explained() const;
  /// Relative standard deviation of the gains' means over photographs.
  double spread() const;

  void save(std::string& bytes) const;
  void load(std::string_view& bytes);

 private:
  std::vector<double> sums_;  // [photograph][channel][products, squares of the scene, squares of the photograph]
};

}  // namespace rebake
