#include "mesh_ops/formats/meshes/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/meshes/beside.h"
#include "mesh_ops/formats/meshes/meshopt_codec.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

constexpr std::array<const char*, 5> known_extensions{"KHR_materials_unlit", "KHR_texture_transform",
                                                      "KHR_mesh_quantization", "EXT_texture_webp", meshopt_extension};

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k)
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[at + k])) << 8 * k;
  return value;
}

// A component type of accessors: its size, and how a value is read.
struct Component {
  std::size_t code, size;
  double largest;  // divisor of normalised integers; 0 for floats
  double (*read)(const char* bytes);
};
template <class T>
double read_as(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}
constexpr Component components_table[] = {
    {5120, 1, 127, read_as<std::int8_t>},    {5121, 1, 255, read_as<std::uint8_t>},
    {5122, 2, 32767, read_as<std::int16_t>}, {5123, 2, 65535, read_as<std::uint16_t>},
    {5125, 4, 0, read_as<std::uint32_t>},    {5126, 4, 0, read_as<float>},
};

std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  return 0;
}

std::string from_base64(std::string_view text, const GltfDocument& document) {
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) document.fail("a data URI is not valid base64");
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

// The text with %20 and the like decoded.
std::string unescaped(const std::string& uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    unsigned value = 0;
    if (uri[k] == '%' && k + 2 < uri.size() && std::sscanf(uri.c_str() + k + 1, "%2x", &value) == 1) {
      text += static_cast<char>(value);
      k += 2;
    } else {
      text += uri[k];
    }
  }
  return text;
}

}  // namespace

void GltfDocument::fail(const std::string& what) const { throw FileError(file_, what); }

GltfDocument::GltfDocument(const fs::path& file) : file_(file), bytes_(read_file(file)) {
  const std::string text = bytes_.starts_with("glTF") ? read_container(bytes_) : bytes_;
  try {
    root_ = json::parse(text, [this](int depth, json::parse_event_t, json&) {
      // No element is nested deeper, and deep nesting could exhaust the stack.
      constexpr int deepest = 64;
      if (depth > deepest) fail(fmt::format("is nested deeper than {} levels", deepest));
      return true;
    });
  } catch (const json::exception& error) {
    fail(fmt::format("is not valid JSON: {}", error.what()));
  }
  if (!root_.is_object() || !root_.contains("asset")) fail("is not a glTF file: \"asset\" is missing");
  const json& asset = root_.at("asset");
  const std::string version = asset.is_object() && asset.contains("version") && asset.at("version").is_string()
                                  ? asset.at("version").get<std::string>()
                                  : "";
  if (!version.starts_with("2.")) fail("is not glTF 2.0");
  for (const json& extension : elements("extensionsRequired"))
    if (std::find(known_extensions.begin(), known_extensions.end(), extension) == known_extensions.end())
      fail(fmt::format("requires the extension {}, which is not supported: export it without compression",
                       extension.dump()));
  read_buffers();
}

// Splits a .glb into its JSON, which is returned, and its binary chunk.
std::string GltfDocument::read_container(std::string_view bytes) {
  if (bytes.size() < 20 || little_endian(bytes, 4) != 2) fail("is not a glTF 2.0 container");
  if (little_endian(bytes, 8) > bytes.size()) fail("is truncated");
  std::string text;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t length = little_endian(bytes, at), type = little_endian(bytes, at + 4);
    if (length > bytes.size() - at - 8) fail("is truncated: a chunk is incomplete");
    constexpr std::size_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;
    if (type == json_chunk && text.empty()) text = bytes.substr(at + 8, length);
    if (type == binary_chunk && binary_.empty()) binary_ = bytes.substr(at + 8, length);
    at += 8 + length;
  }
  return text;
}

void GltfDocument::read_buffers() {
  const json& list = elements("buffers");
  fetched_.reserve(list.size());  // buffers_ refers to its elements
  for (std::size_t k = 0; k < list.size(); ++k) {
    const json& buffer = element("buffers", k);
    if (buffer.contains("uri") && buffer.at("uri").is_string()) {
      fetched_.push_back(fetched(buffer.at("uri").get<std::string>()));
      buffers_.emplace_back(fetched_.back());
    } else {
      buffers_.push_back(k == 0 ? binary_ : std::string_view());
    }
    // Stands for the decompressed bytes, and has none.
    const json& extensions = buffer.value("extensions", json::object());
    if (buffers_.back().empty() && extensions.is_object() && extensions.contains(meshopt_extension)) continue;
    if (buffers_.back().size() < number(buffer, "byteLength")) fail(fmt::format("buffer {} is too short", k));
  }
}

const json& GltfDocument::elements(const char* list) const {
  static const json none = json::array();
  const auto found = root_.find(list);
  if (found == root_.end()) return none;
  if (!found->is_array()) fail(fmt::format("\"{}\" is not a list", list));
  return *found;
}

