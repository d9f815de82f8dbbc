#pragma once

#include "editor/edits/deforming.h"

namespace rebake {

struct HandlesDeform {
  static constexpr const char* op = "handles";
  static constexpr const char* help =
      "Deforms triangles as rigidly as possible: some points of a wrap around them are held or moved, the rest "
      "follows.";
  DeformTarget target;
  CageSource cage;
  CageMoves moves;
  CageMoves fixed;
  int iterations = 10;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    CageSource::fields(self.cage, visit);
    visit("moves", self.moves, Need::required,
          "points of the cage that are moved; boxes and spheres in world units, with frame bounds in shares of the "
          "cage's box");
    visit("fixed", self.fixed, Need::optional, "points of the cage that are held where they are");
    visit("iterations", self.iterations, Need::optional, "1 to 1000; more come nearer to rigid, and take longer");
  }
};

Scene apply(const Scene& scene, const HandlesDeform& edit, const Progress& progress = {});

}  // namespace rebake
