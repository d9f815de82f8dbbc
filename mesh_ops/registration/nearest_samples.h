#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// Nearest-point queries among many points: CGAL's k-d tree.
class NearestSamples {
 public:
  explicit NearestSamples(const std::vector<Vec3>& points);
  ~NearestSamples();
  NearestSamples(const NearestSamples&) = delete;
  NearestSamples& operator=(const NearestSamples&) = delete;

  /// Index of the nearest point. Thread-safe.
  std::size_t nearest(const Vec3& at) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace rebake
