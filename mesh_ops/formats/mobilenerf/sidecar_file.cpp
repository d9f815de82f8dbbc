#include "mesh_ops/formats/mobilenerf/sidecar_file.h"

#include <fmt/format.h>

#include <limits>
#include <unordered_map>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

constexpr std::size_t word_size = 4;

void put_bytes(std::string& out, std::uint64_t number, std::size_t bytes) {
  for (std::size_t k = 0; k < bytes; ++k) out += static_cast<char>(number >> (8 * k) & 0xFF);
}

std::uint64_t take_bytes(SidecarReader& reader, std::size_t bytes) {
  const std::string_view taken = reader.take(bytes);
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < bytes; ++k) number |= std::uint64_t{static_cast<std::uint8_t>(taken[k])} << (8 * k);
  return number;
}

}  // namespace

void put_u32(std::string& out, std::uint32_t number) { put_bytes(out, number, word_size); }

void put_varint(std::string& out, std::uint64_t number) {
  for (; number >= 0x80; number >>= 7) out += static_cast<char>(0x80 | (number & 0x7F));
  out += static_cast<char>(number);
}

void SidecarWriter::add(std::uint32_t set, std::size_t faces, std::string_view written) {
  ++sets_;
  put_u32(body_, set);
  put_u32(body_, static_cast<std::uint32_t>(faces));
  body_ += written;
}

std::string SidecarWriter::bytes() const {
  std::string counted;
  put_u32(counted, sets_);
  counted += body_;
  std::string out = mark_;
  put_u32(out, version_);
  put_bytes(out, content_hash(counted), 8);
  return out + counted;
}

std::string_view SidecarReader::take(std::size_t count) {
  if (count > bytes_.size()) throw FileError(name_, "is damaged: it ends too early");
  const std::string_view taken = bytes_.substr(0, count);
  bytes_.remove_prefix(count);
  return taken;
}

std::uint32_t SidecarReader::take_u32() { return static_cast<std::uint32_t>(take_bytes(*this, word_size)); }

std::uint64_t SidecarReader::take_varint() {
  std::uint64_t number = 0;
  for (int shift = 0; shift < 63; shift += 7) {
    const auto byte = static_cast<std::uint8_t>(take(1)[0]);
    number |= std::uint64_t{byte & 0x7FU} << shift;
    if (byte < 0x80) return number;
  }
  throw FileError(name_, "is damaged: a number exceeds 63 bits");
}

void read_sidecar(std::string_view bytes, const std::filesystem::path& name, std::string_view mark,
                  std::uint32_t version, std::string_view kind, std::vector<TextureSet>& sets,
                  const std::function<void(SidecarReader&, TextureSet&)>& read_set) {
  SidecarReader reader(bytes, name);
  if (!bytes.starts_with(mark)) throw FileError(name, fmt::format("is not a file of {}", kind));
  reader.take(mark.size());
  const std::uint32_t its_version = reader.take_u32();
  if (its_version > version) throw FileError(name, "was written by a newer version of Rebake");
  if (its_version == 0) throw FileError(name, "is damaged: its version is 0");
  if (const std::uint64_t hash = take_bytes(reader, 8); hash != content_hash(reader.rest()))
    throw FileError(name, "is damaged: its checksum is wrong");
  std::uint64_t next = 0;
  for (std::uint32_t count = reader.take_u32(); count > 0; --count) {
    const std::uint32_t s = reader.take_u32();
    if (s < next) throw FileError(name, fmt::format("is damaged: set {} is out of order", s));
    next = std::uint64_t{s} + 1;
    if (s >= sets.size())
      throw FileError(name, fmt::format("refers to set {}, but the folder has {}", s, counted(sets.size(), "set")));
    try {
      if (reader.take_u32() != sets[s].soup.triangle_count()) throw DamagedSet{"has a different number of faces"};
      read_set(reader, sets[s]);
    } catch (const DamagedSet& damage) {
      throw FileError(name, fmt::format("set {}: {}; it belongs to other files, or is damaged", s, damage.what));
    }
  }
  if (!reader.done()) throw FileError(name, "is damaged: it has extra bytes at its end");
}

std::string corner_values(const std::vector<Face>& faces, std::string_view values, std::size_t size,
                          std::string_view neutral) {
  const auto value = [&](std::uint32_t vertex) { return values.substr(vertex * size, size); };
  const auto has_any = [&](const Face& face) {
    return value(face[0]) != neutral || value(face[1]) != neutral || value(face[2]) != neutral;
  };
  std::unordered_map<std::string_view, std::uint64_t> numbers;
  std::string table, part;
  for (std::size_t first = 0, last = 0; first < faces.size(); first = last) {
    const bool any = has_any(faces[first]);
    for (last = first; last < faces.size() && has_any(faces[last]) == any;) ++last;
    put_varint(part, 2 * (last - first) + (any ? 1 : 0));
    for (std::size_t f = first; any && f < last; ++f)
      for (const std::uint32_t vertex : faces[f]) {
        const auto [found, fresh] = numbers.try_emplace(value(vertex), numbers.size());
        put_varint(part, fresh ? 0 : numbers.size() - found->second);
        if (fresh) table += value(vertex);
      }
  }
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  if (part.size() > most) throw Error("a texture set is too large: its vertex values exceed 4 GB");
  std::string out;
  put_u32(out, static_cast<std::uint32_t>(numbers.size()));
  put_u32(out, static_cast<std::uint32_t>(part.size()));
  return out + table + part;
}

std::string read_corner_values(SidecarReader& reader, const std::vector<Face>& faces, std::size_t vertices,
                               std::size_t size, std::string_view neutral) {
  const std::uint32_t value_count = reader.take_u32(), part_size = reader.take_u32();
  const std::string_view table = reader.take(std::size_t{value_count} * size);
  SidecarReader part(reader.take(part_size), reader.name());
  std::string values;
  values.reserve(vertices * size);
  for (std::size_t v = 0; v < vertices; ++v) values += neutral;
  std::size_t face = 0;
  std::uint64_t next = 0;
  while (face < faces.size()) {
    const std::uint64_t run = part.take_varint(), count = run / 2;
    if (count == 0 || count > faces.size() - face) throw DamagedSet{"refers to faces that do not exist"};
    for (const std::size_t end = face + count; face < end; ++face)
      for (std::size_t k = 0; k < 3 && run % 2 != 0; ++k) {
        const std::uint64_t before = part.take_varint();
        if (before == 0 ? next == value_count : before > next)
          throw DamagedSet{"refers to a value that does not exist"};
        const std::uint64_t at = before == 0 ? next++ : next - before;
        values.replace(faces[face][k] * size, size, table.substr(at * size, size));
      }
  }
  if (!part.done()) throw DamagedSet{"has data beyond its last face"};
  if (next != value_count) throw DamagedSet{"has values that no face uses"};
  return values;
}

}  // namespace rebake
