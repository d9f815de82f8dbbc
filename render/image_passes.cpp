#include "render/image_passes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/images/picture_codecs.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/scene/scene_light.h"
#include "render/picture_mark.h"

namespace rebake {

namespace {

constexpr float nothing_depth = 1e10F;

std::array<float, 256> linear_table() {
  std::array<float, 256> table{};
  for (std::size_t k = 0; k < table.size(); ++k) table[k] = static_cast<float>(to_linear(static_cast<double>(k) / 255));
  return table;
}

// What a ray through a sample meets.
struct SampleHit {
  double depth = std::numeric_limits<double>::infinity();
  std::size_t instance = 0;
  std::uint32_t triangle = 0;
  Vec3 world = Vec3::Zero();
};

// Rays through the samples of a view, at the positions where the renderer takes them.
class SampleRays {
 public:
  SampleRays(const Scene& scene, const View& view) : view_(view), rows_(world_to_camera(view.camera)) {
    for (const PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object) objects_.push_back(placed);
    rays_.emplace(rays_through(objects_));
  }
  const std::vector<PlacedNode>& objects() const { return objects_; }

  // The nearest hit of the samples of a pixel; `covered` gets how many hit something.
  SampleHit nearest(int x, int y, int& covered) const {
    SampleHit best;
    covered = 0;
    const int side = view_.side();
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const SampleHit hit =
            at((x + (i + 0.5) / side) / view_.width * 2 - 1, 1 - (y + (j + 0.5) / side) / view_.height * 2);
        if (std::isinf(hit.depth)) continue;
        ++covered;
        if (hit.depth < best.depth) best = hit;
      }
    return best;
  }

  // Corners of a triangle in the object's space.
  std::array<Vec3, 3> corners(const SampleHit& hit) const {
    std::uint32_t triangle = hit.triangle;
    for (const TextureSet& set : objects_[hit.instance].node->object->sets) {
      if (triangle < set.soup.triangle_count()) {
        const Face& face = set.soup.faces()[triangle];
        return {set.soup.positions()[face[0]], set.soup.positions()[face[1]], set.soup.positions()[face[2]]};
      }
      triangle -= static_cast<std::uint32_t>(set.soup.triangle_count());
    }
    throw std::logic_error("a ray met a triangle that the object does not have");
  }

 private:
  SampleHit at(double right, double up) const {
    const Camera& camera = view_.camera;
    const double aspect = static_cast<double>(view_.width) / view_.height;
    Vec3 origin = camera.eye, in_camera(0, 0, -1);
    const double half = half_height(camera, 1);
    if (camera.orthographic())
      origin += rows_.transpose() * Vec3(right * half * aspect, up * half, 0);
    else
      in_camera = {right * half * aspect, up * half, -1};
    const Vec3 direction = rows_.transpose() * in_camera;
    const auto hit = rays_->nearest(origin, direction, camera.near_plane, camera.far_plane);
    if (!hit) return {};
    return {hit->t, hit->instance, hit->triangle, origin + hit->t * direction};
  }

