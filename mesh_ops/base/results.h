#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace rebake {

/// Where expensive results are kept by the content of what they were made of, so that undo, opening and replay need not
/// make them again. Whatever is kept may be gone at any time. Callable from any thread.
class Results {
 public:
  virtual ~Results() = default;
  virtual std::optional<std::string> find(const std::string& key) = 0;
  /// What cannot be kept is not.
  virtual void keep(const std::string& key, std::string_view bytes) = 0;

 protected:
  Results() = default;
  Results(const Results&) = default;
  Results& operator=(const Results&) = default;
};

/// A key for a result of `kind` (with the version of what makes it) from these bytes.
std::string result_key(const std::string& kind, std::string_view bytes);

}  // namespace rebake
