#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace rebake {

/// Extension of glTF for buffer views compressed by meshoptimizer (EXT_meshopt_compression).
inline constexpr const char* meshopt_extension = "EXT_meshopt_compression";

/// Compresses vertex data of `count` elements of `stride` bytes (a multiple of 4, at most 256): mode ATTRIBUTES,
/// without loss.
std::string meshopt_attributes(std::string_view bytes, std::size_t count, std::size_t stride);
/// Compresses the 32-bit indices of triangles: mode TRIANGLES, which may rotate the corners of a triangle.
std::string meshopt_triangles(std::string_view bytes);

/// Decompresses a buffer view. `extension`: its object EXT_meshopt_compression, with mode, count, byteStride and
/// filter; `bytes`: the compressed bytes. Throws FieldError, naming the field.
std::string meshopt_decoded(const nlohmann::json& extension, std::string_view bytes);

}  // namespace rebake
