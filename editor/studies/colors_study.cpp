#include <fmt/format.h>

#include <cmath>

#include "editor/studies/study.h"
#include "mesh_ops/registration/color_match.h"
#include "mesh_ops/scene/scene_light.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

// A texture of the colours that the object shows along one direction, multiplied in linear light.
std::shared_ptr<const FeatureTexture> exposed(const BakedObject& object, const FeatureTexture& texture,
                                              double exposure) {
  const TexelReader texels(texture);
  const TexelColors decoded(*object.decoder, {Vec3(0, 0, -1)});
  return std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(texture.width(), texture.height(), AlphaCode::plain, [&](int y, Texel* row) {
        std::vector<TexelColors::Features> features;
        for (int x = 0; x < texture.width(); ++x)
          features.push_back(decode_features(texels.at(x, y), texture.alpha_code()));
        std::vector<Color> colors(features.size());
        decoded.decode_into(features, colors);
        for (int x = 0; x < texture.width(); ++x) {
          row[x] = empty_texel(AlphaCode::plain);
          if (!texels.at(x, y).opaque()) continue;
          row[x] = {{255, 0, 0, 0}, {0, 0, 0, 255}};
          for (std::size_t c = 0; c < 3; ++c) {
            const double color = colors[static_cast<std::size_t>(x)][static_cast<Eigen::Index>(c)];
            row[x].feat0[1 + c] =
                static_cast<std::uint8_t>(std::lround(255 * std::min(1.0, to_display(exposure * to_linear(color)))));
          }
        }
      }));
}

std::vector<PlacedNode> exposed_nodes(const Scene& scene, double exposure) {
  Scene changed = scene;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    auto object = std::make_shared<BakedObject>(*placed.node->object);
    object->decoder = std::make_shared<const Decoder>(diffuse_decoder());
    for (TextureSet& set : object->sets) set.texels = exposed(*placed.node->object, *set.texels, exposure);
    changed = with_changed(changed, placed.node->id, [&](Node& node) { node.object = object; });
  }
  return placed_nodes(changed);
}

}  // namespace

// The scene's colours with one exposure are matched to those with another, at coincident surfaces.
StudyTable study_colors(const StudyInput& input) {
  StudyTable table{{"ms", "difference after, of 255", "difference before, of 255", "exposure", "samples", "gain"},
                   {},
                   0,
                   1,
                   true,
                   false};
  const std::vector<PlacedNode> fixed = exposed_nodes(input.scene, 1);
  for (const double exposure : {0.5, 0.7, 0.9, 1.3}) {
    const std::vector<PlacedNode> changed = exposed_nodes(input.scene, exposure);
    for (const std::size_t samples : {1000U, 5000U, 20000U})
      for (const bool gain : {false, true}) {
        input.progress.at("matching colours", static_cast<double>(table.rows.size()) / 24);
        ColorMatchOptions options;
        options.samples = samples;
        options.gain = gain;
        ColorMatch match;
        const double time =
            median_milliseconds(std::min(input.frames, 3), [&] { match = matched_colors(changed, fixed, options); });
        table.rows.push_back(
            {fmt::format("exposure {:g}, {} samples{}", exposure, samples, gain ? ", gain" : ""),
             {time, 255 * match.after, 255 * match.before, exposure, static_cast<double>(samples), gain ? 1.0 : 0.0}});
      }
  }
  return table;
}

}  // namespace rebake
