#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "editor/edits/results.h"

namespace rebake {

/// Results in a folder, a checksummed file each, of at most so many bytes together: those that were not used for
/// longest go first. Several programs may share it, and it may be deleted at any time. What is damaged counts as not
/// there.
class ResultStore final : public Results {
 public:
  static constexpr std::uint64_t default_limit = std::uint64_t{512} << 20;
  explicit ResultStore(std::filesystem::path folder, std::uint64_t limit = default_limit);

  /// In $REBAKE_RESULTS, else the user's cache folder; null where there is neither, or REBAKE_RESULTS is empty.
  static std::shared_ptr<ResultStore> of_user();

  std::optional<std::string> find(const std::string& key) override;
  void keep(const std::string& key, std::string_view bytes) override;

  std::size_t found() const { return found_; }  ///< how often find() found something

 private:
  void fit_limit() const;

  std::filesystem::path folder_;
  std::uint64_t limit_;
  std::mutex mutex_;
  std::atomic<std::size_t> found_ = 0;
};

}  // namespace rebake
