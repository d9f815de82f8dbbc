#include "mesh_ops/formats/glb_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "mesh_ops/formats/meshes/meshopt_codec.h"

namespace rebake {

namespace {

using nlohmann::json;

constexpr const char* generator = "Rebake";
constexpr int vertex_target = 34962, index_target = 34963, nearest = 9728, clamp_to_edge = 33071;

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

}  // namespace

GlbFile::GlbFile(const GltfCompression& compression) : compression_(compression) {
  for (const char* list : {"nodes", "meshes", "materials", "textures", "images", "accessors", "bufferViews"})
    root_[list] = json::array();
  root_["asset"] = {{"version", "2.0"}, {"generator", generator}};
  root_["extensionsUsed"] = {"KHR_materials_unlit"};
  for (const auto& [used, name] : {std::pair(compression_.quantized, "KHR_mesh_quantization"),
                                   {compression_.meshopt, meshopt_extension},
                                   {compression_.webp, "EXT_texture_webp"}})
    if (used) {
      root_["extensionsUsed"].push_back(name);
      root_["extensionsRequired"].push_back(name);
    }
  root_["samplers"] = json::array(
      {{{"magFilter", nearest}, {"minFilter", nearest}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}}});
}

std::size_t GlbFile::add(const char* list, json value) {
  root_[list].push_back(std::move(value));
  return root_[list].size() - 1;
}

std::size_t GlbFile::add_view(const void* data, std::size_t size, int target) {
  bytes_.resize(padded(bytes_.size()), '\0');
  json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
  if (target != 0) view["target"] = target;
  bytes_.append(static_cast<const char*>(data), size);
  return add("bufferViews", view);
}

std::size_t GlbFile::add_geometry(const void* data, std::size_t count, std::size_t stride) {
  const std::size_t element = stride > 0 ? stride : sizeof(std::uint32_t);
  const std::string_view bytes(static_cast<const char*>(data), count * element);
  const int target = stride > 0 ? vertex_target : index_target;
  std::size_t view = 0;
  if (!compression_.meshopt) {
    view = add_view(data, bytes.size(), target);
  } else {
    const std::string packed = stride > 0 ? meshopt_attributes(bytes, count, stride) : meshopt_triangles(bytes);
    view = add_view(packed.data(), packed.size(), target);
    json& made = at("bufferViews", view);
    const json compressed = {{"buffer", 0},
                             {"byteOffset", made.at("byteOffset")},
                             {"byteLength", packed.size()},
                             {"byteStride", element},
                             {"count", count},
                             {"mode", stride > 0 ? "ATTRIBUTES" : "TRIANGLES"}};
    decompressed_ = padded(decompressed_);
    made = {{"buffer", 1},
            {"byteOffset", decompressed_},
            {"byteLength", bytes.size()},
            {"target", target},
            {"extensions", {{meshopt_extension, compressed}}}};
    decompressed_ += bytes.size();
  }
  if (stride > 0) at("bufferViews", view)["byteStride"] = stride;
  return view;
}

std::size_t GlbFile::add_accessor(std::size_t view, int type, std::size_t count, const char* shape) {
  return add("accessors", {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}});
}

std::size_t GlbFile::add_floats(const std::vector<float>& values, std::size_t count, const char* shape) {
  return add_accessor(add_view(values.data(), values.size() * sizeof(float)), float_type, count, shape);
}

std::size_t GlbFile::add_times(const std::vector<double>& seconds) {
  // Times of jumps are so close that they may be the same float.
  std::vector<float> times;
  for (const double time : seconds)
    times.push_back(times.empty() ? static_cast<float>(time)
                                  : std::max(static_cast<float>(time),
                                             std::nextafter(times.back(), std::numeric_limits<float>::infinity())));
  const std::size_t accessor = add_floats(times, times.size(), "SCALAR");
  at("accessors", accessor)["min"] = {times.front()};
  at("accessors", accessor)["max"] = {times.back()};
  return accessor;
}

void GlbFile::add_channel(std::size_t node, const char* path, std::size_t times, std::size_t values, bool step) {
  channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", node}, {"path", path}}}});
  samplers_.push_back({{"input", times}, {"output", values}, {"interpolation", step ? "STEP" : "LINEAR"}});
}

void GlbFile::finish(json roots) {
  root_["scenes"] = {{{"nodes", std::move(roots)}}};
  root_["scene"] = 0;
  if (!channels_.empty())
    root_["animations"] = json::array({{{"name", "keyframes"}, {"channels", channels_}, {"samplers", samplers_}}});
  root_["buffers"] = json::array({{{"byteLength", bytes_.size()}}});
  // Stands for the decompressed bytes.
  if (compression_.meshopt)
    root_["buffers"].push_back(
        {{"byteLength", decompressed_}, {"extensions", {{meshopt_extension, {{"fallback", true}}}}}});
}

std::string GlbFile::bytes() const {
  std::string text = root_.dump(-1, ' ', false, json::error_handler_t::replace), buffer = bytes_;
  text.resize(padded(text.size()), ' ');
  buffer.resize(padded(buffer.size()), '\0');
  std::string file = "glTF";
  const auto add_number = [&](std::size_t value) {
    for (int shift = 0; shift < 32; shift += 8) file += static_cast<char>(value >> shift & 255U);
  };
  add_number(2);
  add_number(12 + 8 + text.size() + 8 + buffer.size());
  add_number(text.size());
  file += "JSON" + text;
  add_number(buffer.size());
  file += std::string("BIN\0", 4) + buffer;
  return file;
}

bool GlbFile::is_own(const std::string& bytes) {
  if (!bytes.starts_with("glTF") || bytes.size() < 20) return false;
  std::size_t length = 0;
  for (std::size_t k = 0; k < 4; ++k)
    length |= static_cast<std::size_t>(static_cast<unsigned char>(bytes[12 + k])) << (8 * k);
  const json root = json::parse(bytes.substr(20, length), nullptr, false);
  return root.is_object() && root.value("/asset/generator"_json_pointer, "") == generator;
}

}  // namespace rebake
