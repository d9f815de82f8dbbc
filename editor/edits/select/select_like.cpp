#include "editor/edits/select/select_like.h"

#include "editor/edits/describe.h"
#include "mesh_ops/base/elementary.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

namespace rebake {

namespace {

using Features = Eigen::Array<double, 8, 1>;

Features features_of(const TriangleTraits& traits) {
  return Eigen::Map<const Eigen::Array<float, 8, 1>>(traits.features.data()).cast<double>();
}
Vec3 vector_of(const std::array<float, 3>& v) { return Vec3(v[0], v[1], v[2]); }

// How a node's transform changes areas and planes.
class WorldShape {
 public:
  explicit WorldShape(const PlacedNode& placed)
      : cofactor_(placed.to_world.linear().determinant() * placed.to_world.linear().inverse().transpose()) {}
  // The triangle's area vector in the world: normal times area.
  Vec3 area(const TriangleTraits& traits) const { return cofactor_ * vector_of(traits.normal) * traits.area; }

 private:
  Mat3 cofactor_;
};

struct Likeness {
  Vec3 color = Vec3::Zero();
  Features features = Features::Zero();
  double opacity = 0, area = 0;
  Vec3 normal = Vec3::Zero();
};

Likeness mean_of(const std::vector<PlacedNode>& targets, const std::vector<TriangleSet>& picked) {
  Likeness mean;
  double total = 0;
  // Planes have no sign: the axis that all normals agree on best is the largest eigenvector of their outer products.
  Mat3 planes = Mat3::Zero();
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (count(picked[k]) == 0) continue;
    const auto traits = traits_of(*targets[k].node->object);
    const WorldShape shape(targets[k]);
    for (std::size_t f = 0; f < picked[k].size(); ++f) {
      if (picked[k][f] == 0) continue;
      const TriangleTraits& t = (*traits)[f];
      const Vec3 area = shape.area(t);
      mean.color += vector_of(t.color);
      mean.features += features_of(t);
      mean.opacity += static_cast<double>(t.opacity);
      mean.area += area.norm();
      const Vec3 normal = area.stableNormalized();
      planes += normal * normal.transpose();
      total += 1;
    }
  }
  mean.color /= total;
  mean.features /= total;
  mean.opacity /= total;
  mean.area /= total;
  mean.normal = Eigen::SelfAdjointEigenSolver<Mat3>(planes).eigenvectors().col(2);
  return mean;
}

}  // namespace

Scene apply(const Scene& scene, const SelectLike& edit) {
  if (!edit.color && !edit.features && !edit.opacity && !edit.size && !edit.orientation)
    throw FieldError("color", "at least one of color, features, opacity, size and orientation must be given");
  const auto not_negative = [](const char* name, const std::optional<double>& value) {
    if (value && *value < 0) throw FieldError(name, "must not be negative");
  };
  not_negative("color", edit.color);
  not_negative("features", edit.features);
  not_negative("opacity", edit.opacity);
  not_negative("orientation", edit.orientation);
  if (edit.size && *edit.size < 1) throw FieldError("size", "is a factor of at least 1");
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  std::vector<TriangleSet> picked;
  if (edit.point) {
    const NearestTriangle nearest = nearest_triangle(targets, *edit.point, true);
    for (const PlacedNode& placed : targets) picked.emplace_back(placed.node->object->triangle_count(), 0);
    picked[nearest.target].at(nearest.triangle) = 1;
  } else {
    with_selection(scene, edit.node);
    for (const PlacedNode& placed : targets) picked.push_back(selection_of(placed));
  }
  const Likeness model = mean_of(targets, picked);
  const double least_cosine =
      edit.orientation ? elementary::sine_cosine(std::min(*edit.orientation, 90.0) * std::numbers::pi / 180).cosine : 0;
  return with_selected(scene, targets, edit.mode, [&](const PlacedNode& placed) {
    const auto traits = traits_of(*placed.node->object);
    const WorldShape shape(placed);
    TriangleSet flags(traits->size());
    tbb::parallel_for(std::size_t{0}, flags.size(), [&](std::size_t f) {
      const TriangleTraits& t = (*traits)[f];
      // What shows nothing has neither colour nor features.
      if ((edit.color || edit.features) && t.opacity == 0) return;
      if (edit.color && (vector_of(t.color) - model.color).norm() > *edit.color) return;
      if (edit.features && std::sqrt((features_of(t) - model.features).square().mean()) > *edit.features) return;
      if (edit.opacity && std::abs(static_cast<double>(t.opacity) - model.opacity) > *edit.opacity) return;
      if (edit.size || edit.orientation) {
        const Vec3 area = shape.area(t);
        if (edit.size && (area.norm() > model.area * *edit.size || area.norm() * *edit.size < model.area)) return;
        if (edit.orientation && std::abs(area.stableNormalized().dot(model.normal)) < least_cosine) return;
      }
      flags[f] = 1;
    });
    return flags;
  });
}

REBAKE_DESCRIBE_EDIT(
    SelectLike,
    "Selects triangles that are like the picked ones: within every tolerance that is given, of the mean over the "
    "present selection or of the triangle nearest to a point.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only of this node and those inside it; left out: of all that is visible");
      visit("point", edit.point, Need::optional,
            "world point, near a triangle that shows something; left out: like the present selection");
      visit("color", edit.color, Need::optional, "distance of mean decoded colours, channels 0 to 1");
      visit("features", edit.features, Need::optional, "root mean square difference of mean features, 0 to 1");
      visit("opacity", edit.opacity, Need::optional, "difference of the share of opaque texels, 0 to 1");
      visit("size", edit.size, Need::optional, "factor between areas in the world, at least 1");
      visit("orientation", edit.orientation, Need::optional, "degrees between planes in the world, 0 to 90");
      visit("mode", edit.mode, Need::optional, "how the result joins the present selection");
    })

}  // namespace rebake
