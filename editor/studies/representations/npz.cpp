#include "editor/studies/representations/npz.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cstdint>
#include <limits>
#include <regex>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t most_unpacked = std::uint64_t{8} << 30;
// Signatures and sizes of the records of a zip archive (PKWARE's APPNOTE, 4.3).
constexpr std::uint32_t local_mark = 0x04034b50, central_mark = 0x02014b50, end_mark = 0x06054b50;
constexpr std::size_t local_size = 30, central_size = 46, end_size = 22;
constexpr std::uint32_t zip64 = 0xffffffff;

// An unsigned little-endian number of `size` bytes.
std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t k = size; k-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
  return value;
}

void append(std::string& bytes, std::uint64_t value, std::size_t size) {
  for (std::size_t k = 0; k < size; ++k) bytes += static_cast<char>(value >> (8 * k) & 0xff);
}

std::uint32_t checksum(const std::string& bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// Raw deflate streams; `size` bytes must come out. Returns whether that is so.
bool inflated(std::string_view packed, std::string& out) {
  z_stream stream{};
  if (::inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
  std::size_t taken = 0, given = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    constexpr std::size_t most = std::size_t{1} << 30;
    const std::size_t in = std::min(most, packed.size() - taken), room = std::min(most, out.size() - given);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + taken));
    stream.avail_in = static_cast<uInt>(in);
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + given);
    stream.avail_out = static_cast<uInt>(room);
    state = ::inflate(&stream, Z_NO_FLUSH);
    taken += in - stream.avail_in;
    given += room - stream.avail_out;
  }
  ::inflateEnd(&stream);
  return state == Z_STREAM_END && given == out.size() && taken == packed.size();
}

