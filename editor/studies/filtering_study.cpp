#include <fmt/format.h>

#include <cmath>
#include <random>

#include "editor/actions/plain_report.h"
#include "editor/studies/study.h"
#include "mesh_ops/texture/linear_filter.h"
#include "mesh_ops/training/texel_colors.h"

namespace rebake {

namespace {

constexpr std::size_t points_per_set = 20000;

using Bytes = std::array<double, 8>;

// The features that decode_features() makes of bytes, which may be fractions.
TexelColors::Features features_of(const Bytes& bytes, AlphaCode code) {
  TexelColors::Features features{};
  for (std::size_t k = 0; k < 8; ++k) features[k] = bytes[k] / 255;
  if (code == AlphaCode::halved)
    for (const std::size_t k : {3U, 7U}) features[k] = 2 * features[k] - 1;
  return features;
}

// Random texture coordinates in the set's triangles where linear filtering is opaque.
std::vector<Vec2> opaque_points(const TextureSet& set, const TexelReader& texels) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const Soup& soup = set.soup;
  std::vector<Vec2> points;
  for (std::size_t tries = 0; tries < 20 * points_per_set && points.size() < points_per_set; ++tries) {
    const Face& face = soup.faces()[random() % soup.faces().size()];
    double a = unit(random), b = unit(random);
    if (a + b > 1) a = 1 - a, b = 1 - b;
    const Vec2 &p = soup.uvs()[face[0]], &q = soup.uvs()[face[1]], &r = soup.uvs()[face[2]];
    const Vec2 uv = p + a * (q - p) + b * (r - p);
    if (linear_bytes(texels, set.texels->width(), set.texels->height(), uv.x(), uv.y())[0] > 0) points.push_back(uv);
  }
  return points;
}

// Sums of errors over all sets.
struct Errors {
  double squares = 0, largest_byte = 0;
  std::size_t colors = 0, covered_otherwise = 0, points = 0;
};

void add_errors(const Decoder& decoder, const TextureSet& set, const FeatureTexture& shown, Errors& errors) {
  const TexelReader exact(*set.texels), nearest(shown);
  const AlphaCode code = shown.alpha_code();
  std::vector<TexelColors::Features> is, should;
  for (const Vec2& uv : opaque_points(set, exact)) {
    const Bytes bytes = linear_bytes(exact, set.texels->width(), set.texels->height(), uv.x(), uv.y());
    const Texel& texel = nearest.sample(uv.x(), uv.y());
    ++errors.points;
    errors.covered_otherwise += texel.opaque() ? 0 : 1;
    if (!texel.opaque()) continue;
    for (std::size_t k = 0; k < 8; ++k)
      errors.largest_byte =
          std::max(errors.largest_byte, std::abs(bytes[k] - (k < 4 ? texel.feat0[k] : texel.feat1[k - 4])));
    should.push_back(features_of(bytes, code));
    is.push_back(decode_features(texel, code));
  }
  const TexelColors decoded(decoder, even_directions(4));
  std::vector<Color> a(4 * is.size()), b(4 * is.size());
  decoded.decode_into(is, a);
  decoded.decode_into(should, b);
  for (std::size_t k = 0; k < a.size(); ++k) errors.squares += (a[k] - b[k]).squaredNorm() / 3;
  errors.colors += a.size();
}

}  // namespace

// The scene's textures are taken to be meant for linear filtering, and shown by finer textures.
StudyTable study_filtering(const StudyInput& input) {
  StudyTable table{{"MB of texels", "PSNR dB of colours", "milliseconds per frame", "milliseconds to subdivide",
                    "largest error of a byte", "points transparent by mistake, %"},
                   {},
                   0,
                   1,
                   true,
                   false};
  table.second_x = 2;
  for (const int factor : {1, 3, 5, 7, 9}) {
    input.progress.at("filtering", static_cast<double>(table.rows.size()) / 5);
    Scene scene = input.scene;
    Errors errors;
    double milliseconds = 0, bytes = 0;
    for (const PlacedNode& placed : placed_nodes(input.scene)) {
      if (!placed.visible || !placed.node->object) continue;
      auto object = std::make_shared<BakedObject>(*placed.node->object);
      for (TextureSet& set : object->sets) {
        const TextureSet before = set;
        if (factor > 1)
          milliseconds += median_milliseconds(
              1, [&] { set.texels = std::make_shared<const FeatureTexture>(subdivided(*before.texels, factor)); });
        bytes += static_cast<double>(set.texels->memory());
        add_errors(*object->decoder, before, *set.texels, errors);
      }
      scene = with_changed(scene, placed.node->id, [&](Node& node) { node.object = object; });
    }
    table.rows.push_back(
        {factor == 1 ? "nearest" : fmt::format("{} times as fine", factor),
         {bytes / 1e6, -10 * std::log10(errors.squares / static_cast<double>(errors.colors)),
          median_frame_ms(input.renderer(), scene, input.view, input.frames), milliseconds, errors.largest_byte,
          100 * static_cast<double>(errors.covered_otherwise) / static_cast<double>(errors.points)}});
  }
  return table;
}

}  // namespace rebake
