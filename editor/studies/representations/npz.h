#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mesh_ops/base/source_guard.h"

namespace rebake {

/// An array of NumPy in C order.
struct NpzArray {
  std::string type;                ///< NumPy's description of the elements, such as "<f2", "<i4" or "<U3"
  std::vector<std::size_t> shape;  ///< empty: a single value
  std::string bytes;               ///< elements, little-endian

  std::size_t count() const;  ///< product of the shape
};

/// Arrays of a file by name.
using Npz = std::map<std::string, NpzArray>;

/// Reads a .npz file: a zip archive of .npy files, stored or deflated, of at most 8 GB unpacked. Throws FileError that
/// names the array for truncated, damaged or contradictory files.
Npz read_npz(const std::filesystem::path& file);

/// Writes a .npz file as numpy.savez_compressed does. Throws FileError, also if the guard protects the file or it is
/// larger than 4 GB, which needs another form of zip archives.
void write_npz(const Npz& arrays, const std::filesystem::path& file, const SourceGuard& guard);

}  // namespace rebake
