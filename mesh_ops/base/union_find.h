#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace rebake {

/// Union-find over the numbers 0 … size − 1. The lowest number of a set is its root, so that results do not depend on
/// the order of joins.
class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Merges the sets of `a` and `b`. Returns false if they were one set already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace rebake
