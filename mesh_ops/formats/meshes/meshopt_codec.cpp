#include "mesh_ops/formats/meshes/meshopt_codec.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

const unsigned char* data_of(std::string_view bytes) { return reinterpret_cast<const unsigned char*>(bytes.data()); }
unsigned char* data_of(std::string& bytes) { return reinterpret_cast<unsigned char*>(bytes.data()); }

std::size_t whole_number(const nlohmann::json& extension, const char* key, std::size_t least, std::size_t most) {
  const auto found = extension.find(key);
  if (found == extension.end() || !found->is_number_unsigned() || *found < least || *found > most)
    throw FieldError(key, fmt::format("must be a whole number from {} to {}", least, most));
  return found->get<std::size_t>();
}

// Undoes the filter of normals, rotations and floats.
void unfilter(const std::string& filter, std::size_t count, std::size_t stride, std::string& bytes) {
  if (filter == "NONE") return;
  if (filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    return meshopt_decodeFilterOct(bytes.data(), count, stride);
  if (filter == "QUATERNION" && stride == 8) return meshopt_decodeFilterQuat(bytes.data(), count, stride);
  if (filter == "EXPONENTIAL" && stride % 4 == 0) return meshopt_decodeFilterExp(bytes.data(), count, stride);
  throw FieldError("filter", fmt::format("\"{}\" is not a filter for elements of {} bytes", filter, stride));
}

}  // namespace

std::string meshopt_attributes(std::string_view bytes, std::size_t count, std::size_t stride) {
  meshopt_encodeVertexVersion(0);  // that of the extension
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(data_of(packed), packed.size(), bytes.data(), count, stride));
  return packed;
}

std::string meshopt_triangles(std::string_view bytes) {
  meshopt_encodeIndexVersion(1);  // that of the extension
  const std::size_t count = bytes.size() / sizeof(unsigned);
  std::vector<unsigned> indices(count);
  std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<char*>(indices.data()));
  unsigned largest = 0;
  for (const unsigned index : indices) largest = std::max(largest, index);
  std::string packed(meshopt_encodeIndexBufferBound(count, std::size_t{largest} + 1), '\0');
  packed.resize(meshopt_encodeIndexBuffer(data_of(packed), packed.size(), indices.data(), count));
  return packed;
}

std::string meshopt_decoded(const nlohmann::json& extension, std::string_view bytes) {
  constexpr std::size_t most_elements = 0xffffffffU;
  const std::size_t count = whole_number(extension, "count", 1, most_elements);
  const std::string mode = extension.value("mode", ""), filter = extension.value("filter", "NONE");
  const std::size_t stride = whole_number(extension, "byteStride", 1, 256);
  // The most that the format can compress, so that damaged numbers do not allocate all memory.
  constexpr std::size_t most_compression = 64, largest_element = 256;
  if (count * stride > most_compression * (bytes.size() + largest_element))
    throw FieldError("count", "is more than the compressed bytes can hold");
  std::string result(count * stride, '\0');
  int status = 0;
  if (mode == "ATTRIBUTES" && stride % 4 == 0) {
    status = meshopt_decodeVertexBuffer(result.data(), count, stride, data_of(bytes), bytes.size());
    if (status == 0) unfilter(filter, count, stride, result);
  } else if (mode == "TRIANGLES" && count % 3 == 0 && (stride == 2 || stride == 4)) {
    status = meshopt_decodeIndexBuffer(result.data(), count, stride, data_of(bytes), bytes.size());
  } else if (mode == "INDICES" && (stride == 2 || stride == 4)) {
    status = meshopt_decodeIndexSequence(result.data(), count, stride, data_of(bytes), bytes.size());
  } else {
    throw FieldError("mode", fmt::format("\"{}\" with elements of {} bytes is not valid", mode, stride));
  }
  if (status != 0) throw FieldError("EXT_meshopt_compression", "the compressed bytes are damaged");
  return result;
}

}  // namespace rebake
