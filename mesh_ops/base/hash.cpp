#include "mesh_ops/base/hash.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace rebake {

std::uint64_t content_hash(std::string_view bytes) { return XXH64(bytes.data(), bytes.size(), 0); }

struct ContentHash::State {
  XXH64_state_t* xxh = XXH64_createState();
  ~State() { XXH64_freeState(xxh); }
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {
  if (state_->xxh == nullptr) throw std::bad_alloc();
  XXH64_reset(state_->xxh, 0);
}
ContentHash::~ContentHash() = default;
void ContentHash::add(std::string_view bytes) { XXH64_update(state_->xxh, bytes.data(), bytes.size()); }
std::uint64_t ContentHash::value() const { return XXH64_digest(state_->xxh); }

std::string hash_text(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace rebake
