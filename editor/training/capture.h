#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "render/photograph_set.h"

namespace rebake {

/// Photographs for training, and others to judge the result by.
struct Capture {
  PhotographSource source;
  std::vector<PhotoCamera> cameras;  ///< cameras of the training photographs
  std::vector<FitPhotograph> training;
  std::vector<Photograph> held_out;
  std::vector<std::string> notes;  ///< assumptions and warnings, a sentence each
  std::uint64_t hash = 0;          ///< of all cameras and pixels
};

/// The choice of held-out photographs.
struct HeldOut {
  std::string
      file;       ///< camera file; empty: transforms_test.json beside transforms_train.json, else every n-th photograph
  int every = 8;  ///< n, from the first on; 0: none
};

/// Reads a capture. `background`: display colour behind transparent pixels. Throws FileError, FieldError for invalid
/// cameras, and Cancelled.
Capture read_capture(const PhotographSource& source, const HeldOut& held_out, const Vec3& background,
                     const Progress& progress);

/// The files of a capture, which must not be overwritten. Throws FileError.
std::vector<std::filesystem::path> files_of_capture(const PhotographSource& source, const HeldOut& held_out);

}  // namespace rebake
