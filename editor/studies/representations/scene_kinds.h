#pragma once

#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "render/graph/render_view.h"
#include "render/image.h"
#include "samples/bakery/field.h"

namespace rebake {

/// A procedural sample of a kind of scene that the MobileNeRF paper distinguishes.
struct SceneKind {
  const char* sample;
  const char* kind;
};
inline constexpr SceneKind scene_kinds[] = {
    {"ficus", "synthetic 360°"}, {"shelf", "forward-facing"}, {"courtyard", "unbounded 360°"}};

/// The model of this name. Throws FieldError.
bakery::Model procedural_model(const std::string& sample);

/// A view ray with the truth's display colour (white where nothing is).
struct TruthRay {
  Eigen::Vector3f origin, direction;  ///< unit direction
  std::array<float, 3> color;
};

/// Rays of the views that representations are fitted to, in random order.
struct TruthRays {
  std::vector<TruthRay> rays;
  std::vector<Vec3> hits;                             ///< points of the surfaces that they meet
  std::vector<std::array<float, 3>> hit_colors = {};  ///< of the rays that meet them
};

/// Traces `side`² rays through random points of each of the `views` pictures that a bake observes, see
/// bakery::BakeOptions. Deterministic.
TruthRays traced_rays(const bakery::Model& model, const bakery::RadianceField& field, int views, int side,
                      const Progress& progress);

/// A view that no representation was fitted to, and its traced picture.
struct HeldOutView {
  View view;
  Image truth;  ///< empty until it is traced
};

/// Views of `side`² pixels from `count` of the 20 held-out cameras of the sample bakery, `after` cameras after the
/// usual ones.
std::vector<HeldOutView> held_out_views(const bakery::Model& model, int count, int side, int after = 0);

}  // namespace rebake
