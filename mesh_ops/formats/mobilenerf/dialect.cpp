#include "mesh_ops/formats/mobilenerf/dialect.h"

#include <utility>

namespace rebake {

namespace {

constexpr int direction_inputs = Decoder::inputs - Decoder::features;

}  // namespace

Decoder from_dialect(const Decoder& decoder, const Dialect& dialect) {
  Decoder result = decoder;
  Eigen::MatrixXd& rows = result.weights0;
  if (dialect.direction_first) {
    rows.topRows(Decoder::features) = decoder.weights0.bottomRows(Decoder::features);
    rows.bottomRows(direction_inputs) = decoder.weights0.topRows(direction_inputs);
  }
  if (dialect.half_direction) {
    // W · (d + 1) / 2 = (W / 2) · d + the sum of the rows of W / 2
    rows.bottomRows(direction_inputs) /= 2;
    result.bias0 += rows.bottomRows(direction_inputs).colwise().sum().transpose();
  }
  return result;
}

Decoder to_dialect(const Decoder& decoder, const Dialect& dialect) {
  Decoder result = decoder;
  Eigen::MatrixXd& rows = result.weights0;
  if (dialect.half_direction) {
    result.bias0 -= rows.bottomRows(direction_inputs).colwise().sum().transpose();
    rows.bottomRows(direction_inputs) *= 2;
  }
  if (dialect.direction_first) {
    const Eigen::MatrixXd before = rows;
    rows.topRows(direction_inputs) = before.bottomRows(direction_inputs);
    rows.bottomRows(Decoder::features) = before.topRows(Decoder::features);
  }
  return result;
}

AlphaCode alpha_code_of(Layout layout, const Dialect& dialect) {
  return dialect.alpha.value_or(layout == Layout::unsplit ? AlphaCode::plain : AlphaCode::halved);
}

void swap_channels(const Dialect& dialect, int count, Texel* texels) {
  if (!dialect.bgr) return;
  for (int k = 0; k < count; ++k) {
    std::swap(texels[k].feat0[0], texels[k].feat0[2]);
    std::swap(texels[k].feat1[0], texels[k].feat1[2]);
  }
}

std::size_t fill_holes(const Dialect& dialect, int count, Texel* texels) {
  std::size_t holes = 0;
  for (int k = 0; dialect.no_holes && k < count; ++k) {
    if (texels[k].opaque()) continue;
    texels[k].feat0[0] = 1;
    ++holes;
  }
  return holes;
}

TexelRows in_channel_order(TexelRows rows, const Dialect& dialect) {
  if (!dialect.bgr) return rows;
  const int width = rows.width, height = rows.height;
  return {width, height, [rows = std::move(rows), dialect](int first, int count, Texel* texels) {
            rows.read(first, count, texels);
            for (int y = 0; y < count; ++y)
              swap_channels(dialect, rows.width, texels + static_cast<std::ptrdiff_t>(y) * rows.width);
          }};
}

}  // namespace rebake
