#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

/// A format of camera files; an entry of the table camera_formats().
struct CameraFormat {
  const char* name;    ///< identifier in scripts and on the command line
  const char* title;   ///< display name
  const char* marker;  ///< name or extension of its file, or of a file in its folder: "transforms.json"
  WorldUp up;          ///< the axis that usually points up in its files

  /// Whether read() accepts this file or folder.
  bool (*recognises)(const std::filesystem::path& path);
  /// Reads the cameras in the frame of the file, sorted as there. Appends assumptions to `notes`. Throws
  /// FileError.
  std::vector<PhotoCamera> (*read)(const std::filesystem::path& path, std::vector<std::string>& notes);
  /// The files that read() reads.
  std::vector<std::filesystem::path> (*files)(const std::filesystem::path& path);
  /// The contents of a file with these cameras; null for formats that are only read. Throws FieldError for cameras that
  /// the format cannot hold.
  std::string (*write)(const std::vector<PhotoCamera>& cameras);
};

std::span<const CameraFormat> camera_formats();
/// The format that reads this path; null if none.
const CameraFormat* camera_format_at(const std::filesystem::path& path);
/// Finds a format by its identifier. Throws FieldError that lists the known ones.
const CameraFormat& camera_format_named(const std::string& name);
/// The format with this identifier, or the one that recognises the path if `format` is empty. Throws FileError.
const CameraFormat& camera_format_for(const std::filesystem::path& path, const std::string& format);
/// Reads the cameras of a file or folder in Rebake's frame, where y points up. `format`: identifier, or empty to
/// recognise it; `up`: the axis that points up in the file, by default as usual for its format. Appends notes. Throws
/// FileError.
std::vector<PhotoCamera> read_cameras(const std::filesystem::path& path, const std::string& format,
                                      std::optional<WorldUp> up, std::vector<std::string>& notes);
/// The camera file for which a folder stands, or the folder with the files of a format with several.
std::filesystem::path camera_root(const std::filesystem::path& path, const std::string& format);
/// Hash of the cameras that are read, with sizes and names that come from photographs. Throws FileError.
std::uint64_t camera_hash(const std::filesystem::path& path);

/// Identifiers of all formats, and of those that are written.
std::vector<std::string> camera_format_names();
std::vector<std::string> written_camera_formats();

}  // namespace rebake
