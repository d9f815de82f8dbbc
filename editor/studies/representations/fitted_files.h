#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "editor/studies/representations/scene_kinds.h"
#include "editor/studies/study.h"

namespace rebake {

/// Sizes of the study of representations.
struct RepresentationSizes {
  std::vector<std::string> samples;
  std::vector<int> resolutions;     ///< of both volumes: voxels along the longest side
  std::vector<int> texels;          ///< of MobileNeRF: texels per side of a quad; the samples have 17
  int views = 48;                   ///< that representations are fitted to
  int ray_side = 240;               ///< rays per side of each of these views
  int held_out = 4, picture = 400;  ///< held-out pictures, and their side
  int most_passes = 512;            ///< of a fit of a volume
};

/// The truth of a sample, made when first asked for.
class SampleTruth {
 public:
  SampleTruth(const std::string& sample, const RepresentationSizes& sizes, const Progress& progress);

  const bakery::Model& model() const { return model_; }
  const bakery::RadianceField& field();
  const TruthRays& rays();
  /// Held-out pictures, kept as PNG in `folder`.
  std::vector<HeldOutView> held_out(const std::filesystem::path& folder);
  /// The same of other cameras, by which fits decide when to stop.
  std::vector<HeldOutView> validation(const std::filesystem::path& folder);

 private:
  std::vector<HeldOutView> traced(std::vector<HeldOutView> views, const std::filesystem::path& folder,
                                  const std::string& name);
  bakery::Model model_;
  RepresentationSizes sizes_;
  Progress progress_;
  std::unique_ptr<bakery::RadianceField> field_;
  std::unique_ptr<TruthRays> rays_;
};

/// A fitted representation on disk.
struct FittedFiles {
  enum class Method { mobilenerf, snerg, plenoctree };
  std::string sample;
  Method method;
  int resolution;                                 ///< of RepresentationSizes
  std::string name;                               ///< such as "SNeRG 128³"
  std::filesystem::path folder;                   ///< its published files are in "baked", a folder
  double minutes = 0;                             ///< of processor time for the fit; MobileNeRF: for the last bake
  int passes = 0;                                 ///< epochs for MobileNeRF
  std::vector<std::array<double, 2>> curve = {};  ///< passes or epochs, PSNR in dB of held-out pictures
};

/// All representations of the sizes; those that are missing in `folder` are fitted first. Each is fitted until doubling
/// the number of passes gains less than 0.2 dB on the validation pictures, or the most passes are reached, which a
/// warning says; the best result is kept.
std::vector<FittedFiles> fitted_files(const StudyInput& input, const RepresentationSizes& sizes,
                                      const std::string& sample, SampleTruth& truth,
                                      const std::filesystem::path& folder);

}  // namespace rebake
