#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace rebake {

/// A two-dimensional array of NumPy, row by row.
struct NpyMatrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> values;
};

/// Reads a .npy file (versions 1 to 3) with a two-dimensional array of little-endian 32- or 64-bit floats in C order.
/// Throws FileError for anything else. Source: numpy.org/doc/stable/reference/generated/numpy.lib.format.html
NpyMatrix read_npy(const std::filesystem::path& file);

}  // namespace rebake
