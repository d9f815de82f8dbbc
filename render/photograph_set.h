#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/refit/photograph_fit.h"
#include "render/photograph.h"

namespace rebake {

/// Cameras of photographs, as people name them.
struct PhotographSource {
  std::filesystem::path path;      ///< camera file, or folder of a capture
  std::string format{};            ///< identifier of a camera format; empty: recognised
  std::optional<WorldUp> world{};  ///< axis that points up; nothing: as usual for the format
  double scale = 1;                ///< factor of the cameras' positions
};

/// The cameras of a source in Rebake's frame. Appends notes. Throws FileError.
std::vector<PhotoCamera> read_cameras(const PhotographSource& source, std::vector<std::string>& notes);

/// All that a run which reads cameras must not replace: the camera files, the photographs and masks that they name, and
/// other files of the capture unless Rebake rendered them, such as pictures of an earlier comparison. Throws FileError.
std::vector<std::filesystem::path> files_with_cameras(const std::filesystem::path& camera_file,
                                                      const std::string& format);

/// The photographs of cameras that exist.
struct PhotographSet {
  std::vector<PhotoCamera> cameras;  ///< of these photographs
  std::vector<Photograph> photographs;
  std::size_t missing = 0;    ///< photographs that do not exist
  std::string first_missing;  ///< the first one's name
  std::size_t resampled = 0,
              masked = 0;  ///< resampled ones, and those that masks leave out wholly (which are not in the list)
};
/// Reads all photographs of the cameras of `source`. `background`: see read_photograph(). Throws FileError if none
/// exists or one is unreadable, and Cancelled.
PhotographSet read_photographs(const PhotographSource& source, const std::vector<PhotoCamera>& cameras,
                               const Vec3& background, const Progress& progress);

/// The photograph as the fit of features and training take it.
FitPhotograph for_fit(Photograph photograph);

}  // namespace rebake
