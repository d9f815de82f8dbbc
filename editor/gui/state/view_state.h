#pragma once

#include <optional>

#include "mesh_ops/scene/camera.h"
#include "render/graph/guides.h"

namespace rebake {

/// State of the viewport. Not part of the document: neither undone nor saved.
struct ViewState {
  Camera camera;
  int width = 1, height = 1;  ///< size of the viewport in pixels
  bool flying = false;        ///< fly navigation: WASDQE move the camera
  bool alone = false;         ///< the viewport fills the window
  /// Depth of the cutting plane along the line of sight, in scene units; 0: no cut. Nearer points are neither drawn nor
  /// selected.
  double cut = 0;
  bool show_selection = true;
  int samples = 4;          ///< samples per pixel while the view rests
  double moving_share = 0;  ///< resolution per axis while the view moves, relative to full; 0: by `target_rate`
  int target_rate = 17;     ///< frames per second to reach while the view moves
  Guides::Inspect inspect = Guides::Inspect::none;
  int channel = 1;             ///< feature channel 0 … 7 that Inspect::channel shows
  bool wipe = false;           ///< before/after comparison: the imported scene is shown left of `wipe_at`
  bool as_baked = false;       ///< draws baked colours without light corrections
  std::optional<Vec2> marked;  ///< point of the picture that a panel highlights in this frame, each coordinate 0 … 1
  double wipe_at = 0.5;        ///< position of the wipe line, as a share of the viewport's width

  /// Width / height.
  double aspect() const { return static_cast<double>(width) / height; }
};

}  // namespace rebake
