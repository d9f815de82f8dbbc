#include "editor/studies/representations/snerg_files.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "render/image.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr int planes_per_picture = 4;
constexpr int largest_side = 16384;
// The network becomes the text of a shader, in single precision. Published networks are 16 wide.
constexpr Eigen::Index widest = 64;
constexpr double largest_weight = 1e6;

std::size_t product(const SnergScene::Size& size) {
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]);
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

json list_of(const Eigen::VectorXd& vector) { return json(std::vector<double>(vector.begin(), vector.end())); }

// The fields of scene_params.json, with errors that name file and field.
class Fields {
 public:
  explicit Fields(fs::path file) : file_(std::move(file)) {
    try {
      fields_ = json::parse(read_file(file_));
    } catch (const json::parse_error& error) {
      throw FileError(file_, fmt::format("is not valid JSON, at byte {}", error.byte));
    }
    if (!fields_.is_object()) throw FileError(file_, "must contain an object");
  }

  [[noreturn]] void wrong(const char* name, const std::string& expected) const {
    throw FileError(file_, fmt::format("\"{}\" must be {}", name, expected));
  }
  const json& at(const char* name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) throw FileError(file_, fmt::format("lacks \"{}\"", name));
    return *found;
  }
  double number(const char* name) const {
    const json& value = at(name);
    if (!value.is_number() || !std::isfinite(value.get<double>())) wrong(name, "a finite number");
    return value.get<double>();
  }
  int whole(const char* name, int most) const {
    const double value = number(name);
    if (value < 1 || value > most || value != std::floor(value))
      wrong(name, fmt::format("a whole number, 1 to {}", most));
    return static_cast<int>(value);
  }
  bool truth(const char* name) const {
    const auto found = fields_.find(name);
    return found != fields_.end() && (found->is_boolean() ? found->get<bool>() : *found != 0);
  }
  Eigen::MatrixXd matrix(const char* name, Eigen::Index rows, Eigen::Index columns) const {
    const std::string expected = columns < 0 ? fmt::format("{} rows of numbers of equal length", rows)
                                             : fmt::format("{} × {} numbers", rows, columns);
    const json& value = at(name);
    if (!value.is_array() || static_cast<Eigen::Index>(value.size()) != rows || rows == 0) wrong(name, expected);
    if (columns < 0) columns = value[0].is_array() ? static_cast<Eigen::Index>(value[0].size()) : 0;
    if (columns < 1 || columns > widest) wrong(name, fmt::format("{}, at most {} per row", expected, widest));
    Eigen::MatrixXd result(rows, columns);
    for (Eigen::Index r = 0; r < rows; ++r) {
      const json& row = value[static_cast<std::size_t>(r)];
      if (!row.is_array() || static_cast<Eigen::Index>(row.size()) != columns) wrong(name, expected);
      for (Eigen::Index c = 0; c < columns; ++c) {
        const json& entry = row[static_cast<std::size_t>(c)];
        if (!entry.is_number() || !(std::abs(entry.get<double>()) < largest_weight)) wrong(name, expected);
        result(r, c) = entry.get<double>();
      }
    }
    return result;
  }
  Eigen::VectorXd vector(const char* name, Eigen::Index size) const {
    const json& value = at(name);
    const std::string expected = fmt::format("{} numbers", size);
    if (!value.is_array() || static_cast<Eigen::Index>(value.size()) != size) wrong(name, expected);
    Eigen::VectorXd result(size);
    for (Eigen::Index k = 0; k < size; ++k) {
      const json& entry = value[static_cast<std::size_t>(k)];
      if (!entry.is_number() || !(std::abs(entry.get<double>()) < largest_weight)) wrong(name, expected);
      result[k] = entry.get<double>();
    }
    return result;
  }

 private:
  fs::path file_;
  json fields_;
};

// A picture of this size. Throws FileError for another one.
Image picture_of(const fs::path& file, int width, int height, AlphaChannel alpha) {
  Image image = read_image(file, alpha);
  if (image.width != width || image.height != height)
    throw FileError(file, fmt::format("has {}×{} pixels, but scene_params.json needs {}×{}", image.width, image.height,
                                      width, height));
  return image;
}

// RGBA bytes of picture `name`_000.png and so on.
std::vector<std::uint8_t> planes(const fs::path& folder, const char* name, const SnergScene& scene) {
  const auto [width, height, depth] = scene.atlas;
  std::vector<std::uint8_t> texels;
  for (int z = 0; z < depth; z += planes_per_picture) {
    const fs::path file = folder / fmt::format("{}_{:03}.png", name, z / planes_per_picture);
    const Image image = picture_of(file, width, height * planes_per_picture, AlphaChannel::keep);
    const auto shown = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                       static_cast<std::size_t>(std::min(planes_per_picture, depth - z));
    for (std::size_t k = 0; k < shown; ++k) {
      texels.insert(texels.end(), image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k),
                    image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * k + 3));
      texels.push_back(image.alpha.empty() ? 255 : image.alpha[k]);
    }
  }
  return texels;
}

void write_planes(const std::vector<std::uint8_t>& texels, const char* name, const SnergScene& scene,
                  const fs::path& folder, const SourceGuard& guard) {
  const auto [width, height, depth] = scene.atlas;
  const auto plane = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (int z = 0; z < depth; z += planes_per_picture) {
    Image image{width, height * planes_per_picture, {}, {}};
    image.rgb.resize(plane * planes_per_picture * 3);
    image.alpha.resize(plane * planes_per_picture);
    const std::size_t first = static_cast<std::size_t>(z) * plane,
                      shown = plane * static_cast<std::size_t>(std::min(planes_per_picture, depth - z));
    for (std::size_t k = 0; k < shown; ++k) {
      for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * k + c] = texels[4 * (first + k) + c];
      image.alpha[k] = texels[4 * (first + k) + 3];
    }
    write_picture(image, folder / fmt::format("{}_{:03}.png", name, z / planes_per_picture), guard);
  }
}

}  // namespace

