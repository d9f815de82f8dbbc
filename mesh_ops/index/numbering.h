#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace rebake {

/// Hash of three words, with the finaliser of SplitMix (Steele, Lea and Flood 2014).
inline std::uint64_t mixed(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
  std::uint64_t h = a * 0x9E3779B97F4A7C15ULL;
  h = (h ^ (h >> 29) ^ b) * 0xBF58476D1CE4E5B9ULL;
  h = (h ^ (h >> 31) ^ c) * 0x94D049BB133111EBULL;
  return h ^ (h >> 30);
}

/// Numbers distinct keys in order of first appearance. A flat hash table with linear probing, fast enough for millions
/// of corners.
template <class Key, class Hash>
class Numbering {
 public:
  /// `most`: upper bound of the number of distinct keys.
  Numbering(std::size_t most, Hash hash)
      : slots_(std::bit_ceil(most * 2 + 2), empty), hash_(hash), mask_(slots_.size() - 1) {}
  /// Number of a key; a new key gets the next number.
  std::uint32_t number(const Key& key) {
    for (std::size_t slot = hash_(key) & mask_;; slot = (slot + 1) & mask_) {
      if (slots_[slot] == empty) {
        slots_[slot] = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
        return slots_[slot];
      }
      if (keys_[slots_[slot]] == key) return slots_[slot];
    }
  }
  /// Number of a key, or `empty` if it has none.
  std::uint32_t find(const Key& key) const {
    for (std::size_t slot = hash_(key) & mask_;; slot = (slot + 1) & mask_)
      if (slots_[slot] == empty || keys_[slots_[slot]] == key) return slots_[slot];
  }
  /// Keys by number.
  const std::vector<Key>& keys() const { return keys_; }
  static constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<Key> keys_;
  Hash hash_;
  std::size_t mask_;
};

}  // namespace rebake
