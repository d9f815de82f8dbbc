#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "mesh_ops/features/fuse.h"
#include "render/picture.h"

namespace rebake {

/// How pictures of a fused scene differ from those of what it was made of, over the pixels that it covers.
struct PictureErrors {
  double psnr_db = 100;        ///< over all views; 100 at most
  double worst_psnr_db = 100;  ///< of the worst view
  double ssim = 1;             ///< mean over views
  /// Share of pixels one channel of which is further off than `far_off` of 255: what is seen as a speckle.
  double far_off_share = 0;
  static constexpr int far_off = 32;
};

/// What a plain folder shows, measured.
struct PlainReport {
  FuseReport texels;
  bool exact = false;  ///< one decoder showed all of it already: nothing was fitted
  int hidden0 = 0, hidden1 = 0;
  bool pictures_measured = false;  ///< false where there is no OpenGL
  PictureErrors whole;
  struct OfNode {
    std::string node;
    double psnr_db = 100;  ///< over the pixels that the node shows
  };
  std::vector<OfNode> nodes;
  double frame_ms = 0, composition_frame_ms = 0;  ///< medians, measured in turn
  double seconds = 0;  ///< of the whole command: light, trials, fitting, writing and measuring; 0 where nobody took it
};

/// Throws FileError where a file is at `path` that is not empty and no such report as JSON: it may be anything that
/// somebody needs.
void check_replaces_report(const std::filesystem::path& path);

/// Twenty views all around (of forward-facing scenes: from the front), none of which features were fitted to.
std::vector<View> judging_views(const Scene& scene, int size);

/// Fills in what pictures of `size` pixels a side (as the published viewers') and frame times say. `composition` and
/// `fused` show the same, the first with what `lighting` makes of its colours.
void measure_pictures(Renderer& renderer, const Scene& composition, const Lighting& lighting, const Scene& fused,
                      PlainReport& report, const Progress& progress, int size = 800);

/// Median of so many frames, after one that is not counted.
double median_frame_ms(Renderer& renderer, const Scene& scene, const View& view, int frames,
                       const Lighting* lighting = nullptr);

/// The node whose pixels differ most, or all of it when nodes were not told apart (then without a name).
PlainReport::OfNode worst_object(const PlainReport& report);

/// What a way is, for people.
const char* words_of(FuseWay way);
/// For people, a line each.
std::vector<std::string> lines_of(const PlainReport& report);
nlohmann::json to_json(const PlainReport& report);

}  // namespace rebake
