#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mesh_ops/scene/scene.h"
#include "render/picture.h"

namespace rebake {

/// One way of doing a thing: what it costs and how far off it is.
struct StudyRow {
  std::string choice;
  double milliseconds;  ///< median of the frames timed
  double psnr_db;       ///< against the reference, capped at 100
  int largest;          ///< largest difference of a channel, in 1/255
};

/// What a study is made on.
struct StudyInput {
  Renderer& renderer;
  const Scene& scene;
  View view;
  int frames;  ///< timed for each choice
};

struct Study {
  const char* name;
  const char* help;
  std::vector<StudyRow> (*run)(const StudyInput& input);
};

std::vector<StudyRow> study_samples(const StudyInput& input);
std::vector<StudyRow> study_decoder(const StudyInput& input);

/// The one table of studies.
inline constexpr Study study_table[] = {
    {"samples", "samples a pixel, against 64 samples", study_samples},
    {"decoder", "precision and place of the decoder's weights, against 32-bit constants", study_decoder},
};

/// Times a choice and compares its picture with the reference.
StudyRow measured(const StudyInput& input, const std::string& choice, const View& view, const RenderOptions& options,
                  const Image& reference);

/// Writes NAME.csv, NAME.svg and NAME.png (plots need gnuplot; throws Error without it).
void write_study(const Study& study, const std::vector<StudyRow>& rows, const std::filesystem::path& folder);

}  // namespace rebake
