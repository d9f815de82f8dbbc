#include "mesh_ops/formats/cameras/npy.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <regex>
#include <string>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace {

template <class T>
std::vector<double> values_of(const std::string& bytes, std::size_t at, std::size_t count) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<T> read(count);
  if (count > 0) std::memcpy(read.data(), bytes.data() + at, count * sizeof(T));
  return {read.begin(), read.end()};
}

std::string matched(const std::string& text, const char* pattern) {
  std::smatch found;
  return std::regex_search(text, found, std::regex(pattern)) ? found[1].str() : "";
}

}  // namespace

NpyMatrix read_npy(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  constexpr std::size_t prefix = 10;
  if (bytes.size() < prefix + 2 || !bytes.starts_with("\x93NUMPY")) throw FileError(file, "is not a NumPy array");
  const auto byte = [&](std::size_t k) { return static_cast<std::size_t>(static_cast<unsigned char>(bytes[k])); };
  const bool long_header = byte(6) >= 2;
  const std::size_t begin = long_header ? prefix + 2 : prefix;
  const std::size_t length = byte(8) | byte(9) << 8 | (long_header ? byte(10) << 16 | byte(11) << 24 : 0);
  if (length > bytes.size() - begin) throw FileError(file, "is truncated in its header");
  const std::string header = bytes.substr(begin, length);
  const std::string type = matched(header, "'descr': *'([^']*)'"), order = matched(header, "'fortran_order': *(\\w+)"),
                    rows = matched(header, "'shape': *\\((\\d{1,9}), *\\d{1,9}\\)"),
                    columns = matched(header, "'shape': *\\(\\d{1,9}, *(\\d{1,9})\\)");
  if (rows.empty() || order != "False" || (type != "<f8" && type != "<f4"))
    throw FileError(file, "must contain a two-dimensional array of 32- or 64-bit floats in C order");
  NpyMatrix matrix{std::stoul(rows), std::stoul(columns), {}};
  const std::size_t count = matrix.rows * matrix.columns, size = type == "<f8" ? 8 : 4;
  if (bytes.size() - begin - length != count * size)
    throw FileError(file, fmt::format("has {} bytes of values, but its shape needs {}", bytes.size() - begin - length,
                                      count * size));
  matrix.values =
      size == 8 ? values_of<double>(bytes, begin + length, count) : values_of<float>(bytes, begin + length, count);
  return matrix;
}

}  // namespace rebake
