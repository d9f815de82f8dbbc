#include "mesh_ops/texture/decoder.h"

#include <cmath>

namespace rebake {

Mat3 axes_matrix(Axes axes) {
  if (axes == Axes::forward) return Mat3::Identity();
  Mat3 a;
  a << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  return a;
}

bool Decoder::operator==(const Decoder& other) const {
  return rule == other.rule && hidden0() == other.hidden0() && hidden1() == other.hidden1() &&
         weights0 == other.weights0 && bias0 == other.bias0 && weights1 == other.weights1 && bias1 == other.bias1 &&
         weights2 == other.weights2 && bias2 == other.bias2;
}

Color decode(const Decoder& decoder, const std::array<double, 8>& features, const Vec3& fed_direction) {
  Eigen::Matrix<double, Decoder::inputs, 1> input;
  for (int i = 0; i < Decoder::features; ++i) input[i] = features[static_cast<std::size_t>(i)];
  input.tail<3>() = fed_direction;
  if (decoder.rule != ColorRule::network) input /= features[0];
  const Vec3 diffuse = input.segment<3>(1);
  if (decoder.rule == ColorRule::diffuse) return diffuse;
  const Eigen::VectorXd first = (decoder.weights0.transpose() * input + decoder.bias0).cwiseMax(0.0);
  const Eigen::VectorXd second = (decoder.weights1.transpose() * first + decoder.bias1).cwiseMax(0.0);
  const Vec3 logits = decoder.weights2.transpose() * second + decoder.bias2;
  const Vec3 outputs = logits.unaryExpr([](double v) { return 1 / (1 + std::exp(-v)); });
  return decoder.rule == ColorRule::network ? outputs : Vec3((diffuse + outputs).cwiseMin(1.0));
}

Decoder diffuse_decoder() {
  return {Eigen::MatrixXd::Zero(Decoder::inputs, 1),
          Eigen::VectorXd::Zero(1),
          Eigen::MatrixXd::Zero(1, 1),
          Eigen::VectorXd::Zero(1),
          Eigen::MatrixXd::Zero(1, 3),
          Eigen::VectorXd::Zero(3),
          ColorRule::diffuse};
}

Decoder fold_rotation(const Decoder& decoder, const Mat3& turn, Axes from, Axes to) {
  Decoder folded = decoder;
  const Mat3 change = axes_matrix(to) * turn * axes_matrix(from).transpose();
  folded.weights0.bottomRows<3>() = change * decoder.weights0.bottomRows<3>();
  return folded;
}

}  // namespace rebake
