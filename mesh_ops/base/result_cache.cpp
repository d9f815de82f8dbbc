#include "mesh_ops/base/result_cache.h"

#include "mesh_ops/base/hash.h"

namespace rebake {

std::string result_key(const std::string& kind, std::string_view bytes) {
  // Two 64-bit hashes: with a single one, 2^32 results would likely contain a collision.
  std::string salted = kind;
  salted += '\0';
  salted += bytes;
  return kind + "-" + hash_text(content_hash(bytes)) + hash_text(content_hash(salted));
}

}  // namespace rebake
