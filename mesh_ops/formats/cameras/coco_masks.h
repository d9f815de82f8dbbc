#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "mesh_ops/select/mask_votes.h"

namespace rebake {

/// Masks in the COCO format: JSON with `images` (id, file_name, width, height) and `annotations` (image_id, category_id
/// from 1 to 255, segmentation as run lengths: counts and size). Labels are category ids; of annotations that overlap,
/// the last counts. Source: github.com/cocodataset/cocoapi, common/maskApi.c.
class CocoMasks {
 public:
  /// Finds the photographs by their path, else by a file name that only one camera has. Throws FileError, also for
  /// polygons, and for masks of more than four times the photograph's pixels.
  CocoMasks(const std::filesystem::path& file, const std::vector<PhotoCamera>& cameras);
  /// Whether the file has an entry for the photograph of a camera.
  bool has(std::size_t camera) const { return masks_[camera].width > 0; }
  /// The mask of a camera's photograph, of annotations with one of these labels; none: of all. Other pixels are 0.
  LabelImage mask(std::size_t camera, const std::vector<int>& labels = {}) const;

 private:
  struct Annotation {
    std::uint8_t label;
    std::vector<std::int64_t> runs;  ///< lengths of runs outside, inside, outside, …, down the columns
  };
  struct Mask {
    int width = 0, height = 0;
    std::vector<Annotation> annotations;
  };
  std::vector<Mask> masks_;  ///< per camera
};

}  // namespace rebake
