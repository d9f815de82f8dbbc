#include "tests/support/lit_objects.h"

#include <algorithm>
#include <cmath>

namespace rebake::test {

namespace {

constexpr int cell = 17;
constexpr double slope = 10;  // slope of the decoder's logistic function over features 0 … 1

// A decoder that shows features 1, 2 and 4 as red, green and blue, by a logistic function of each.
Decoder plain_decoder() {
  Decoder d;
  d.weights0 = Eigen::MatrixXd::Zero(Decoder::inputs, 3);
  d.bias0 = Eigen::VectorXd::Zero(3);
  d.weights1 = Eigen::MatrixXd::Identity(3, 3);
  d.bias1 = Eigen::VectorXd::Zero(3);
  d.weights2 = slope * Eigen::MatrixXd::Identity(3, 3);
  d.bias2 = Eigen::VectorXd::Constant(3, -slope / 2);
  constexpr int feature[3] = {1, 2, 4};
  for (int c = 0; c < 3; ++c) d.weights0(feature[c], c) = 1;
  return d;
}

// The byte whose decoded feature gives this linear colour.
std::uint8_t byte_for(double linear) {
  const double display = std::clamp(to_display(linear), 0.007, 0.993);
  return static_cast<std::uint8_t>(std::lround((std::log(display / (1 - display)) / slope + 0.5) * 255));
}

}  // namespace

LitQuad flat_quad(const Vec3& corner, const Vec3& along_u, const Vec3& along_v, int columns, int rows) {
  return {{corner, corner + along_u, corner + along_v, corner + along_u + along_v}, columns, rows};
}

std::vector<LitQuad> box_quads(const Vec3& low, const Vec3& high, int cuts) {
  const Vec3 s = high - low, x(s.x(), 0, 0), y(0, s.y(), 0), z(0, 0, s.z());
  return {flat_quad(low, y, x, cuts, cuts), flat_quad(low + z, x, y, cuts, cuts),
          flat_quad(low, z, y, cuts, cuts), flat_quad(low + x, y, z, cuts, cuts),
          flat_quad(low, x, z, cuts, cuts), flat_quad(low + y, z, x, cuts, cuts)};
}

std::shared_ptr<const BakedObject> lit_object(const std::vector<LitQuad>& quads,
                                              const std::function<Radiance(const Vec3& position)>& color) {
  int count = 0;
  for (const LitQuad& quad : quads) count += quad.columns * quad.rows;
  const int per_row = std::max(1, static_cast<int>(std::ceil(std::sqrt(count))));
  const int width = per_row * cell, height = std::max(1, (count + per_row - 1) / per_row) * cell;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  std::vector<Texel> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  int number = 0;
  for (const LitQuad& quad : quads)
    for (int row = 0; row < quad.rows; ++row)
      for (int column = 0; column < quad.columns; ++column, ++number) {
        const int left = number % per_row * cell, top = number / per_row * cell;
        const auto place = [&](double u, double v) -> Vec3 {
          u = (column + u) / quad.columns;
          v = (row + v) / quad.rows;
          return (1 - u) * (1 - v) * quad.corners[0] + u * (1 - v) * quad.corners[1] + (1 - u) * v * quad.corners[2] +
                 u * v * quad.corners[3];
        };
        const auto first = static_cast<std::uint32_t>(positions.size());
        for (int k = 0; k < 4; ++k) {
          positions.push_back(place(k % 2, k / 2));
          uvs.emplace_back((left + 0.5 + k % 2 * (cell - 1)) / width, 1 - (top + 0.5 + k / 2 * (cell - 1)) / height);
        }
        faces.push_back({first, first + 1, first + 3});
        faces.push_back({first, first + 3, first + 2});
        for (int j = 0; j < cell; ++j)
          for (int i = 0; i < cell; ++i) {
            const Radiance shown = color(place(i / (cell - 1.0), j / (cell - 1.0)));
            Texel& texel = texels[static_cast<std::size_t>((top + j) * width + left + i)];
            texel.feat0 = {255, byte_for(shown[0]), byte_for(shown[1]), 128};
            texel.feat1 = {byte_for(shown[2]), 128, 128, 128};
          }
      }
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back({Soup(std::move(positions), std::move(uvs), std::move(faces)),
                          std::make_shared<const FeatureTexture>(
                              FeatureTexture::from_rows(width, height, AlphaCode::plain, [&](int y, Texel* row) {
                                std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * width, width, row);
                              }))});
  object->decoder = std::make_shared<const Decoder>(plain_decoder());
  return object;
}

}  // namespace rebake::test
