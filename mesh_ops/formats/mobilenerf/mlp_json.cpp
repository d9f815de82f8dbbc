#include "mesh_ops/formats/mobilenerf/mlp_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/json_matrix.h"
#include "mesh_ops/formats/mobilenerf/json_text.h"

namespace rebake {

namespace {

using nlohmann::json;

constexpr std::size_t widest_layer = 512;

// Member for decoders of other rules than ColorRule::network, in Rebake scenes.
constexpr const char* rule_key = "rebake_color_rule";
struct RuleName {
  ColorRule rule;
  const char* name;
};
constexpr RuleName rule_names[] = {{ColorRule::diffuse_and_network, "diffuse_and_network"},
                                   {ColorRule::diffuse, "diffuse"}};

ColorRule read_rule(const json& value, const std::filesystem::path& name) {
  for (const RuleName& known : rule_names)
    if (value == known.name) return known.rule;
  throw FileError(name, fmt::format("\"{}\" is {}, which is unknown; a newer version of Rebake may have written it",
                                    rule_key, value.dump()));
}

const json& member(const json& root, const char* key, const std::filesystem::path& name) {
  const auto found = root.find(key);
  if (found == root.end()) throw FileError(name, fmt::format("\"{}\" is missing", key));
  return *found;
}

double number(const json& value, const std::string& where, const std::filesystem::path& name) {
  if (!value.is_number()) throw FileError(name, where + " is not a number");
  const double result = value.get<double>();
  if (!std::isfinite(static_cast<float>(result)))
    throw FileError(name, where + " is out of the range of 32-bit floats");
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

// Shape of a matrix for messages: "16×11", or a description if rows differ or it is no matrix.
std::string shape_of(const json& values) {
  if (!values.is_array()) return "not a list";
  if (values.empty() || !values[0].is_array()) return fmt::format("a list of {}", values.size());
  for (std::size_t r = 1; r < values.size(); ++r)
    if (!values[r].is_array() || values[r].size() != values[0].size())
      return fmt::format("{} rows of unequal lengths (row {} differs from row 0)", values.size(), r);
  return fmt::format("{}×{}", values.size(), values[0].size());
}

Eigen::MatrixXd read_weights(const json& root, const char* key, Eigen::Index rows, Eigen::Index columns,
                             const std::filesystem::path& name) {
  const json& values = member(root, key, name);
  const std::string expected = fmt::format("{}×{}", rows, columns);
  if (shape_of(values) != expected)
    throw FileError(name, fmt::format("\"{}\" is {}, expected {} (inputs × outputs){}", key, shape_of(values), expected,
                                      shape_of(values) == fmt::format("{}×{}", columns, rows) ? ". Transpose it" : ""));
  Eigen::MatrixXd weights(rows, columns);
  for (Eigen::Index r = 0; r < rows; ++r) {
    const json& row = values[static_cast<std::size_t>(r)];
    for (Eigen::Index c = 0; c < columns; ++c)
      weights(r, c) = number(row[static_cast<std::size_t>(c)], fmt::format("\"{}\"[{}][{}]", key, r, c), name);
  }
  return weights;
}

// Exporters in Python write a count as 1, 1.0 or "1".
int read_obj_num(const json& value, const std::filesystem::path& name) {
  double count = 0;
  if (value.is_number()) count = value.get<double>();
  if (value.is_string()) {
    const auto& text = value.get_ref<const std::string&>();
    if (!text.empty() && text.size() < 6 && text.find_first_not_of("0123456789") == std::string::npos)
      count = std::stod(text);
  }
  if (count != std::floor(count) || count < 1 || count > static_cast<double>(max_texture_sets))
    throw FileError(name, fmt::format("\"obj_num\" must be a whole number from 1 to {}", max_texture_sets));
  return static_cast<int>(count);
}

bool is_layer_key(const std::string& key) {
  const std::size_t digits = key.find_first_not_of("0123456789");
  return digits != 0 && digits != std::string::npos &&
         (key.substr(digits) == "_weights" || key.substr(digits) == "_bias");
}

// The word or number around a byte of the text, such as NaN; empty for punctuation.
std::string word_at(std::string_view text, std::size_t byte) {
  constexpr std::string_view letters = "+-.0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
  std::size_t begin = std::min(byte, text.size()), end = begin;
  while (begin > 0 && letters.find(text[begin - 1]) != std::string_view::npos) --begin;
  while (end < text.size() && letters.find(text[end]) != std::string_view::npos) ++end;
  return std::string(text.substr(begin, end - begin));
}

json parsed(std::string_view text, const std::filesystem::path& name) {
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    // The error's byte counts from 1, and lies in or after the word.
    const std::size_t byte = error.byte > 0 ? error.byte - 1 : 0;
    const std::string word = word_at(text, byte), place = json_path(text, byte);
    for (const char* other : {"NaN", "nan", "Infinity", "-Infinity", "inf", "-inf"})
      if (word == other) throw FileError(name, fmt::format("{} is {}, which is not a number", place, word));
    throw FileError(name, fmt::format("is not valid JSON{}: {}", place.empty() ? "" : " at " + place, error.what()));
  } catch (const json::exception& error) {
    throw FileError(name, fmt::format("cannot be read: {}", error.what()));
  }
}

json list_of(const Eigen::VectorXd& vector) {
  json list = json::array();
  for (const double value : vector) list.push_back(value);
  return list;
}

}  // namespace

MlpFile read_mlp_json(std::string_view text, const std::filesystem::path& name) {
  MlpFile file;
  const TrimmedJson trimmed = without_trailing_commas(text);
  if (trimmed.commas > 0) {
    file.assumptions.push_back(fmt::format("{}: {} commas after last elements are skipped; the first in line {}",
                                           name.filename().string(), trimmed.commas, trimmed.first_line));
    file.needs_repair = true;
    text = trimmed.text;
  }
  const json root = parsed(text, name);
  if (!root.is_object()) throw FileError(name, "must contain a JSON object");
  Decoder& d = file.decoder;
  d.bias0 = read_bias(root, "0_bias", name);
  d.bias1 = read_bias(root, "1_bias", name);
  d.bias2 = read_bias(root, "2_bias", name);
  if (d.bias2.size() != 3)
    throw FileError(name, fmt::format("\"2_bias\" must have 3 numbers (RGB), not {}", d.bias2.size()));
  d.weights0 = read_weights(root, "0_weights", Decoder::inputs, d.bias0.size(), name);
  d.weights1 = read_weights(root, "1_weights", d.bias0.size(), d.bias1.size(), name);
  d.weights2 = read_weights(root, "2_weights", d.bias1.size(), 3, name);
  if (const auto found = root.find("obj_num"); found != root.end()) file.obj_num = read_obj_num(*found, name);
  if (const auto found = root.find(rule_key); found != root.end()) d.rule = read_rule(*found, name);
  file.others = json_members(text);
  for (const char* key : {"0_weights", "0_bias", "1_weights", "1_bias", "2_weights", "2_bias", "obj_num", rule_key})
    file.others.erase(key);
  for (const auto& [key, value] : file.others)
    if (is_layer_key(key))
      throw FileError(
          name, fmt::format("\"{}\" belongs to an additional layer; decoders have three layers (0, 1 and 2)", key));
  return file;
}

std::string write_mlp_json(const MlpFile& file) {
  json root;
  root["0_weights"] = json_rows(file.decoder.weights0);
  root["0_bias"] = list_of(file.decoder.bias0);
  root["1_weights"] = json_rows(file.decoder.weights1);
  root["1_bias"] = list_of(file.decoder.bias1);
  root["2_weights"] = json_rows(file.decoder.weights2);
  root["2_bias"] = list_of(file.decoder.bias2);
  if (file.obj_num) root["obj_num"] = *file.obj_num;
  for (const RuleName& known : rule_names)
    if (known.rule == file.decoder.rule) root[rule_key] = known.name;
  std::string text = root.dump();
  for (const auto& [key, value] : file.others) text.insert(text.size() - 1, fmt::format(",\"{}\":{}", key, value));
  return text;
}

}  // namespace rebake
