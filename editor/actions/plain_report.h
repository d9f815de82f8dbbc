#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "mesh_ops/features/distill/fuse.h"
#include "render/picture.h"

namespace rebake {

/// Difference between pictures of a fused scene and of the original composition, over the pixels that it covers.
struct PictureErrors {
  double psnr_db = 100;        ///< PSNR over all views, at most 100
  double worst_psnr_db = 100;  ///< PSNR of the worst view
  double ssim = 1;             ///< mean SSIM over the views
  /// Share of pixels with a channel that differs by more than `speckle_threshold` / 255: visible speckles.
  double far_off_share = 0;
  static constexpr int speckle_threshold = 32;
};

/// Measured quality of a plain folder.
struct PlainReport {
  FuseReport texels;               ///< errors per texel
  bool exact = false;              ///< one decoder represents the scene exactly; nothing was fitted
  int hidden0 = 0, hidden1 = 0;    ///< widths of the decoder's hidden layers
  bool pictures_measured = false;  ///< false without OpenGL
  PictureErrors whole;             ///< errors of whole pictures
  struct NodeQuality {
    std::string node;      ///< name
    double psnr_db = 100;  ///< PSNR over the pixels that the node covers
  };
  std::vector<NodeQuality> nodes;
  double frame_ms = 0, composition_frame_ms = 0;  ///< median frame times, measured alternately
  double seconds = 0;                             ///< wall-clock time of the whole export; 0: not measured
};

/// Throws FileError if there is a non-empty file at `path` that is not an earlier report, so that no other file is
/// overwritten.
void check_report_path(const std::filesystem::path& path);

/// Twenty held-out views of `size`² pixels: all around the scene, or from the front if it is forward-facing.
std::vector<View> measurement_views(const Scene& scene, int size);

/// Measures errors in pictures of `size`² pixels and frame times, and fills them in. Compares `fused` with
/// `composition`, the original scene with `lighting`.
void measure_pictures(Renderer& renderer, const Scene& composition, const Lighting& lighting, const Scene& fused,
                      PlainReport& report, const Progress& progress, int size = 800);

/// Median time of `frames` frames in milliseconds, after one warm-up frame.
double median_frame_ms(Renderer& renderer, const Scene& scene, const View& view, int frames,
                       const Lighting* lighting = nullptr);

/// The node with the lowest PSNR; the whole scene, without a name, if its PSNR is lower or nodes were not measured.
PlainReport::NodeQuality worst_object(const PlainReport& report);

/// Name of a method, for people.
const char* notation_of(FuseMethod way);
/// The report as lines of text for people.
std::vector<std::string> lines_of(const PlainReport& report);
/// The report as JSON, see ExportAction::report.
nlohmann::json to_json(const PlainReport& report);

}  // namespace rebake
