#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/gui/state/jobs.h"
#include "editor/gui/state/view_state.h"
#include "mesh_ops/features/distill/fuse_method.h"
#include "render/picture_texture.h"

namespace rebake {

/// Dialog before the export of one plain folder: compares possible decoders by PSNR, frame time, export time, and an
/// image beside the exact one.
class PlainPreview {
 public:
  /// Opens the dialog and measures on a sample of the texels, in the current view. `nodes`: nodes to export; empty for
  /// all.
  void begin(const ViewState& view, Jobs& jobs, std::vector<NodeRef> nodes);
  /// Draws the dialog if it is open; returns the choice in the frame in which the user confirms it.
  struct Choice {
    FuseMethod way;
    int width;  ///< of the decoder's hidden layers
  };
  std::optional<Choice> draw(Jobs& jobs);
  /// Closes the dialog in the next frame and cancels its job; returns false if it is not open.
  bool leave(Jobs& jobs);

 private:
  struct Measured;
  /// Selects a row and renders its image if there is none yet.
  void show(Jobs& jobs, std::size_t row);
  void draw_table(Jobs& jobs);
  /// Draws the two images with a draggable divider.
  void draw_wipe(float width);

  bool open_ = false, working_ = false;  ///< the dialog is open; its job is queued or running
  std::vector<NodeRef> nodes_;           ///< nodes to export; empty for all
  std::shared_ptr<Measured> measured_;   ///< null until the first job is done
  std::shared_ptr<bool> wanted_;         ///< shared with the jobs; false once the dialog is closed: results are dropped
  std::size_t row_ = 0, shown_ = 0;      ///< selected row, and row whose image is shown
  std::optional<PictureTexture> exact_, plain_;
  float split_ = 0.5F;  ///< divider as a share of the image width; the exact image is at the left
  std::string problem_;
};

}  // namespace rebake
