#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/scene/object.h"

namespace rebake {

/// Files beside a folder's own, of what these have no place for. Numbers are little-endian:
///
///     8 letters that name the kind, u32 version, u64 XXH64 of all that follows, u32 number of texture sets with such
///     values, and of each, by number: u32 number of the set, u32 of its faces, and what the kind says
///
/// Faces are numbered as the folder's files list them: writing chunks renumbers vertices, but never faces.
class SideFile {
 public:
  SideFile(std::string_view mark, std::uint32_t version) : mark_(mark), version_(version) {}
  /// `written` is of this texture set. Sets come by number.
  void add(std::uint32_t set, std::size_t faces, std::string_view written);
  std::string bytes() const;

 private:
  std::string mark_;
  std::uint32_t version_;
  std::uint32_t sets_ = 0;
  std::string body_;
};

/// Numbers from the front of a side file's bytes. Throws FileError that names the file where they end too early.
class SideReader {
 public:
  SideReader(std::string_view bytes, std::filesystem::path name) : bytes_(bytes), name_(std::move(name)) {}

  std::string_view take(std::size_t count);
  std::uint32_t take_word();
  /// 7 bits a byte, the lowest first (LEB128).
  std::uint64_t take_short();
  /// The end of these bytes is here.
  bool done() const { return bytes_.empty(); }
  std::string_view rest() const { return bytes_; }
  const std::filesystem::path& name() const { return name_; }

 private:
  std::string_view bytes_;
  std::filesystem::path name_;
};

void put_word(std::string& out, std::uint32_t number);
void put_short(std::string& out, std::uint64_t number);

/// Checks the head of a side file; `kind` is for messages ("turns"). `read_set` reads what the kind says of a texture
/// set, and throws DamagedSet. Throws FileError.
void read_side_file(std::string_view bytes, const std::filesystem::path& name, std::string_view mark,
                    std::uint32_t version, std::string_view kind, std::vector<TextureSet>& sets,
                    const std::function<void(SideReader&, TextureSet&)>& read_set);

/// What a texture set's part of a side file contradicts.
struct DamagedSet {
  std::string what;
};

/// Values of vertices, `size` bytes each in `values`, as the corners of faces have them: u32 number of different ones,
/// u32 bytes of the faces' part; the values, in the order in which corners first have them; the faces' part: 2n: n
/// faces of neutral corners, 2n + 1: n that have others, and of each corner of these 0 for the next of the values, or
/// how many before it. Throws Error where that takes more than 4 GB.
std::string corner_values(const std::vector<Face>& faces, std::string_view values, std::size_t size,
                          std::string_view neutral);
/// The values of `vertices` vertices, as they were written. Throws FileError, DamagedSet.
std::string read_corner_values(SideReader& reader, const std::vector<Face>& faces, std::size_t vertices,
                               std::size_t size, std::string_view neutral);

}  // namespace rebake