std::string deflated(const std::string& bytes) {
  std::string out(::compressBound(static_cast<uLong>(bytes.size())) + 64, '\0');
  z_stream stream{};
  if (::deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw Error("zlib cannot start");
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  ::deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  ::deflateEnd(&stream);
  return out;
}

// Size of an element in bytes; 0 for types that are not supported.
std::size_t element_size(const std::string& type) {
  std::smatch found;
  if (!std::regex_match(type, found, std::regex("[<|]([biufU])(\\d{1,4})"))) return 0;
  const std::size_t width = std::stoul(found[2]);
  return found[1] == "U" ? 4 * width : width <= 8 ? width : 0;
}

// The array of a .npy file (numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
NpzArray array_of(const fs::path& file, const std::string& name, std::string bytes) {
  const auto refuse = [&](const std::string& why) { throw FileError(file, fmt::format("array \"{}\" {}", name, why)); };
  if (bytes.size() < 12 || !bytes.starts_with("\x93NUMPY")) refuse("is not a NumPy array");
  const bool long_header = bytes[6] >= 2;
  const std::size_t begin = long_header ? 12 : 10, length = number_at(bytes, 8, long_header ? 4 : 2);
  if (length > bytes.size() - begin) refuse("is truncated in its header");
  // NumPy's own limit; longer texts would also overflow the stack of std::regex.
  constexpr std::size_t longest_header = 10'000;
  if (length > longest_header) refuse("has an impossible header");
  const std::string header = bytes.substr(begin, length);
  const auto matched = [&](const char* pattern) {
    std::smatch found;
    return std::regex_search(header, found, std::regex(pattern)) ? found[1].str() : std::string("?");
  };
  NpzArray array{matched("'descr': *'([^']*)'"), {}, {}};
  const std::string shape = matched("'shape': *\\(([\\d, ]*)\\)");
  if (shape == "?" || element_size(array.type) == 0)
    refuse(fmt::format("has elements \"{}\", which are not supported", array.type));
  if (matched("'fortran_order': *(\\w+)") != "False") refuse("is in Fortran order, which is not supported");
  const std::regex digits("\\d+");
  for (std::sregex_iterator one(shape.begin(), shape.end(), digits), end; one != end; ++one) {
    if (one->length() > 10) refuse("has an impossible shape");
    array.shape.push_back(std::stoull(one->str()));
  }
  std::size_t needed = element_size(array.type);
  for (const std::size_t side : array.shape) {
    if (side != 0 && needed > most_unpacked / side) refuse("has an impossible shape");
    needed *= side;
  }
  if (bytes.size() - begin - length != needed)
    refuse(fmt::format("has {} bytes of elements, but its shape needs {}", bytes.size() - begin - length, needed));
  bytes.erase(0, begin + length);
  array.bytes = std::move(bytes);
  return array;
}

std::string npy_of(const NpzArray& array) {
  std::string shape;
  for (const std::size_t side : array.shape) shape += fmt::format("{},", side);
  if (array.shape.size() > 1) shape.pop_back();
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", array.type, shape);
  constexpr std::size_t prefix = 10, alignment = 64;
  header.append(alignment - (prefix + header.size() + 1) % alignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  append(bytes, header.size(), 2);
  return bytes + header + array.bytes;
}

}  // namespace

std::size_t NpzArray::count() const {
  std::size_t product = 1;
  for (const std::size_t side : shape) product *= side;
  return product;
}

Npz read_npz(const fs::path& file) {
  const std::string bytes = read_file(file);
  const auto damaged = [&](const std::string& where) -> void {
    throw FileError(file, fmt::format("is truncated or damaged: {}", where));
  };
  std::string mark;
  append(mark, end_mark, 4);
  const std::size_t end = bytes.rfind(mark);
  if (end == std::string::npos || bytes.size() - end < end_size)
    throw FileError(file, "is truncated, or not a .npz file (a zip archive of NumPy arrays)");
  const std::size_t count = number_at(bytes, end + 10, 2);
  std::size_t at = number_at(bytes, end + 16, 4);
  if (at == zip64) throw FileError(file, "is a zip archive of more than 4 GB, which is not supported");
  Npz arrays;
  std::uint64_t unpacked = 0;
  std::map<std::size_t, std::size_t> taken;  // begin and end of the entries so far
  for (std::size_t k = 0; k < count; ++k) {
    if (at > end || end - at < central_size || number_at(bytes, at, 4) != central_mark)
      damaged("its table of contents");
    const std::size_t method = number_at(bytes, at + 10, 2), packed = number_at(bytes, at + 20, 4),
                      size = number_at(bytes, at + 24, 4), name_size = number_at(bytes, at + 28, 2),
                      extra = number_at(bytes, at + 30, 2), comment = number_at(bytes, at + 32, 2),
                      local = number_at(bytes, at + 42, 4);
    if (end - at - central_size < name_size + extra + comment) damaged("its table of contents");
    std::string name = bytes.substr(at + central_size, name_size);
    if (size == zip64 || local == zip64)
      throw FileError(file, fmt::format("array \"{}\" has more than 4 GB, which is not supported", name));
    if (local > end || end - local < local_size || number_at(bytes, local, 4) != local_mark) damaged(name);
    const std::size_t data = local + local_size + number_at(bytes, local + 26, 2) + number_at(bytes, local + 28, 2);
    if (data > end || end - data < packed) damaged(name);
    unpacked += size;
    const auto after = taken.lower_bound(local);
    if ((after != taken.end() && after->first < data + packed) ||
        (after != taken.begin() && std::prev(after)->second > local))
      damaged(name + " overlaps another array");
    taken[local] = data + packed;
    // Deflate packs at most about 1032 to 1.
    if (unpacked > most_unpacked || size / 1040 > packed) damaged(fmt::format("{} has an impossible size", name));
    std::string contents(size, '\0');
    if (method == 0 && packed == size)
      contents = bytes.substr(data, size);
    else if (method != 8 || !inflated(std::string_view(bytes).substr(data, packed), contents))
      damaged(name);
    if (checksum(contents) != number_at(bytes, at + 16, 4)) damaged(fmt::format("{} (its checksum differs)", name));
    if (name.ends_with(".npy")) name.resize(name.size() - 4);
    arrays.insert_or_assign(name, array_of(file, name, std::move(contents)));
    at += central_size + name_size + extra + comment;
  }
  return arrays;
}

void write_npz(const Npz& arrays, const fs::path& file, const SourceGuard& guard) {
  std::string archive, directory;
  for (const auto& [key, array] : arrays) {
    const std::string name = key + ".npy", contents = npy_of(array), packed = deflated(contents);
    if (contents.size() >= zip64 || archive.size() + packed.size() >= zip64)
      throw FileError(file, "would have more than 4 GB, which is not supported");
    std::string common;
    append(common, 20, 2);          // version of zip
    append(common, 0, 2);           // flags
    append(common, 8, 2);           // deflated
    append(common, 0x21 << 16, 4);  // 1 January 1980: equal contents give equal files
    append(common, checksum(contents), 4);
    append(common, packed.size(), 4);
    append(common, contents.size(), 4);
    append(common, name.size(), 2);
    append(common, 0, 2);  // extra fields
    append(directory, central_mark, 4);
    append(directory, 20, 2);
    directory += common;
    directory.append(2 + 2 + 2 + 4, '\0');  // comment, disk, attributes
    append(directory, archive.size(), 4);
    directory += name;
    append(archive, local_mark, 4);
    archive += common;
    archive += name;
    archive += packed;
  }
  const std::size_t begin = archive.size();
  archive += directory;
  append(archive, end_mark, 4);
  append(archive, 0, 4);  // disks
  append(archive, arrays.size(), 2);
  append(archive, arrays.size(), 2);
  append(archive, directory.size(), 4);
  append(archive, begin, 4);
  append(archive, 0, 2);  // comment
  write_file_atomically(file, archive, guard);
}

}  // namespace rebake
