// Removing an object from a shelf: the hole under it and the wall that it hid are filled, compared with the truth.
#include <gtest/gtest.h>

#include <cmath>

#include "editor/edits/edit.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/mesh/attributes.h"
#include "render/compare.h"
#include "render/picture.h"
#include "tests/support/made_scenes.h"

#include <nlohmann/json.hpp>

namespace rebake::test {
namespace {

constexpr int quad_texels = 6;     // texels per quad
constexpr double quad_side = 0.1;  // side of a quad

// Quads of unwelded corners, with colours that are functions of the place, as a forward-facing capture has them.
class Quads {
 public:
  // The quads of a rectangle from `corner` along two axes, except those of which `hidden` holds at the centre.
  template <class Hidden>
  void add(const Vec3& corner, const Vec3& along, int columns, const Vec3& up, int rows, Hidden hidden) {
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const Vec3 at = corner + i * quad_side * along + j * quad_side * up;
        if (!hidden(Vec3(at + quad_side / 2 * (along + up)))) quads_.push_back({at, quad_side * along, quad_side * up});
      }
  }
  std::shared_ptr<const BakedObject> object(const std::function<Color(const Vec3&)>& color) const {
    const int columns = 64, rows = (static_cast<int>(quads_.size()) + columns - 1) / columns;
    std::vector<Vec3> positions;
    std::vector<Vec2> uvs;
    std::vector<Face> faces;
    for (std::size_t k = 0; k < quads_.size(); ++k) {
      const auto& [at, along, up] = quads_[k];
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
        // Rounded, so that neighbours have bit-identical corners.
        const Vec3 p = at + x * along + y * up;
        positions.emplace_back((p * 1000).array().round() / 1000);
        const double u = static_cast<double>(k % columns * quad_texels) + 0.5 + x * (quad_texels - 1),
                     v = static_cast<double>(k / columns * quad_texels) + 0.5 + y * (quad_texels - 1);
        uvs.emplace_back(u / (columns * quad_texels), 1 - v / (rows * quad_texels));
      }
      faces.push_back({first, first + 1, first + 2});
      faces.push_back({first, first + 2, first + 3});
    }
    const FeatureTexture texels =
        FeatureTexture::from_rows(columns * quad_texels, rows * quad_texels, AlphaCode::plain, [&](int y, Texel* row) {
          for (int x = 0; x < columns * quad_texels; ++x) {
            const std::size_t k = static_cast<std::size_t>(y / quad_texels * columns + x / quad_texels);
            if (k >= quads_.size()) {
              row[x] = {};
              continue;
            }
            const auto& [at, along, up] = quads_[k];
            const Color c = color(at + along * (x % quad_texels) / (quad_texels - 1.0) +
                                  up * (y % quad_texels) / (quad_texels - 1.0));
            const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(255 * value)); };
            row[x] = {{255, byte(c[0]), byte(c[1]), byte(c[2])}, {0, 0, 0, 255}};
          }
        });
    auto made = std::make_shared<BakedObject>();
    made->decoder = std::make_shared<const Decoder>(diffuse_decoder());
    made->axes = Axes::forward;
    made->dialect.alpha = AlphaCode::plain;
    made->sets.push_back(
        {Soup(std::move(positions), std::move(uvs), std::move(faces)), std::make_shared<const FeatureTexture>(texels)});
    return made;
  }

 private:
  struct Quad {
    Vec3 at, along, up;
  };
  std::vector<Quad> quads_;
};

Color color_at(const Vec3& p) {
  return {0.55 + 0.2 * std::sin(1.5 * p.x() + p.y()), 0.5 + 0.2 * std::cos(p.y() - p.x()),
          0.4 + 0.15 * std::sin(2 * p.z() + p.x())};
}

// A wall and a shelf before it. With the box, the hidden parts are missing.
Scene shelf(bool with_box) {
  const auto nothing = [](const Vec3&) { return false; };
  const auto in_box = [&](const Vec3& p) { return with_box && std::abs(p.x()) < 0.3 && p.z() > -0.4 && p.z() < 0; };
  const auto behind = [&](const Vec3& p) { return with_box && std::abs(p.x()) < 0.4 && p.y() > 0.1 && p.y() < 0.7; };
  Quads quads;
  quads.add({-1.5, 0, -1}, Vec3::UnitX(), 30, Vec3::UnitY(), 15, behind);
  quads.add({-1.5, 0, -1}, Vec3::UnitX(), 30, Vec3::UnitZ(), 15, in_box);
  if (with_box) {
    quads.add({-0.3, 0, 0}, Vec3::UnitX(), 6, Vec3::UnitY(), 6, nothing);
    quads.add({-0.3, 0, -0.4}, Vec3::UnitX(), 6, Vec3::UnitY(), 6, nothing);
    quads.add({-0.3, 0, -0.4}, Vec3::UnitZ(), 4, Vec3::UnitY(), 6, nothing);
    quads.add({0.3, 0, -0.4}, Vec3::UnitZ(), 4, Vec3::UnitY(), 6, nothing);
    quads.add({-0.3, 0.6, -0.4}, Vec3::UnitX(), 6, Vec3::UnitZ(), 4, nothing);
  }
  return scene_of(quads.object(color_at), "shelf");
}

Scene edited(const Scene& scene, const std::string& text) {
  return apply(scene, read_edit(nlohmann::json::parse(text), scene)).scene;
}

TEST(Shelf, RemovedObjectLeavesNoTrace) {
  Scene scene = shelf(true);
  scene = edited(scene, R"({"op": "select", "box": {"min": [-0.31, 0.01, -0.45], "max": [0.31, 0.7, 0.05]}})");
  scene = edited(scene, R"({"op": "delete_and_fill"})");
  scene = edited(scene, R"({"op": "select", "all": true})");
  // The outline of wall and shelf has 150 edges.
  EXPECT_THROW(edited(scene, R"({"op": "fill_holes", "longest": 10})"), EditError);
  const Scene filled = edited(scene, R"({"op": "fill_holes", "longest": 100})");
  View view;
  view.camera.eye = {0.2, 0.9, 3};
  view.camera.target = {0, 0.4, -0.6};
  view.width = view.height = 200;
  Renderer renderer;
  const Image truth = renderer.render(shelf(false), view);
  const Difference before = compare(renderer.render(scene, view), truth, 2),
                   after = compare(renderer.render(filled, view), truth, 2);
  EXPECT_GT(after.psnr_db, 40);
  EXPECT_LT(before.psnr_db, 25);
  EXPECT_THROW(edited(edited(filled, R"({"op": "select", "all": true})"), R"({"op": "fill_holes", "longest": 100})"),
               EditError);
}

}  // namespace
}  // namespace rebake::test