const json& GltfDocument::element(const char* list, std::size_t index) const {
  const json& all = elements(list);
  if (index >= all.size()) fail(fmt::format("\"{}\" has {} elements, but number {} is used", list, all.size(), index));
  if (!all[index].is_object()) fail(fmt::format("\"{}\"[{}] is not an object", list, index));
  return all[index];
}

std::size_t GltfDocument::number(const json& element, const char* key, std::size_t otherwise) const {
  const auto found = element.find(key);
  if (found == element.end()) return otherwise;
  if (!found->is_number_unsigned() || *found > 0xffffffffU) fail(fmt::format("\"{}\" is not a whole number", key));
  return found->get<std::size_t>();
}

std::size_t GltfDocument::number(const json& element, const char* key) const {
  if (!element.contains(key)) fail(fmt::format("\"{}\" is missing", key));
  return number(element, key, 0);
}

std::string_view GltfDocument::decompressed(std::size_t index, const json& extension) const {
  const auto [known, added] = decompressed_.try_emplace(index);
  if (!added) return known->second;
  if (!extension.is_object()) fail(fmt::format("buffer view {}: {} is not an object", index, meshopt_extension));
  try {
    known->second = meshopt_decoded(extension, slice(index, extension));
  } catch (const FieldError& error) {
    fail(fmt::format("buffer view {}: {}", index, error.what()));
  } catch (const json::exception&) {
    fail(fmt::format("buffer view {}: {} is not valid", index, meshopt_extension));
  }
  return known->second;
}

std::string_view GltfDocument::view(std::size_t index) const {
  const json& made = element("bufferViews", index);
  if (const auto extensions = made.find("extensions");
      extensions != made.end() && extensions->is_object() && extensions->contains(meshopt_extension))
    return decompressed(index, extensions->at(meshopt_extension));
  return slice(index, made);
}

std::string_view GltfDocument::slice(std::size_t index, const json& made) const {
  const std::size_t buffer = number(made, "buffer"), offset = number(made, "byteOffset", 0),
                    length = number(made, "byteLength");
  if (buffer >= buffers_.size() || offset > buffers_[buffer].size() || length > buffers_[buffer].size() - offset)
    fail(fmt::format("buffer view {} is outside its buffer", index));
  return buffers_[buffer].substr(offset, length);
}

std::vector<double> GltfDocument::numbers(std::size_t accessor, std::size_t components) const {
  const json& made = element("accessors", accessor);
  if (made.contains("sparse")) fail(fmt::format("accessor {} is sparse, which is not supported", accessor));
  const std::size_t code = number(made, "componentType"), count = number(made, "count");
  const auto component = std::find_if(std::begin(components_table), std::end(components_table),
                                      [&](const Component& one) { return one.code == code; });
  const json type = made.value("type", json());
  if (component == std::end(components_table) || !type.is_string() ||
      components_of(type.get<std::string>()) != components)
    fail(fmt::format("accessor {} does not have {} components of a known type", accessor, components));
  const std::string_view bytes = view(number(made, "bufferView"));
  const json& in = element("bufferViews", number(made, "bufferView"));
  const std::size_t size = components * component->size, stride = number(in, "byteStride", size),
                    offset = number(made, "byteOffset", 0);
  if (stride < size || count > bytes.size() + 1 || offset > bytes.size() ||
      (count > 0 && (count - 1) * stride + size > bytes.size() - offset))
    fail(fmt::format("accessor {} is outside its buffer view", accessor));
  const json normalised = made.value("normalized", json(false));
  const double divisor =
      normalised.is_boolean() && normalised.get<bool>() && component->largest > 0 ? component->largest : 1;
  std::vector<double> values(count * components);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const char* at = bytes.data() + offset + k / components * stride + k % components * component->size;
    values[k] = std::max(component->read(at) / divisor, divisor > 1 ? -1.0 : -INFINITY);
    if (!std::isfinite(values[k])) fail(fmt::format("accessor {} has a number that is not finite", accessor));
  }
  return values;
}

std::vector<std::uint32_t> GltfDocument::indices(std::size_t accessor) const {
  std::vector<std::uint32_t> result;
  for (const double value : numbers(accessor, 1)) {
    if (!(value >= 0 && value == std::floor(value))) fail(fmt::format("accessor {} has a negative index", accessor));
    result.push_back(static_cast<std::uint32_t>(value));
  }
  return result;
}

std::string GltfDocument::fetched(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) fail("a data URI is not base64");
    return from_base64(std::string_view(uri).substr(comma + 8), *this);
  }
  return read_beside(file_.parent_path(), path_beside(file_.parent_path(), unescaped(uri), file_), file_);
}

std::vector<fs::path> GltfDocument::files() const {
  std::vector<fs::path> found;
  for (const char* list : {"buffers", "images"})
    for (const json& one : elements(list))
      if (one.is_object() && one.contains("uri") && one.at("uri").is_string())
        if (const auto uri = one.at("uri").get<std::string>(); !uri.starts_with("data:")) try {
            found.push_back(path_beside(file_.parent_path(), unescaped(uri), file_));
          } catch (const FileError&) {
            // Reading refuses it if it is used; one that is not must not hide the others.
          }
  return found;
}

}  // namespace rebake
