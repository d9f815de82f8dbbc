#include "mesh_ops/features/distill/diffuse_network.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace rebake {

namespace {

// Logit of 254/255.
const double largest_logit = std::log(254.0);
// Factor of the fine features. Alpha channels of split folders have 7 bits, so the coarse step of 1/255 is spread over
// values of which each is less than half of such a step away.
constexpr double fine = 1.0 / 255;

// Coarse and fine byte of a logit.
struct Code {
  std::uint8_t coarse, fine;
};
std::array<Code, 256> codes() {
  std::array<Code, 256> table{};
  for (std::size_t v = 0; v < table.size(); ++v) {
    const double color = std::clamp(static_cast<double>(v) / 255, 1 / 255.0, 254 / 255.0);
    const double share = (std::log(color / (1 - color)) / largest_logit + 1) / 2;  // 0 … 1
    // The sum of both features reaches 0 … 1 + fine.
    const double whole = share * 255;
    const double coarse = std::min(std::floor(whole), 255.0);
    table[v] = {static_cast<std::uint8_t>(coarse), static_cast<std::uint8_t>(std::lround((whole - coarse) * 255))};
  }
  return table;
}

// Features of the coarse and fine codes of red, green and blue. Coarse codes avoid the alpha channels (3 and 7).
constexpr std::array<Eigen::Index, 3> coarse_features{1, 2, 4}, fine_features{5, 6, 3};

std::shared_ptr<const Decoder> logit_decoder() {
  Decoder d;
  d.weights0 = Eigen::MatrixXd::Zero(Decoder::inputs, 4);
  for (Eigen::Index c = 0; c < 3; ++c) {
    d.weights0(coarse_features[static_cast<std::size_t>(c)], c) = 1;
    d.weights0(fine_features[static_cast<std::size_t>(c)], c) = fine;
  }
  d.weights0(0, 3) = 1;  // the covered share
  d.weights1 = Eigen::MatrixXd::Identity(4, 4);
  d.weights2 = Eigen::MatrixXd::Zero(4, 3);
  for (Eigen::Index c = 0; c < 3; ++c) {
    d.weights2(c, c) = 2 * largest_logit;
    d.weights2(3, c) = -largest_logit;
  }
  d.bias0 = d.bias1 = Eigen::VectorXd::Zero(4);
  d.bias2 = Eigen::VectorXd::Zero(3);
  return std::make_shared<const Decoder>(std::move(d));
}

std::shared_ptr<const FeatureTexture> coded(const FeatureTexture& texture) {
  static const std::array<Code, 256> table = codes();
  return std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(texture.width(), texture.height(), AlphaCode::plain, [&](int y, Texel* row) {
        const TexelReader texels(texture);
        for (int x = 0; x < texture.width(); ++x) {
          const Texel& texel = texels.at(x, y);
          if (!texel.opaque()) {
            row[x] = empty_texel(AlphaCode::plain);
            continue;
          }
          const Code red = table[texel.feat0[1]], green = table[texel.feat0[2]], blue = table[texel.feat0[3]];
          row[x] = {{255, red.coarse, green.coarse, blue.fine}, {blue.coarse, red.fine, green.fine, 255}};
        }
      }));
}

}  // namespace

std::shared_ptr<const BakedObject> with_network(const BakedObject& object) {
  auto made = std::make_shared<BakedObject>(object);
  static const std::shared_ptr<const Decoder> decoder = logit_decoder();
  made->decoder = decoder;
  made->origin = nullptr;
  made->dialect = {};
  for (TextureSet& set : made->sets) set.texels = coded(*set.texels);
  return made;
}

Scene with_networks(const Scene& scene, std::vector<std::string>* changed) {
  Scene result = scene;
  std::map<const BakedObject*, std::shared_ptr<const BakedObject>> made;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    const auto& object = placed.node->object;
    if (!object || !object->decoder || object->decoder->rule != ColorRule::diffuse) continue;
    auto& known = made[object.get()];
    if (!known) known = with_network(*object);
    if (placed.visible && changed != nullptr) changed->push_back(placed.node->name);
    result = with_changed(result, placed.node->id, [&](Node& node) { node.object = known; });
  }
  return result;
}

}  // namespace rebake
