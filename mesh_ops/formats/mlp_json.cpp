#include "mesh_ops/formats/mlp_json.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/baked_folder.h"

namespace rebake {

namespace {

using nlohmann::json;

constexpr std::size_t widest_layer = 512;

const json& member(const json& root, const char* key, const std::filesystem::path& name) {
  const auto found = root.find(key);
  if (found == root.end()) throw FileError(name, fmt::format("\"{}\" is missing", key));
  return *found;
}

double number(const json& value, const std::string& where, const std::filesystem::path& name) {
  if (!value.is_number()) throw FileError(name, where + " is not a number");
  const double result = value.get<double>();
  if (!std::isfinite(static_cast<float>(result))) throw FileError(name, where + " is beyond what 32-bit floats hold");
  return result;
}

Eigen::VectorXd read_bias(const json& root, const char* key, const std::filesystem::path& name) {
  const json& values = member(root, key, name);
  if (!values.is_array() || values.empty() || values.size() > widest_layer)
    throw FileError(name, fmt::format("\"{}\" must be a list of 1 to {} numbers", key, widest_layer));
  Eigen::VectorXd bias(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    bias[static_cast<Eigen::Index>(i)] = number(values[i], fmt::format("\"{}\"[{}]", key, i), name);
  return bias;
}

Eigen::MatrixXd read_weights(const json& root, const char* key, Eigen::Index rows, Eigen::Index columns,
                             const std::filesystem::path& name) {
  const json& values = member(root, key, name);
  if (!values.is_array() || values.size() != static_cast<std::size_t>(rows))
    throw FileError(name, fmt::format("\"{}\" must have {} rows (one an input)", key, rows));
  Eigen::MatrixXd weights(rows, columns);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const json& row = values[static_cast<std::size_t>(r)];
    if (!row.is_array() || row.size() != static_cast<std::size_t>(columns))
      throw FileError(name, fmt::format("\"{}\"[{}] must have {} numbers, as many as its bias", key, r, columns));
    for (Eigen::Index c = 0; c < columns; ++c)
      weights(r, c) = number(row[static_cast<std::size_t>(c)], fmt::format("\"{}\"[{}][{}]", key, r, c), name);
  }
  return weights;
}

json rows_of(const Eigen::MatrixXd& matrix) {
  json rows = json::array();
  for (Eigen::Index r = 0; r < matrix.rows(); ++r) {
    json row = json::array();
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) row.push_back(matrix(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

json list_of(const Eigen::VectorXd& vector) {
  json list = json::array();
  for (const double value : vector) list.push_back(value);
  return list;
}

}  // namespace

MlpFile read_mlp_json(std::string_view text, const std::filesystem::path& name) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::exception& error) {
    throw FileError(name, fmt::format("is not valid JSON (NaN and Infinity are not either): {}", error.what()));
  }
  if (!root.is_object()) throw FileError(name, "must hold a JSON object");
  MlpFile file;
  Decoder& d = file.decoder;
  d.bias0 = read_bias(root, "0_bias", name);
  d.bias1 = read_bias(root, "1_bias", name);
  d.bias2 = read_bias(root, "2_bias", name);
  if (d.bias2.size() != 3)
    throw FileError(name, fmt::format("\"2_bias\" must have 3 numbers (RGB), not {}", d.bias2.size()));
  d.weights0 = read_weights(root, "0_weights", Decoder::inputs, d.bias0.size(), name);
  d.weights1 = read_weights(root, "1_weights", d.bias0.size(), d.bias1.size(), name);
  d.weights2 = read_weights(root, "2_weights", d.bias1.size(), 3, name);
  if (const auto found = root.find("obj_num"); found != root.end()) {
    if (!found->is_number_integer() || found->get<std::int64_t>() < 1 ||
        found->get<std::int64_t>() > std::int64_t{most_texture_sets})
      throw FileError(name, fmt::format("\"obj_num\" must be a whole number from 1 to {}", most_texture_sets));
    file.obj_num = found->get<int>();
  }
  return file;
}

std::string write_mlp_json(const MlpFile& file) {
  json root;
  root["0_weights"] = rows_of(file.decoder.weights0);
  root["0_bias"] = list_of(file.decoder.bias0);
  root["1_weights"] = rows_of(file.decoder.weights1);
  root["1_bias"] = list_of(file.decoder.bias1);
  root["2_weights"] = rows_of(file.decoder.weights2);
  root["2_bias"] = list_of(file.decoder.bias2);
  if (file.obj_num) root["obj_num"] = *file.obj_num;
  return root.dump();
}

}  // namespace rebake
