#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <mutex>

#include "editor/edits/shared_result_cache.h"

namespace rebake {

/// Content-addressed cache in a folder: one checksummed file per result, with least-recently-used eviction. Several
/// processes may share the folder, and it may be deleted at any time. A damaged file counts as missing.
class ResultStore final : public ResultCache {
 public:
  static constexpr std::uint64_t default_limit = std::uint64_t{512} << 20;  ///< bytes
  /// `limit`: maximum size of all files together, in bytes.
  explicit ResultStore(std::filesystem::path folder, std::uint64_t limit = default_limit);

  /// The store in $REBAKE_RESULTS, else in the user's cache folder. Null if REBAKE_RESULTS is empty or there is no home
  /// folder.
  static std::shared_ptr<ResultStore> user_store();

  std::optional<std::string> find(const std::string& key) override;
  void keep(const std::string& key, std::string_view bytes) override;

  std::size_t found() const { return found_; }  ///< number of hits of find()

 private:
  void evict_to_limit() const;

  std::filesystem::path folder_;
  std::uint64_t limit_;
  std::mutex mutex_;
  std::atomic<std::size_t> found_ = 0;
};

}  // namespace rebake
