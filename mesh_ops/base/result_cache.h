#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rebake {

/// Content-addressed cache of expensive results, so that undo, opening and replay need not compute them again. Entries
/// may vanish at any time. Thread-safe.
class ResultCache {
 public:
  virtual ~ResultCache() = default;
  virtual std::optional<std::string> find(const std::string& key) = 0;
  /// Caches a result; failures are ignored.
  virtual void keep(const std::string& key, std::string_view bytes) = 0;

 protected:
  ResultCache() = default;
  ResultCache(const ResultCache&) = default;
  ResultCache& operator=(const ResultCache&) = default;
};

/// Cache key: `kind` (name and version of the algorithm) followed by hashes of its input bytes.
std::string result_key(const std::string& kind, std::string_view bytes);

}  // namespace rebake
