#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace rebake {

/// Rectangle of a raster's samples, y up; right and top are excluded.
struct SampleRect {
  int left = 0, bottom = 0, right = 0, top = 0;
};

/// A triangle as it is drawn, as far as that is known.
struct ScreenTriangle {
  SampleRect samples;          ///< that it may cover, right and top included
  std::array<double, 3> x, y;  ///< corners in samples, y up; the middle of the first sample is at ½
  std::array<double, 3> nearness;
  double moved = 0;  ///< samples by which a driver may have moved a corner
  double error = 0;  ///< of nearness at corners
};

/// How near what has been drawn so far is, so that what lies behind it need not be drawn. Nearness is 1 at the near
/// plane and 0 at the far one, where nothing was drawn too.
class DepthPyramid {
 public:
  /// Of `rect` of a raster; `nearness` has its rows one after the other, the lowest first, and is asked later, too.
  void build(const SampleRect& rect, const std::vector<float>& nearness);

  /// Whether all samples of a rectangle, its right and top included, are nearer than `nearness`. Samples outside the
  /// pyramid's rectangle do not count. Errs on the side of false.
  bool hides(const SampleRect& samples, float nearness) const;
  /// The same of the samples that a triangle may cover, each as near as the triangle may be there. Of large ones that
  /// is not asked: false.
  bool hides(const ScreenTriangle& triangle) const;

 private:
  static constexpr int block = 4;  ///< samples a side of the finest level

  struct Level {
    int width = 0, height = 0;
    std::vector<float> farthest;
  };
  SampleRect rect_;
  const std::vector<float>* nearness_ = nullptr;
  std::vector<Level> levels_;
};

}  // namespace rebake