  View view_;
  Mat3 rows_;
  std::vector<PlacedNode> objects_;
  std::optional<SceneRays> rays_;
};

class PassRenderer {
 public:
  PassRenderer(const View& view, const std::vector<std::string>& names) : names_(names) {
    result_.width = view.width;
    result_.height = view.height;
    pixels_ = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  }
  bool wants(const char* name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

  void add_colors(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
                  const Lighting* lighting) {
    if (!wants("color") && !wants("alpha") && !wants("light")) return;
    RenderOptions how = options;
    how.transparent = wants("alpha");
    const Image picture = renderer.render(scene, view, how, lighting);
    static const std::array<float, 256> light = linear_table();
    const auto alpha = [&](const Image& image, std::size_t p) {
      return image.alpha.empty() ? 1.0F : static_cast<float>(image.alpha[p]) / 255;
    };
    if (wants("color"))
      for (const std::size_t c : {0, 1, 2})
        fill(std::string(1, "RGB"[c]), true,
             [&](std::size_t p) { return light[picture.rgb[3 * p + c]] * alpha(picture, p); });
    if (wants("alpha")) fill("A", true, [&](std::size_t p) { return alpha(picture, p); });
    if (!wants("light")) return;
    // Without corrections, nothing is drawn a second time.
    const bool changes = lighting != nullptr && !lighting->maps.empty();
    const Image baked = changes ? renderer.render(scene, view, how) : picture;
    for (const std::size_t c : {0, 1, 2})
      fill(std::string("light.") + "RGB"[c], true, [&](std::size_t p) {
        return (light[picture.rgb[3 * p + c]] - light[baked.rgb[3 * p + c]]) * alpha(picture, p);
      });
  }

  void add_geometry(const Scene& scene, const View& view) {
    if (!wants("depth") && !wants("normal") && !wants("node") && !wants("position")) return;
    const SampleRays rays(scene, view);
    std::map<NodeId, int> numbers;
    nlohmann::json names = nlohmann::json::object();
    for (const PlacedNode& placed : placed_nodes(scene)) {
      numbers.emplace(placed.node->id, static_cast<int>(numbers.size()) + 1);
      names[std::to_string(numbers.size())] = placed.node->name;
    }
    const auto begin = result_.channels.size();
    std::vector<std::string> made;
    if (wants("depth")) made.emplace_back("depth.Z");
    for (const char* layer : {"normal", "position"})
      if (wants(layer))
        for (const char axis : {'X', 'Y', 'Z'}) made.push_back(fmt::format("{}.{}", layer, axis));
    if (wants("node")) {
      made.emplace_back("node.ID");
      result_.attributes.emplace_back("rebake/nodes", names.dump());
    }
    for (const std::string& name : made) result_.channels.push_back({name, false, std::vector<float>(pixels_)});
    tbb::parallel_for(0, view.height, [&](int y) {
      for (int x = 0; x < view.width; ++x) {
        int covered = 0;
        const SampleHit hit = rays.nearest(x, y, covered);
        std::size_t channel = begin;
        const auto put = [&](double value) {
          result_.channels[channel++].values[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                                             static_cast<std::size_t>(x)] = static_cast<float>(value);
        };
        if (wants("depth")) put(covered == 0 ? nothing_depth : hit.depth);
        const Affine to_world = covered == 0 ? Affine::Identity() : rays.objects()[hit.instance].to_world;
        if (wants("normal")) {
          const Vec3 normal = covered == 0 ? Vec3(Vec3::Zero()) : facing_normal(rays.corners(hit), to_world, view, hit);
          for (const double value : normal) put(value);
        }
        if (wants("position")) {
          const Vec3 at = covered == 0 ? Vec3(Vec3::Zero()) : Vec3(to_world.inverse() * hit.world);
          for (const double value : at) put(value);
        }
        if (wants("node")) put(covered == 0 ? 0 : numbers.at(rays.objects()[hit.instance].node->id));
      }
    });
  }

  ImagePasses take() { return std::move(result_); }

 private:
  static Vec3 facing_normal(const std::array<Vec3, 3>& corners, const Affine& to_world, const View& view,
                            const SampleHit& hit) {
    const Mat3& m = to_world.linear();
    const Vec3 normal = (m * (corners[1] - corners[0])).cross(m * (corners[2] - corners[0])).stableNormalized();
    const Vec3 to_eye =
        view.camera.orthographic() ? Vec3(view.camera.eye - view.camera.target) : Vec3(view.camera.eye - hit.world);
    return normal.dot(to_eye) < 0 ? Vec3(-normal) : normal;
  }

  template <class Value>
  void fill(const std::string& name, bool half, const Value& value) {
    ImagePasses::Channel channel{name, half, std::vector<float>(pixels_)};
    for (std::size_t p = 0; p < pixels_; ++p) channel.values[p] = value(p);
    result_.channels.push_back(std::move(channel));
  }

  const std::vector<std::string>& names_;
  ImagePasses result_;
  std::size_t pixels_ = 0;
};

// Name of the layer of a channel: "depth" of "depth.Z", "color" of "R". Alpha is part of the colours, if there are any.
std::string layer_of(const std::string& channel, bool colors) {
  const std::size_t dot = channel.find('.');
  return dot != std::string::npos ? channel.substr(0, dot) : colors ? "color" : "alpha";
}

void write_channels(const ImagePasses& passes, const std::vector<const ImagePasses::Channel*>& channels,
                    const std::filesystem::path& path, const SourceGuard& guard) {
  check_picture_path(path, guard);
  const std::size_t pixels = static_cast<std::size_t>(passes.width) * static_cast<std::size_t>(passes.height);
  std::vector<FloatChannel> names;
  std::vector<float> interleaved(pixels * channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c) {
    names.push_back({channels[c]->name, channels[c]->half});
    for (std::size_t p = 0; p < pixels; ++p) interleaved[p * channels.size() + c] = channels[c]->values[p];
  }
  std::string bytes, error;
  std::vector<std::pair<std::string, std::string>> attributes{openexr_mark};
  attributes.insert(attributes.end(), passes.attributes.begin(), passes.attributes.end());
  if (!picture_codecs(path).encode_exr(passes.width, passes.height, names, attributes, interleaved.data(), bytes,
                                       error))
    throw FileError(path, "cannot be encoded: " + picture_problem(error, path));
  write_file_atomically(path, with_mark(bytes, passes.width, passes.height, false), guard);
}

}  // namespace

const ImagePasses::Channel* ImagePasses::find(const std::string& name) const {
  const auto found =
      std::find_if(channels.begin(), channels.end(), [&](const Channel& channel) { return channel.name == name; });
  return found == channels.end() ? nullptr : &*found;
}

void check_pass_names(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (std::find(image_pass_names.begin(), image_pass_names.end(), name) == image_pass_names.end())
      throw FieldError("passes",
                       fmt::format("\"{}\" is not known (known: {})", name, fmt::join(image_pass_names, ", ")));
}

ImagePasses render_passes(Renderer& renderer, const Scene& scene, const View& view, const RenderOptions& options,
                          const Lighting* lighting, const std::vector<std::string>& names) {
  check_pass_names(names);
  check(view);
  PassRenderer passes(view, names);
  passes.add_colors(renderer, scene, view, options, lighting);
  passes.add_geometry(scene, view);
  return passes.take();
}

std::vector<std::filesystem::path> pass_files(const std::vector<std::string>& names,
                                              const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files;
  const bool colors = std::find(names.begin(), names.end(), "color") != names.end();
  for (const std::string& name : names) {
    std::filesystem::path file = path;
    file.replace_extension(fmt::format(".{}.exr", name));
    if (name != "alpha" || !colors) files.push_back(file);
  }
  return files;
}

void write_passes(const ImagePasses& passes, const std::filesystem::path& path, bool separate,
                  const SourceGuard& guard) {
  std::map<std::string, std::vector<const ImagePasses::Channel*>> layers;
  for (const ImagePasses::Channel& channel : passes.channels)
    layers[separate ? layer_of(channel.name, passes.find("R") != nullptr) : ""].push_back(&channel);
  for (const auto& [layer, channels] : layers) {
    std::filesystem::path file = path;
    if (separate) file.replace_extension(fmt::format(".{}.exr", layer));
    write_channels(passes, channels, file, guard);
  }
}

}  // namespace rebake
