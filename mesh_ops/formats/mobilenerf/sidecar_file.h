#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Builds a sidecar file: a file of Rebake beside the files of a MobileNeRF folder, with values that those cannot hold.
/// Numbers are little-endian:
///
///     8 letters that name the kind, u32 version, u64 XXH64 of the remaining bytes, u32 number of sets with values;
///     per such set, in ascending order: u32 set number, u32 number of its faces, data of the kind
///
/// Faces are numbered as in the folder's files, since writing chunks renumbers vertices but not faces.
class SidecarWriter {
 public:
  /// `mark`: 8 letters.
  SidecarWriter(std::string_view mark, std::uint32_t version) : mark_(mark), version_(version) {}
  /// Appends the data `written` of a texture set. Call it in ascending order of sets.
  void add(std::uint32_t set, std::size_t faces, std::string_view written);
  /// The whole file.
  std::string bytes() const;

 private:
  std::string mark_;
  std::uint32_t version_;
  std::uint32_t sets_ = 0;
  std::string body_;
};

/// Reads numbers from the front of the bytes of a sidecar file. Throws FileError naming the file if they end too early.
class SidecarReader {
 public:
  SidecarReader(std::string_view bytes, std::filesystem::path name) : bytes_(bytes), name_(std::move(name)) {}

  /// The next `count` bytes.
  std::string_view take(std::size_t count);
  /// A number of 4 bytes.
  std::uint32_t take_u32();
  /// A number in LEB128: 7 bits per byte, lowest bits first.
  std::uint64_t take_varint();
  /// Whether all bytes were read.
  bool done() const { return bytes_.empty(); }
  std::string_view rest() const { return bytes_; }
  const std::filesystem::path& name() const { return name_; }

 private:
  std::string_view bytes_;
  std::filesystem::path name_;
};

/// Appends a number of 4 bytes.
void put_u32(std::string& out, std::uint32_t number);
/// Appends a number in LEB128.
void put_varint(std::string& out, std::uint64_t number);

/// Checks the header of a sidecar file and calls `read_set` for each texture set in it; `read_set` may throw
/// DamagedSet. `kind` is for messages ("turns"). Throws FileError.
void read_sidecar(std::string_view bytes, const std::filesystem::path& name, std::string_view mark,
                  std::uint32_t version, std::string_view kind, std::vector<TextureSet>& sets,
                  const std::function<void(SidecarReader&, TextureSet&)>& read_set);

/// Thrown if the data of a texture set contradicts its mesh. `what` completes the message "set 3: …".
struct DamagedSet {
  std::string what;
};

/// Encodes values per vertex (`size` bytes each in `values`) by the corners of faces:
///
///     u32 number of distinct values, u32 bytes of the runs; the values in order of first use; the runs of faces
///
/// Runs are put_varint() numbers. 2n: n faces whose corners all have the `neutral` value. 2n + 1: n other faces,
/// followed by one number per corner: 0 for the next new value, or k for the k-th last of the values so far. Throws
/// Error if the runs exceed 4 GB.
std::string corner_values(const std::vector<Face>& faces, std::string_view values, std::size_t size,
                          std::string_view neutral);
/// Decodes values of `vertices` vertices, `size` bytes each. Throws FileError, DamagedSet.
std::string read_corner_values(SidecarReader& reader, const std::vector<Face>& faces, std::size_t vertices,
                               std::size_t size, std::string_view neutral);

}  // namespace rebake
