#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/types.h"

namespace rebake {

/// The JSON and the buffers of a glTF 2.0 file, with checked access. All functions throw FileError, naming the file and
/// the element.
class GltfDocument {
 public:
  explicit GltfDocument(const std::filesystem::path& file);

  /// An element of a top-level list such as "meshes".
  const nlohmann::json& element(const char* list, std::size_t index) const;
  /// The elements of a top-level list; empty if there is none.
  const nlohmann::json& elements(const char* list) const;
  const nlohmann::json& root() const { return root_; }
  /// Values of an accessor as doubles, `components` per element; normalised integers become 0 … 1 or −1 … 1.
  std::vector<double> numbers(std::size_t accessor, std::size_t components) const;
  /// Values of an accessor of unsigned integers.
  std::vector<std::uint32_t> indices(std::size_t accessor) const;
  /// The bytes of a buffer view.
  std::string_view view(std::size_t index) const;
  /// The bytes behind a URI: data: or a file beside this one.
  std::string fetched(const std::string& uri) const;
  /// The files beside this one that buffers and images refer to, relative to its folder.
  std::vector<std::filesystem::path> files() const;
  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(const std::string& what) const;

  /// An unsigned number of an element, such as "bufferView"; `otherwise` if it is absent.
  std::size_t number(const nlohmann::json& element, const char* key, std::size_t otherwise) const;
  /// As number(), but it must be there.
  std::size_t number(const nlohmann::json& element, const char* key) const;

 private:
  // The bytes that an object with buffer, byteOffset and byteLength refers to. `index`: of its buffer view.
  std::string_view slice(std::size_t index, const nlohmann::json& made) const;
  std::string_view decompressed(std::size_t index, const nlohmann::json& extension) const;
  std::string read_container(std::string_view bytes);
  void read_buffers();

  std::filesystem::path file_;
  std::string bytes_;        // of the file
  std::string_view binary_;  // binary chunk of a .glb
  nlohmann::json root_;
  std::vector<std::string> fetched_;  // buffers with a URI
  std::vector<std::string_view> buffers_;
  mutable std::map<std::size_t, std::string> decompressed_;  // buffer views with EXT_meshopt_compression
};

}  // namespace rebake
