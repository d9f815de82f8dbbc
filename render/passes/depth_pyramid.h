#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace rebake {

/// A rectangle of samples of a raster, y up; right and top are excluded.
struct SampleRect {
  int left = 0, bottom = 0, right = 0, top = 0;
};

/// Bounds of a triangle as a driver may rasterise it.
struct ScreenTriangle {
  SampleRect samples;              ///< samples that it may cover; here right and top are included
  std::array<double, 3> x, y;      ///< corners in samples, y up; sample centres are at integers + ½
  std::array<double, 3> nearness;  ///< per corner, as in DepthPyramid
  double moved = 0;                ///< largest displacement of a corner by rounding, in samples
  double error = 0;                ///< bound of the error of nearness at corners
};

/// Hi-Z pyramid for occlusion tests on the CPU: the depth of the farthest sample per block of 4×4 samples, then per 2×2
/// blocks on each coarser level. Depth is given as nearness: 1 at the near plane, 0 at the far plane and if nothing was
/// drawn.
class DepthPyramid {
 public:
  /// Builds the pyramid of a part `rect` of a raster. `nearness`: per sample, row by row from the bottom; must outlive
  /// the tests.
  void build(const SampleRect& rect, const std::vector<float>& nearness);

  /// Whether all samples of a rectangle, here with right and top included, are nearer than `nearness`. Ignores samples
  /// outside the pyramid. Conservative: may return false for occluded rectangles.
  bool hides(const SampleRect& samples, float nearness) const;
  /// Whether all samples that a triangle may cover are nearer than the triangle, each compared with its bound at that
  /// sample. Conservative; returns false without a test for triangles over more than 1024 blocks.
  bool hides(const ScreenTriangle& triangle) const;

 private:
  static constexpr int block = 4;  ///< samples per side of a block of the finest level

  struct Level {
    int width = 0, height = 0;
    std::vector<float> farthest;  ///< smallest nearness per block
  };
  SampleRect rect_;
  const std::vector<float>* nearness_ = nullptr;
  std::vector<Level> levels_;
};

}  // namespace rebake
