#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace rebake {

/// XXH64, seed 0: what files and journals are checked by.
std::uint64_t content_hash(std::string_view bytes);

/// The same of bytes that come piece by piece.
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

/// As 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace rebake
