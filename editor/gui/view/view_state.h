#pragma once

#include <optional>

#include "mesh_ops/scene/camera.h"
#include "render/graph/guides.h"

namespace rebake {

/// How the document is looked at. No edit, and nothing of it is kept with the work.
struct ViewState {
  Camera camera;
  int width = 1, height = 1;  ///< the viewport's pixels
  bool flying = false;
  bool alone = false;  ///< without panels around it
  double cut = 0;      ///< what is nearer to the eye, in scene units, is neither shown nor selected; 0: nothing is cut
  bool show_selection = true;
  int samples = 4;          ///< a pixel, at rest
  double moving_share = 0;  ///< of the resolution each way while the view moves; 0: what keeps the rate below
  int target_rate = 17;     ///< pictures a second while the view moves
  Guides::Inspect inspect = Guides::Inspect::none;
  int channel = 1;             ///< of the features, when they are inspected
  bool wipe = false;           ///< the scene as imported is shown left of `wipe_at`
  bool as_baked = false;       ///< without what light does
  std::optional<Vec2> marked;  ///< a place in the picture that a panel points at, by shares of its size
  double wipe_at = 0.5;        ///< share of the viewport's width

  double aspect() const { return static_cast<double>(width) / height; }
};

}  // namespace rebake
