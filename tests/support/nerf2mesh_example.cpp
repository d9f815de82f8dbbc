#include "tests/support/nerf2mesh_example.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/formats/images/png_writer.h"

namespace rebake::test {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

json rows_of(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    json row = json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(row);
  }
  return rows;
}

// As xatlas and nerf2mesh write it: all positions, all texture coordinates (u, 1 − v), then faces v/vt.
std::string sphere_obj(double radius, int k) {
  constexpr int columns = 12, rows = 6;
  std::string text = fmt::format("mtllib mesh_{}.mtl\n", k);
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double around = 2 * std::numbers::pi * c / columns, down = std::numbers::pi * r / rows;
      text += fmt::format("v {} {} {}\n", radius * std::sin(down) * std::cos(around),
                          radius * std::sin(down) * std::sin(around), radius * std::cos(down));
    }
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c)
      text += fmt::format("vt {} {}\n", static_cast<double>(c) / columns, 1 - static_cast<double>(r) / rows);
  text += "usemtl defaultMat\n";
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto corner = [&](int dr, int dc) {
        return fmt::format("{}/{}", (r + dr) * columns + (c + dc) % columns + 1, (r + dr) * (columns + 1) + c + dc + 1);
      };
      text += fmt::format("f {} {} {}\n", corner(0, 0), corner(1, 0), corner(1, 1));
      text += fmt::format("f {} {} {}\n", corner(0, 0), corner(1, 1), corner(0, 1));
    }
  return text;
}

}  // namespace

Vec3 Nerf2MeshNumbers::color(const Vec3& diffuse, const Vec3& specular, const Vec3& direction) const {
  Vec3 out = Vec3::Zero();
  for (Eigen::Index j = 0; j < first.cols(); ++j) {
    double sum = 0;
    for (Eigen::Index i = 0; i < 3; ++i) sum += direction[i] * first(i, j) + specular[i] * first(3 + i, j);
    for (Eigen::Index c = 0; c < 3; ++c) out[c] += std::max(sum, 0.0) * second(j, c);
  }
  for (Eigen::Index c = 0; c < 3; ++c) out[c] = std::clamp(diffuse[c] + 1 / (1 + std::exp(-out[c])), 0.0, 1.0);
  return out;
}

Nerf2MeshNumbers write_nerf2mesh_example(const fs::path& folder, const Nerf2MeshExample& example) {
  fs::create_directories(folder);
  std::mt19937 random(example.seed);
  std::normal_distribution<double> normal;
  Nerf2MeshNumbers numbers{Eigen::MatrixXd(6, example.hidden), Eigen::MatrixXd(example.hidden, 3)};
  for (double& w : numbers.first.reshaped()) w = normal(random);
  for (double& w : numbers.second.reshaped()) w = normal(random) / 2 - 0.5;
  const json mlp{{"net.0.weight", rows_of(numbers.first)},
                 {"net.1.weight", rows_of(numbers.second)},
                 {"bound", 1},
                 {"cascade", example.meshes}};
  write_bytes(folder / "mlp.json", mlp.dump());
  const int side = example.side;
  for (int k = 0; k < example.meshes; ++k) {
    write_bytes(folder / fmt::format("mesh_{}.obj", k), sphere_obj(1 + k, k));
    write_bytes(folder / fmt::format("mesh_{}.mtl", k), fmt::format("newmtl defaultMat\nmap_Kd feat0_{}.jpg\n", k));
    for (const int image : {0, 1}) {
      std::vector<std::uint8_t> pixels(static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * 3);
      // Noise, with some values of 0, which must not become holes.
      for (std::uint8_t& value : pixels) value = static_cast<std::uint8_t>(random() % 4 == 0 ? 0 : random() % 200);
      std::string bytes, error;
      if (example.jpeg)
        picture_codecs(folder).encode("jpeg", side, side, 3, pixels.data(), bytes, error);
      else
        bytes = encode_png(side, side, 3, pixels, 6);
      write_bytes(folder / fmt::format("feat{}_{}.{}", image, k, example.jpeg ? "jpg" : "png"), bytes);
    }
  }
  return numbers;
}

}  // namespace rebake::test
