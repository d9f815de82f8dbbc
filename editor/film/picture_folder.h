#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "mesh_ops/base/file_lock.h"
#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// Hash of everything in a scene that pictures depend on: nodes, triangles, texels, decoders, keyframes, background and
/// light.
std::uint64_t picture_hash(const Scene& scene, const Progress& progress = {});

/// A folder of numbered pictures (00000.png, …) with a file film.json that identifies the film, so that a film that was
/// interrupted goes on.
class PictureFolder {
 public:
  /// Opens or creates the folder of a film of `count` pictures. `content`: text that identifies the film. `replaces`:
  /// the pictures are those of a video, and will be removed; so are those of another film, if they are of a video too.
  /// Throws FileError if they are not, if the folder has other files, and if another run writes to it.
  PictureFolder(std::filesystem::path folder, std::string extension, std::size_t count, const std::string& content,
                bool replaces, const SourceGuard& sources);
  /// Removes the pictures, film.json and the folder. Throws FileError if it has other files by now.
  void remove() const;

  std::filesystem::path picture(std::size_t number) const;
  /// The path pattern of the pictures in printf notation.
  std::filesystem::path pattern() const;
  /// Whether a picture of this film exists already and can be decoded.
  bool has(std::size_t number) const;
  /// Throws FileError if there is a picture of this number that Rebake did not render, or a link.
  void refuse_foreign(std::size_t number) const;
  std::size_t removed() const { return removed_; }  ///< number of pictures of another film that were removed

 private:
  /// Locks the folder, or throws FileError if another run writes to it.
  void lock();
  void write_record(std::size_t count, const std::string& content, bool of_video, const SourceGuard& sources) const;

  std::filesystem::path folder_;
  std::optional<FolderLock> lock_;
  std::string extension_;
  std::size_t removed_ = 0;
};

}  // namespace rebake
