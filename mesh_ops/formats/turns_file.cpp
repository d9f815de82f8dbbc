#include "mesh_ops/formats/turns_file.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/turn.h"

namespace rebake {

namespace {

constexpr std::string_view mark = "rebaketn";
constexpr std::uint32_t version = 1;

template <class Number>
void put(std::string& out, Number number) {
  for (std::size_t k = 0; k < sizeof(Number); ++k) out += static_cast<char>(number >> (8 * k) & 0xFF);
}

void put_short(std::string& out, std::uint64_t number) {
  for (; number >= 0x80; number >>= 7) out += static_cast<char>(0x80 | (number & 0x7F));
  out += static_cast<char>(number);
}

// Reads what is there, and throws where it ends.
class Reader {
 public:
  Reader(std::string_view bytes, const std::filesystem::path& name) : bytes_(bytes), name_(name) {}

  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw FileError(name_, "is damaged: it ends too early");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  template <class Number>
  Number take_number() {
    Number number = 0;
    const std::string_view taken = take(sizeof(Number));
    for (std::size_t k = 0; k < sizeof(Number); ++k)
      number |= static_cast<Number>(static_cast<Number>(static_cast<std::uint8_t>(taken[k])) << (8 * k));
    return number;
  }
  std::uint64_t take_short() {
    std::uint64_t number = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = static_cast<std::uint8_t>(take(1)[0]);
      number |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) return number;
    }
    throw FileError(name_, "is damaged: a number in it is too long");
  }
  std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
  const std::filesystem::path& name_;
};

std::string turns_of(const Soup& soup) {
  const std::vector<Turn>& turns = *soup.rotations();
  const auto is_turned = [&](const Face& face) {
    return !turns[face[0]].is_identity() || !turns[face[1]].is_identity() || !turns[face[2]].is_identity();
  };
  std::map<std::array<std::uint8_t, Turn::size>, std::uint64_t> numbers;
  std::string table, faces;
  const std::vector<Face>& all = soup.faces();
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    const bool turned = is_turned(all[first]);
    for (last = first; last < all.size() && is_turned(all[last]) == turned;) ++last;
    put_short(faces, 2 * (last - first) + (turned ? 1 : 0));
    for (std::size_t f = first; turned && f < last; ++f)
      for (const std::uint32_t vertex : all[f]) {
        const auto bytes = turns[vertex].bytes();
        const auto [found, fresh] = numbers.try_emplace(bytes, numbers.size());
        put_short(faces, fresh ? 0 : numbers.size() - found->second);
        if (fresh) table.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      }
  }
  std::string out;
  constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
  if (faces.size() > most) throw Error("turns of a texture set take more than 4 GB and cannot be written");
  put(out, static_cast<std::uint32_t>(all.size()));
  put(out, static_cast<std::uint32_t>(numbers.size()));
  put(out, static_cast<std::uint32_t>(faces.size()));
  return out + table + faces;
}

std::vector<Turn> read_set(Reader& reader, const Soup& soup, std::size_t number, const std::filesystem::path& name) {
  const auto damaged = [&](const char* what) {
    return FileError(name, fmt::format("set {}: {}; it belongs to other files, or is damaged", number, what));
  };
  const auto face_count = reader.take_number<std::uint32_t>(), turn_count = reader.take_number<std::uint32_t>(),
             size = reader.take_number<std::uint32_t>();
  if (face_count != soup.faces().size()) throw damaged("has another number of faces");
  const std::string_view table = reader.take(std::size_t{turn_count} * Turn::size);
  Reader faces(reader.take(size), name);
  std::vector<Turn> turns(soup.positions().size());
  std::size_t face = 0;
  std::uint64_t next = 0;
  while (face < face_count) {
    const std::uint64_t run = faces.take_short(), count = run / 2;
    if (count == 0 || count > face_count - face) throw damaged("names faces that are not there");
    for (const std::size_t end = face + count; face < end; ++face)
      for (std::size_t k = 0; k < 3 && run % 2 != 0; ++k) {
        const std::uint64_t before = faces.take_short();
        if (before == 0 ? next == turn_count : before > next) throw damaged("names a turn that is not there");
        const std::uint64_t at = before == 0 ? next++ : next - before;
        turns[soup.faces()[face][k]] = Turn(std::span<const std::uint8_t, Turn::size>(
            reinterpret_cast<const std::uint8_t*>(table.data()) + at * Turn::size, Turn::size));
      }
  }
  if (!faces.rest().empty()) throw damaged("has more than its faces");
  if (next != turn_count) throw damaged("has turns that no face has");
  return turns;
}

}  // namespace

std::string write_turns(const std::vector<TextureSet>& sets) {
  std::uint32_t count = 0;
  std::string body;
  for (std::size_t s = 0; s < sets.size(); ++s) {
    if (sets[s].soup.rotations() == nullptr) continue;
    ++count;
    put(body, static_cast<std::uint32_t>(s));
    body += turns_of(sets[s].soup);
  }
  std::string counted;
  put(counted, count);
  counted += body;
  std::string out(mark);
  put(out, version);
  put(out, content_hash(counted));
  return out + counted;
}

void read_turns(std::string_view bytes, const std::filesystem::path& name, std::vector<TextureSet>& sets) {
  Reader reader(bytes, name);
  if (!bytes.starts_with(mark)) throw FileError(name, "is not a file of turns");
  reader.take(mark.size());
  const auto its_version = reader.take_number<std::uint32_t>();
  if (its_version > version) throw FileError(name, "was written by a newer version of Rebake");
  if (its_version == 0) throw FileError(name, "is damaged: there is no version 0");
  if (const auto hash = reader.take_number<std::uint64_t>(); hash != content_hash(reader.rest()))
    throw FileError(name, "is damaged: its checksum does not fit");
  std::uint64_t next = 0;
  for (auto count = reader.take_number<std::uint32_t>(); count > 0; --count) {
    const auto s = reader.take_number<std::uint32_t>();
    if (s < next) throw FileError(name, fmt::format("is damaged: set {} is out of its order", s));
    next = std::uint64_t{s} + 1;
    if (s >= sets.size()) throw FileError(name, fmt::format("names set {}, but the folder has {}", s, sets.size()));
    const Soup& soup = sets[s].soup;
    auto turns = Values<Turn>::of(read_set(reader, soup, s, name));
    sets[s].soup = Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces(),
                        soup.vertex_attributes().with(Soup::rotation, std::move(turns)));
  }
  if (!reader.rest().empty()) throw FileError(name, "is damaged: something stands behind its end");
}

}  // namespace rebake
