#include "editor/studies/representations/marched_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

// Sums of products as GLSL, one local variable per neuron: `to`0, `to`1, …
std::string layer_text(const Eigen::MatrixXd& weights, const Eigen::VectorXd& bias, const char* from, const char* to,
                       bool rectified) {
  std::string out;
  for (Eigen::Index o = 0; o < weights.cols(); ++o) {
    std::string sum = fmt::format("{:.9e}", bias[o]);
    for (Eigen::Index i = 0; i < weights.rows(); ++i) sum += fmt::format(" + {:.9e} * {}{}", weights(i, o), from, i);
    out += rectified ? fmt::format("  float {}{} = max({}, 0.0);\n", to, o, sum)
                     : fmt::format("  float {}{} = {};\n", to, o, sum);
  }
  return out;
}

// The network as a GLSL function with constant weights.
std::string network_text(const SnergDecoder& decoder) {
  std::string out = "vec3 view_dependence(vec3 color, vec4 features, vec3 direction) {\n";
  for (int k = 0; k < SnergDecoder::inputs; ++k) {
    const char axis = "xyz"[k % 3];
    std::string value;
    if (k < 3)
      value = fmt::format("direction.{}", axis);
    else if (k < SnergDecoder::encoding)
      value = fmt::format("{}({:.1f} * direction.{})", k < 15 ? "sin" : "cos", std::ldexp(1.0, (k - 3) % 12 / 3), axis);
    else if (k < SnergDecoder::encoding + 3)
      value = fmt::format("color.{}", axis);
    else
      value = fmt::format("features.{}", "xyzw"[k - SnergDecoder::encoding - 3]);
    out += fmt::format("  float i{} = {};\n", k, value);
  }
  out += layer_text(decoder.weights0, decoder.bias0, "i", "a", true);
  out += layer_text(decoder.weights1, decoder.bias1, "a", "b", true);
  out += layer_text(decoder.weights2, decoder.bias2, "b", "c", false);
  return out + "  return 1.0 / (1.0 + exp(-vec3(c0, c1, c2)));\n}\n";
}

// One byte per 4×4×4 texels of the atlas: whether a trilinear sample within them can have opacity.
std::vector<std::uint8_t> occupied_texels(const SnergScene& scene, SnergScene::Size& size) {
  constexpr int side = 4;
  const SnergScene::Size atlas = scene.atlas;
  for (std::size_t a = 0; a < 3; ++a) size[a] = (atlas[a] + side - 1) / side;
  std::vector<std::uint8_t> occupied(
      static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2]), 0);
  std::size_t texel = 0;
  for (int z = 0; z < atlas[2]; ++z)
    for (int y = 0; y < atlas[1]; ++y)
      for (int x = 0; x < atlas[0]; ++x, ++texel) {
        if (scene.colors[4 * texel + 3] == 0) continue;
        for (int k = std::max(0, z - 1) / side; k <= std::min(atlas[2] - 1, z + 1) / side; ++k)
          for (int j = std::max(0, y - 1) / side; j <= std::min(atlas[1] - 1, y + 1) / side; ++j)
            for (int i = std::max(0, x - 1) / side; i <= std::min(atlas[0] - 1, x + 1) / side; ++i)
              occupied[(static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) + static_cast<std::size_t>(j)) *
                           static_cast<std::size_t>(size[0]) +
                       static_cast<std::size_t>(i)] = 255;
      }
  return occupied;
}

Vec3 vector_of(const SnergScene::Size& size) {
  return {static_cast<double>(size[0]), static_cast<double>(size[1]), static_cast<double>(size[2])};
}

}  // namespace

MarchedVolume::MarchedVolume(const SnergScene& scene, gl::Context& context) : context_(context) {
  const gl::CurrentContextScope current(context_);
  // Destroyed before the context is left, if an upload fails.
  auto program = std::make_unique<gl::PixelProgram>("studies/snerg.frag", network_text(scene.decoder));
  std::vector<std::uint8_t> places;
  for (const auto& place : scene.block_places) places.insert(places.end(), place.begin(), place.end());
  program->add_volume("blocks", 3, scene.blocks(), places.data(), false);
  SnergScene::Size coarse{};
  const std::vector<std::uint8_t> occupied = occupied_texels(scene, coarse);
  program->add_volume("occupied", 1, coarse, occupied.data(), false);
  program->add_volume("colors", 4, scene.atlas, scene.colors.data(), true);
  program->add_volume("features", 4, scene.atlas, scene.features.data(), true);
  program->set("grid_min", scene.min);
  program->set("grid_size", vector_of(scene.grid));
  program->set("atlas_size", vector_of(scene.atlas));
  program->set("voxel_size", scene.voxel_size);
  program->set("block_size", static_cast<double>(scene.block_size));
  program->set("world_from_opengl", scene.world_from_opengl);
  program_ = std::move(program);
}

MarchedVolume::MarchedVolume(const PlenOctree& tree, gl::Context& context) : context_(context) {
  const gl::CurrentContextScope current(context_);
  // Only leaves that are not empty get a record.
  const std::size_t numbers = tree.record(), texels = (numbers + 3) / 4;
  std::vector<std::int32_t> children;
  std::vector<std::array<std::uint16_t, 4>> values;
  std::int32_t records = 0;
  for (std::size_t node = 0; node < tree.children.size(); ++node)
    for (std::size_t k = 0; k < 8; ++k) {
      const std::int32_t child = tree.children[node][k];
      const Eigen::half* leaf = tree.leaf(node, k);
      if (child != 0 || !(static_cast<float>(leaf[numbers - 1]) > 0)) {
        children.push_back(child == 0 ? 0 : static_cast<std::int32_t>(node) + child);
        continue;
      }
      children.push_back(-1 - records++);
      for (std::size_t t = 0; t < texels; ++t) {
        std::array<std::uint16_t, 4> texel{};
        for (std::size_t c = 0; c < 4 && 4 * t + c < numbers; ++c) texel[c] = leaf[4 * t + c].x;
        values.push_back(texel);
      }
    }
  if (values.empty()) values.push_back({});
  auto program = std::make_unique<gl::PixelProgram>(
      "studies/plenoctree.frag", fmt::format("#define BASIS {}\n#define RECORD {}\n", tree.basis, texels));
  program->add_numbers("children", children);
  program->add_vectors("values", values);
  program->set("tree_offset", tree.offset);
  program->set("tree_scale", tree.scale);
  program_ = std::move(program);
}

MarchedVolume::~MarchedVolume() {
  const gl::CurrentContextScope current(context_);
  program_.reset();
}

std::uint64_t MarchedVolume::gpu_bytes() const { return program_->bytes(); }

void MarchedVolume::aim(const View& view) {
  check(view);
  if (view.camera.orthographic()) throw FieldError("camera", "must be a pinhole camera for marched volumes");
  const double up = std::tan(view.camera.fov_degrees / 2 * std::numbers::pi / 180);
  program_->set("eye", view.camera.eye);
  program_->set("camera_axes", Mat3(world_to_camera(view.camera).transpose()));
  program_->set("half_extent", up * view.width / view.height, up);
  program_->set("picture_size", view.width, static_cast<double>(view.height));
  program_->set("side", view.side());
}

Image MarchedVolume::picture(const View& view) {
  const gl::CurrentContextScope current(context_);
  aim(view);
  program_->draw(view.width, view.height);
  return {view.width, view.height, program_->picture(), {}};
}

double MarchedVolume::draw(const View& view) {
  const gl::CurrentContextScope current(context_);
  aim(view);
  const auto start = std::chrono::steady_clock::now();
  program_->draw(view.width, view.height);
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace rebake
