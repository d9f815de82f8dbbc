#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/gui/window/desk.h"
#include "render/picture_texture.h"

namespace rebake {

/// Before a plain folder is written: what each way to make it would cost and show, beside the exact picture.
class PlainPreview {
 public:
  /// Measures on a sample of the texels, of these nodes (empty: all) as they are looked at now.
  void begin(Desk& desk, std::vector<NodeRef> nodes);
  /// Draws the dialog where it is open; true once another choice was made.
  bool draw(Desk& desk);
  /// Closes the dialog with the next frame; false where it is not open.
  bool leave(Desk& desk);
  /// Nothing is chosen any more.
  void forget() { choice_ = {}; }
  const Project::PlainChoice& choice() const { return choice_; }
  /// What was chosen, for people.
  std::string words() const;

 private:
  struct Measured;
  void show(Desk& desk, std::size_t row);
  void draw_table(Desk& desk);
  void draw_wipe(float width);

  bool open_ = false, working_ = false;  ///< working: a job of its own waits or runs
  std::vector<NodeRef> nodes_;
  std::shared_ptr<Measured> measured_;  ///< null until the worker is done
  std::shared_ptr<bool> wanted_;        ///< false once nobody waits for the answer any more
  std::size_t row_ = 0, shown_ = 0;     ///< looked at, and of which the picture is
  std::optional<PictureTexture> exact_, plain_;
  float split_ = 0.5F;  ///< of the picture: exact at its left
  Project::PlainChoice choice_;
  std::string problem_;
};

}  // namespace rebake
