#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace rebake {

/// XXH64 with seed 0: the checksum of files and journals.
std::uint64_t content_hash(std::string_view bytes);

/// Incremental content_hash().
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  void add(std::string_view bytes);
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A hash as 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace rebake
