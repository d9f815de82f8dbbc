#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A change of display colours, per channel: logit(color) becomes gain · logit(color) + offset. Differences of exposure
/// and white balance are nearly offsets, those of contrast gains. MobileNeRF's decoders can make it exactly.
struct ColorChange {
  std::array<double, 3> gain{1, 1, 1};
  std::array<double, 3> offset{0, 0, 0};

  /// `color`: 0 … 1 per channel. Values outside [1/510, 509/510] count as the nearest in it.
  Color operator()(const Color& color) const;
};

struct ColorMatchOptions {
  double distance = 0.005;       ///< largest distance of paired points, as a share of the smaller capture's diagonal
  std::size_t samples = 20'000;  ///< points of the changed capture; five times as many of the other
  bool gain = true;              ///< also change the contrast, not only the brightness
};

/// A colour change, and how well it fits.
struct ColorMatch {
  ColorChange change;
  std::size_t pairs = 0;  ///< points that both captures have, seen along the same directions
  double used = 0;        ///< share of the observations that the fit did not reject as outliers
  /// Root mean square difference per channel of those observations, in display colours (0 … 1).
  double before = 0, after = 0;
};

/// The change that makes the colours of `changed` those of `fixed` where both captures have the same surface: nearest
/// points with like normals, seen along directions that are free of occluders. Gains are ratios of spreads (reduced
/// major axis), which noise in both captures does not bias, if the colours correlate; outliers are rejected by Tukey's
/// biweight. Throws Error if fewer than 100 points are common.
ColorMatch matched_colors(const std::vector<PlacedNode>& changed, const std::vector<PlacedNode>& fixed,
                          const ColorMatchOptions& options, const Progress& progress = {});

/// The object with changed colours: exact for MobileNeRF's decoders; objects with plain colours get other texels,
/// within half a byte. Throws EditError for nerf2mesh's objects, whose colour is a sum.
std::shared_ptr<const BakedObject> recolored(const BakedObject& object, const ColorChange& change);

}  // namespace rebake
