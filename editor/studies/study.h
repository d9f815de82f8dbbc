#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"
#include "render/picture.h"

namespace rebake {

/// What a study measures: choices, a row each, and what each costs and gives.
struct StudyTable {
  struct Row {
    std::string choice;
    std::vector<double> values;  ///< as many as columns; NaN where there is none
  };
  std::vector<std::string> columns;  ///< names with units
  std::vector<Row> rows;
  /// Columns that the plot shows. Accuracy stands upright, time lies; errors and times that span decades are plotted by
  /// their logarithms.
  std::size_t x = 0, y = 1;
  bool log_x = false, log_y = false;
  std::optional<std::size_t> second_x = std::nullopt;  ///< plotted too, as NAME-2
};

/// What a study is made on.
struct StudyInput {
  std::function<Renderer&()> renderer;  ///< made when it is first wanted; throws DeviceError without OpenGL
  const Scene& scene;
  View view;
  int frames;  ///< timed for each choice; the median counts
  Progress progress;
};

struct Study {
  const char* name;
  const char* help;
  StudyTable (*run)(const StudyInput& input);
};

StudyTable study_samples(const StudyInput& input);
StudyTable study_resolution(const StudyInput& input);
StudyTable study_decoder(const StudyInput& input);
StudyTable study_cage(const StudyInput& input);
StudyTable study_rotation(const StudyInput& input);
StudyTable study_wrap(const StudyInput& input);
StudyTable study_fuse(const StudyInput& input);
StudyTable study_transfer(const StudyInput& input);
StudyTable study_light(const StudyInput& input);
StudyTable study_slim(const StudyInput& input);

/// The one table of studies.
inline constexpr Study study_table[] = {
    {"samples", "samples a pixel, against 64 samples", study_samples},
    {"resolution", "share of the resolution, enlarged, against 64 samples", study_resolution},
    {"decoder", "precision and place of the decoder's weights, against 32-bit constants", study_decoder},
    {"cage", "cage coordinates, their precision and resolution", study_cage},
    {"rotation", "local rotations, against exact gradients and SVD", study_rotation},
    {"wrap", "coarseness of the wrap around what shows something", study_wrap},
    {"fuse", "one decoder for several: how it is made, its width, bits a feature", study_fuse},
    {"transfer", "what a bent body sees of the sky: turned along, learnt, traced", study_transfer},
    {"light", "the light of a bake, found again, by views and albedos", study_light},
    {"slim", "what nobody sees removed, and fewer bits a feature: size, pictures, frame", study_slim},
};

/// Table of a study of pictures: milliseconds a frame (the median), PSNR, the largest difference of a channel in 1/255,
/// the fastest and the slowest frame, and where the largest difference is, as shares of the picture's size.
StudyTable picture_table();
/// Times a choice and compares its picture, enlarged where it is smaller (bilinear, as a screen does), with the
/// reference.
StudyTable::Row measured(const StudyInput& input, const std::string& choice, const View& view,
                         const RenderOptions& options, const Image& reference);

/// Median milliseconds of `repeats` runs.
double median_milliseconds(int repeats, const std::function<void()>& run);

/// Writes NAME.csv, NAME.svg and NAME.png, and NAME-2 where there is a second plot (plots need gnuplot; throws Error
/// without it). `guard` says where nothing may be written.
void write_study(const Study& study, const StudyTable& table, const std::filesystem::path& folder,
                 const SourceGuard& guard);
/// Makes the folder, so that what is in the way is found before anything is measured. Throws FileError.
void prepare_study_folder(const Study& study, const std::filesystem::path& folder, const SourceGuard& guard);

}  // namespace rebake
