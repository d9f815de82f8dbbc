#include "mesh_ops/base/hash.h"

#include <xxhash.h>

#include <cstdio>

namespace rebake {

std::uint64_t content_hash(std::string_view bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

std::string hash_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace rebake
