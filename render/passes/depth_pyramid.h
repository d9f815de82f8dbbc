#pragma once

#include <cstddef>
#include <vector>

namespace rebake {

/// Rectangle of a raster's samples, y up; right and top are excluded.
struct SampleRect {
  int left = 0, bottom = 0, right = 0, top = 0;
};

/// How near what has been drawn so far is, so that what lies behind it need not be drawn. Nearness is 1 at the near
/// plane and 0 at the far one, where nothing was drawn too.
class DepthPyramid {
 public:
  /// Of `rect` of a raster; `nearness` has its rows one after the other, the lowest first.
  void build(const SampleRect& rect, const std::vector<float>& nearness);

  /// Whether all samples of a rectangle, its right and top included, are nearer than `nearness`. Samples outside the
  /// pyramid's rectangle do not count. Errs on the side of false.
  bool hides(const SampleRect& samples, float nearness) const;

 private:
  static constexpr int block = 4;  ///< samples a side of the finest level

  struct Level {
    int width = 0, height = 0;
    std::vector<float> farthest;
  };
  SampleRect rect_;
  std::vector<Level> levels_;
};

}  // namespace rebake
