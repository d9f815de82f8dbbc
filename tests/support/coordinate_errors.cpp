#include "tests/support/coordinate_errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace rebake::test {

CoordinateErrors errors_of(const Coordinates& coordinates, const Cage& cage, const std::vector<Vec3>& points) {
  Box box;
  for (const Vec3& v : cage.vertices) box.extend(v);
  const double size = box.diagonal().stableNorm();
  CoordinateErrors errors;
  const std::size_t rows = coordinates.rows();
  const double unit = frame_of(cage).scale * size;  // unit of ψ
  std::vector<double> weights(rows * batch_lanes);
  for (std::size_t first = 0; first < points.size(); first += batch_lanes) {
    std::array<Vec3, batch_lanes> block;
    for (std::size_t lane = 0; lane < batch_lanes; ++lane)
      block[lane] = points[std::min(first + lane, points.size() - 1)];
    std::array<std::uint8_t, batch_lanes> outside;
    coordinates.compute_weights(block, weights.data(), nullptr, outside.data());
    for (std::size_t lane = 0; lane < batch_lanes; ++lane) {
      EXPECT_EQ(outside[lane], 0) << block[lane].transpose();
      double sum = 0;
      Vec3 place(0, 0, 0);
      for (std::size_t v = 0; v < cage.vertices.size(); ++v) {
        const double w = weights[v * batch_lanes + lane];
        EXPECT_TRUE(std::isfinite(w)) << "weight of point " << v << " at " << block[lane].transpose();
        sum += w;
        place += w * ((cage.vertices[v] - block[lane]) / size);
      }
      if (rows > cage.vertices.size())
        for (std::size_t f = 0; f < cage.faces.size(); ++f) {
          const Face& face = cage.faces[f];
          const Vec3 u = (cage.vertices[face[1]] - cage.vertices[face[0]]) / size,
                     v = (cage.vertices[face[2]] - cage.vertices[face[0]]) / size;
          const Vec3 normal = u.cross(v);
          if (normal.norm() > 0)
            place += weights[(cage.vertices.size() + f) * batch_lanes + lane] / unit * normal.normalized();
        }
      errors.sum = std::max(errors.sum, std::abs(sum - 1));
      errors.linear = std::max(errors.linear, place.norm());
    }
  }
  return errors;
}

std::vector<double> weights_at(const Coordinates& coordinates, const Vec3& point, std::vector<Vec3>* gradients) {
  std::array<Vec3, batch_lanes> block;
  block.fill(point);
  std::vector<double> weights(coordinates.rows() * batch_lanes), slopes(coordinates.rows() * 3 * batch_lanes);
  std::array<std::uint8_t, batch_lanes> outside;
  coordinates.compute_weights(block, weights.data(), gradients != nullptr ? slopes.data() : nullptr, outside.data());
  std::vector<double> result;
  for (std::size_t row = 0; row < coordinates.rows(); ++row) {
    result.push_back(weights[row * batch_lanes]);
    if (gradients != nullptr)
      gradients->emplace_back(slopes[row * 3 * batch_lanes], slopes[(row * 3 + 1) * batch_lanes],
                              slopes[(row * 3 + 2) * batch_lanes]);
  }
  return result;
}

}  // namespace rebake::test
