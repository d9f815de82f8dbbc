#include "mesh_ops/formats/nerf2mesh/nerf2mesh_mlp.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/mobilenerf/json_matrix.h"
#include "mesh_ops/formats/mobilenerf/json_text.h"

namespace rebake {

namespace {

using nlohmann::json;

constexpr const char *first_key = "net.0.weight", *second_key = "net.1.weight";
constexpr std::size_t widest_layer = 512;
// Rows of Decoder::weights0 that the file stores: the direction, then the specular features.
constexpr Eigen::Index direction_row = 8, specular_row = 4;

// A matrix of `rows` rows. `columns`: of each row; 0: any number up to widest_layer, the same for all rows.
Eigen::MatrixXd read_matrix(const json& root, const char* key, std::size_t rows, std::size_t columns,
                            const std::filesystem::path& name) {
  const auto found = root.find(key);
  if (found == root.end()) throw FileError(name, fmt::format("\"{}\" is missing", key));
  const bool is_matrix = found->is_array() && found->size() == rows && found->at(0).is_array();
  if (is_matrix && columns == 0) columns = found->at(0).size();
  if (!is_matrix || columns == 0 || columns > widest_layer)
    throw FileError(name, fmt::format("\"{}\" must have {} rows of 1 to {} numbers", key, rows, widest_layer));
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
  for (std::size_t r = 0; r < rows; ++r) {
    const json& row = found->at(r);
    if (!row.is_array() || row.size() != columns)
      throw FileError(name, fmt::format("\"{}\"[{}] must have {} numbers", key, r, columns));
    for (std::size_t c = 0; c < columns; ++c) {
      const double value = row[c].is_number() ? row[c].get<double>() : std::nan("");
      if (!std::isfinite(static_cast<float>(value)))
        throw FileError(name, fmt::format("\"{}\"[{}][{}] is not a finite number", key, r, c));
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = value;
    }
  }
  return matrix;
}

}  // namespace

bool is_nerf2mesh_mlp(std::string_view text) {
  const json root = json::parse(text, nullptr, false);
  return root.is_object() && root.contains(first_key);
}

Nerf2MeshMlp read_nerf2mesh_mlp(std::string_view text, const std::filesystem::path& name) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::exception& error) {
    throw FileError(name, fmt::format("is not valid JSON: {}", error.what()));
  }
  if (!root.is_object()) throw FileError(name, "must contain a JSON object");
  const Eigen::MatrixXd first = read_matrix(root, first_key, 6, 0, name);
  const Eigen::Index width = first.cols();
  Nerf2MeshMlp mlp;
  Decoder& d = mlp.decoder;
  d.rule = ColorRule::diffuse_and_network;
  d.weights0 = Eigen::MatrixXd::Zero(Decoder::inputs, width);
  d.weights0.middleRows(direction_row, 3) = first.topRows(3);
  d.weights0.middleRows(specular_row, 3) = first.bottomRows(3);
  d.weights1 = Eigen::MatrixXd::Identity(width, width);
  d.weights2 = read_matrix(root, second_key, static_cast<std::size_t>(width), 3, name);
  d.bias0 = Eigen::VectorXd::Zero(width);
  d.bias1 = Eigen::VectorXd::Zero(width);
  d.bias2 = Eigen::VectorXd::Zero(3);
  if (const auto found = root.find("cascade"); found != root.end()) {
    const double count = found->is_number() ? found->get<double>() : 0;
    if (count != std::floor(count) || count < 1 || count > max_nerf2mesh_meshes)
      throw FileError(name, fmt::format("\"cascade\" must be a whole number from 1 to {}", max_nerf2mesh_meshes));
    mlp.cascade = static_cast<int>(count);
  }
  mlp.others = json_members(text);
  for (const char* key : {first_key, second_key, "cascade"}) mlp.others.erase(key);
  for (const auto& [key, value] : mlp.others)
    if (key.starts_with("net."))
      throw FileError(name, fmt::format("\"{}\" is unknown: the network must have two layers without biases", key));
  return mlp;
}

bool is_nerf2mesh_decoder(const Decoder& d) {
  return d.rule == ColorRule::diffuse_and_network && d.weights0.topRows(specular_row).isZero(0) &&
         d.weights0.row(specular_row + 3).isZero(0) && d.bias0.isZero(0) && d.bias1.isZero(0) && d.bias2.isZero(0) &&
         d.hidden0() == d.hidden1() && d.weights1.isIdentity(0);
}

std::string write_nerf2mesh_mlp(const Nerf2MeshMlp& mlp) {
  const Decoder& d = mlp.decoder;
  Eigen::MatrixXd first(6, d.hidden0());
  first << d.weights0.middleRows(direction_row, 3), d.weights0.middleRows(specular_row, 3);
  json root;
  root[first_key] = json_rows(first);
  root[second_key] = json_rows(d.weights2);
  root["cascade"] = mlp.cascade;
  std::string text = root.dump();
  for (const auto& [key, value] : mlp.others) text.insert(text.size() - 1, fmt::format(",\"{}\":{}", key, value));
  return text;
}

}  // namespace rebake