void write_snerg(const SnergScene& scene, const fs::path& folder, const SourceGuard& guard) {
  const auto [width, height, depth] = scene.atlas;
  json rotation = json::array();
  for (Eigen::Index r = 0; r < 4; ++r) {
    json row = json::array();
    for (Eigen::Index c = 0; c < 4; ++c)
      row.push_back(r < 3 && c < 3 ? scene.world_from_opengl(r, c) : r == c ? 1.0 : 0.0);
    rotation.push_back(std::move(row));
  }
  const json parameters{{"voxel_size", scene.voxel_size},
                        {"block_size", scene.block_size},
                        {"grid_width", scene.grid[0]},
                        {"grid_height", scene.grid[1]},
                        {"grid_depth", scene.grid[2]},
                        {"atlas_width", width},
                        {"atlas_height", height},
                        {"atlas_depth", depth},
                        {"num_slices", (depth + planes_per_picture - 1) / planes_per_picture},
                        {"min_x", scene.min.x()},
                        {"min_y", scene.min.y()},
                        {"min_z", scene.min.z()},
                        {"atlas_blocks_x", scene.atlas_blocks[0]},
                        {"atlas_blocks_y", scene.atlas_blocks[1]},
                        {"atlas_blocks_z", scene.atlas_blocks[2]},
                        {"worldspace_T_opengl", rotation},
                        {"ndc", false},
                        {"0_weights", rows_of(scene.decoder.weights0)},
                        {"1_weights", rows_of(scene.decoder.weights1)},
                        {"2_weights", rows_of(scene.decoder.weights2)},
                        {"0_bias", list_of(scene.decoder.bias0)},
                        {"1_bias", list_of(scene.decoder.bias1)},
                        {"2_bias", list_of(scene.decoder.bias2)},
                        {"format", "png"}};
  const auto blocks = scene.blocks();
  Image indices{blocks[0], blocks[1] * blocks[2], {}, {}};
  for (const auto& place : scene.block_places) indices.rgb.insert(indices.rgb.end(), place.begin(), place.end());
  write_picture(indices, folder / "atlas_indices.png", guard);
  write_planes(scene.colors, "rgba", scene, folder, guard);
  write_planes(scene.features, "feature", scene, folder, guard);
  write_file_atomically(folder / "scene_params.json", parameters.dump(), guard);
}

SnergScene read_snerg(const fs::path& folder) {
  const fs::path file = folder / "scene_params.json";
  const Fields fields(file);
  if (fields.truth("ndc"))
    throw FileError(file, "\"ndc\" is set: scenes in normalised device coordinates are not supported");
  SnergScene scene;
  scene.voxel_size = fields.number("voxel_size");
  if (scene.voxel_size <= 0) fields.wrong("voxel_size", "greater than 0");
  scene.block_size = fields.whole("block_size", 1024);
  scene.grid = {fields.whole("grid_width", largest_side), fields.whole("grid_height", largest_side),
                fields.whole("grid_depth", largest_side)};
  scene.atlas_blocks = {fields.whole("atlas_blocks_x", 255), fields.whole("atlas_blocks_y", 255),
                        fields.whole("atlas_blocks_z", 255)};
  const auto needed = scene.atlas_needed();
  for (std::size_t a = 0; a < 3; ++a) {
    static constexpr const char* names[] = {"atlas_width", "atlas_height", "atlas_depth"};
    scene.atlas[a] = fields.whole(names[a], largest_side);
    if (scene.atlas[a] < needed[a])
      fields.wrong(names[a], fmt::format("at least {}, the number of blocks times (block_size + 2)", needed[a]));
  }
  scene.min = {fields.number("min_x"), fields.number("min_y"), fields.number("min_z")};
  scene.world_from_opengl = fields.matrix("worldspace_T_opengl", 4, 4).topLeftCorner<3, 3>();
  SnergDecoder& decoder = scene.decoder;
  decoder.weights0 = fields.matrix("0_weights", SnergDecoder::inputs, -1);
  decoder.weights1 = fields.matrix("1_weights", decoder.weights0.cols(), -1);
  decoder.weights2 = fields.matrix("2_weights", decoder.weights1.cols(), 3);
  decoder.bias0 = fields.vector("0_bias", decoder.weights0.cols());
  decoder.bias1 = fields.vector("1_bias", decoder.weights1.cols());
  decoder.bias2 = fields.vector("2_bias", 3);
  const auto blocks = scene.blocks();
  const fs::path index_file = folder / "atlas_indices.png";
  const Image indices = picture_of(index_file, blocks[0], blocks[1] * blocks[2], AlphaChannel::drop);
  scene.block_places.resize(product(blocks));
  for (std::size_t b = 0; b < scene.block_places.size(); ++b) {
    for (std::size_t c = 0; c < 3; ++c) scene.block_places[b][c] = indices.rgb[3 * b + c];
    const auto& place = scene.block_places[b];
    for (std::size_t c = 0; c < 3; ++c)
      if (place[0] != 255 && place[c] >= scene.atlas_blocks[c])
        throw FileError(index_file,
                        fmt::format("names block ({}, {}, {}) of the atlas, which has {} × {} × {}", place[0], place[1],
                                    place[2], scene.atlas_blocks[0], scene.atlas_blocks[1], scene.atlas_blocks[2]));
  }
  scene.colors = planes(folder, "rgba", scene);
  scene.features = planes(folder, "feature", scene);
  return scene;
}

}  // namespace rebake
