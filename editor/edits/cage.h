#pragma once

#include "editor/edits/deforming.h"

namespace rebake {

struct CageDeform {
  static constexpr const char* op = "cage";
  static constexpr const char* help =
      "Deforms triangles by a cage around them: its points move, what is inside follows, colours turn along.";
  DeformTarget target;
  CageSource cage;
  CageMoves moves;
  CageCoordinates coordinates = CageCoordinates::mean_value;
  int resolution = 32;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    DeformTarget::fields(self.target, visit);
    CageSource::fields(self.cage, visit);
    visit(
        "moves", self.moves, Need::required,
        "what moves, one after the other; boxes and spheres in world units, with frame bounds in shares of the cage's "
        "box");
    visit("coordinates", self.coordinates, Need::optional,
          "mean_value: anywhere; green: keeps shapes, inside only; harmonic: around corners, not across, inside only, "
          "on a grid");
    visit("resolution", self.resolution, Need::optional,
          "harmonic: cells of the grid along the cage's longest side, 8 to 256; finer is nearer and slower");
  }
};

template <>
struct Codec<CageCoordinates> {
  static const char* type();
  static CageCoordinates read(const nlohmann::json& value, const Scene& scene);
  static nlohmann::json write(CageCoordinates value);
};

Scene apply(const Scene& scene, const CageDeform& edit, const Progress& progress = {});

}  // namespace rebake
