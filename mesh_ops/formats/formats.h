#pragma once

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A format of scenes; an entry of the table formats(). Import, export, hashes, source guards, help, Python and the
/// window use the table.
struct Format {
  const char* name;    ///< identifier in scripts and on the command line
  const char* title;   ///< display name
  const char* help;    ///< its use: "keeps every node"
  const char* marker;  ///< main file of a folder, which stands for it ("mlp.json"), or extension of a file (".glb")
  bool is_folder;      ///< a folder; otherwise a single file
  bool has_colors;     ///< whether it keeps colours with their view dependence: exports report how pictures change

  /// Whether read() accepts this path; null for formats that are only written.
  bool (*recognises)(const std::filesystem::path& path);
  /// `options` apply to formats that do not state them.
  Scene (*read)(const std::filesystem::path& path, const ReadOptions& options, const Progress& progress);
  /// Files that read() reads, relative to the folder; for a single file, those beside it that it refers to. Null for
  /// formats that are only written.
  std::vector<std::filesystem::path> (*files)(const std::filesystem::path& path);
  /// Replaces the folder or file atomically. Throws FileError, and FieldError if the format does not support an option.
  /// Null for formats that are only read.
  ExportReport (*write)(const Scene& scene, const std::filesystem::path& path, const ExportOptions& options,
                        const Progress& progress);

  /// For folders that are written, which may be replaced by a new export; otherwise null.
  struct Folder {
    /// Whether the files have the content of the format, not only the names.
    bool (*is_genuine)(const std::filesystem::path& folder);
    std::set<std::string> (*own_files)(const std::filesystem::path& folder);    ///< names of its files in a folder
    std::set<std::string> (*own_folders)(const std::filesystem::path& folder);  ///< names of the folders in it
  };
  const Folder* folder;
  /// Further files that belong to a single file and are protected with it, relative to its folder; may be null.
  std::vector<std::filesystem::path> (*unread_files)(const std::filesystem::path& file) = nullptr;
};

std::span<const Format> formats();
/// The format that reads this path; null if none.
const Format* format_at(const std::filesystem::path& path);
/// Finds a format that is written by its identifier. Throws FieldError that lists the known ones.
const Format& format_named(const std::string& name);
/// The identifiers of the formats that are written, the default first.
std::vector<std::string> written_formats();
/// The formats that are written with their uses: "mobilenerf: for the published viewers; rebake: keeps every node".
const char* written_formats_help();

/// What import reads: "a folder (MobileNeRF, …) or a file (.obj, …)".
const char* read_formats_help();

/// Display name of a scene: the last component of scene_root().
std::string folder_title(const std::filesystem::path& path);
/// As folder_title(), but of a scene that is a file without its extension: the name of a scene in a batch.
std::string scene_title(const std::filesystem::path& scene);

/// Reads a scene of any known format. A MobileNeRF folder becomes one node with the name of the folder. `options`
/// apply to formats that do not state them. Throws FileError.
Scene read_any(const std::filesystem::path& path, const ReadOptions& options, const Progress& progress = {});

/// Assumptions made when the scene's folders were read (Origin::assumptions), as sentences without duplicates.
std::vector<std::string> assumptions_of(const Scene& scene);

}  // namespace rebake
