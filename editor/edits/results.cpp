#include "editor/edits/results.h"

#include <utility>

#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

std::shared_ptr<Results>& place() {
  static std::shared_ptr<Results> results;
  return results;
}

}  // namespace

void keep_results_in(std::shared_ptr<Results> results) { place() = std::move(results); }

std::shared_ptr<Results> kept_results() { return place(); }

std::string result_key(const std::string& kind, std::string_view bytes) {
  // Two hashes: of one, 2^32 results would hold two that share it.
  std::string salted = kind;
  salted += '\0';
  salted += bytes;
  return kind + "-" + hash_text(content_hash(bytes)) + hash_text(content_hash(salted));
}

}  // namespace rebake
