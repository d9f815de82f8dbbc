#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "mesh_ops/formats/gltf_compression.h"

namespace rebake {

/// A binary glTF 2.0 file while it is made: its lists, the bytes of its buffer and its one animation.
class GlbFile {
 public:
  /// Component types of accessors, as the format numbers them.
  static constexpr int float_type = 5126, unsigned_int_type = 5125, short_type = 5122, unsigned_short_type = 5123;

  explicit GlbFile(const GltfCompression& compression);

  const GltfCompression& compression() const { return compression_; }
  nlohmann::json& root() { return root_; }

  /// Appends to a list of the document, "nodes" for example. Returns the number in it.
  std::size_t add(const char* list, nlohmann::json value);
  nlohmann::json& at(const char* list, std::size_t number) { return root_[list][number]; }

  /// Bytes as they are.
  std::size_t add_view(const void* data, std::size_t size) { return add_view(data, size, 0); }
  /// Vertex data of `stride` bytes per vertex, or 32-bit indices of triangles (stride 0), compressed if asked for.
  std::size_t add_geometry(const void* data, std::size_t count, std::size_t stride);
  /// `shape`: "SCALAR", "VEC2", "VEC3" or "VEC4".
  std::size_t add_accessor(std::size_t view, int type, std::size_t count, const char* shape);
  std::size_t add_floats(const std::vector<float>& values, std::size_t count, const char* shape);
  /// An accessor of increasing times in seconds, with their range.
  std::size_t add_times(const std::vector<double>& seconds);
  /// A channel of the animation. `path`: what of the node it changes; `times`, `values`: accessors.
  void add_channel(std::size_t node, const char* path, std::size_t times, std::size_t values, bool step);

  /// Completes the document. `roots`: numbers of the scene's nodes.
  void finish(nlohmann::json roots);
  /// The bytes of the file; after finish().
  std::string bytes() const;

  /// Whether these are the bytes of a file that names Rebake as its generator.
  static bool is_own(const std::string& bytes);

 private:
  std::size_t add_view(const void* data, std::size_t size, int target);

  GltfCompression compression_;
  nlohmann::json root_;
  std::string bytes_;
  std::size_t decompressed_ = 0;  ///< bytes of compressed buffer views
  nlohmann::json channels_ = nlohmann::json::array(), samplers_ = nlohmann::json::array();
};

}  // namespace rebake
