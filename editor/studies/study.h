#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/base/source_guard.h"
#include "mesh_ops/scene/scene.h"
#include "render/picture.h"

namespace rebake {

/// Result of a study: one row of measured costs and errors per choice.
struct StudyTable {
  struct Row {
    std::string choice;
    std::vector<double> values;  ///< one per column; NaN if it does not apply
    std::string series = {};     ///< rows of equal series are plotted as one line; empty: as a point
  };
  std::vector<std::string> columns;  ///< names with units
  std::vector<Row> rows;
  /// Plotted columns: cost as x, accuracy or error as y. Logarithmic axes are for values that span decades.
  std::size_t x = 0, y = 1;
  bool log_x = false, log_y = false;
  std::optional<std::size_t> second_x = std::nullopt;  ///< column for the x axis of a second plot, NAME-2
};

/// Options of the study of deep precomputed radiance transfer.
struct DprtOptions {
  std::string object = "cloth";  ///< head, fish, cloth, space (of shapes between head and plane), or all
  std::string meshes;            ///< pattern of files with one mesh per frame, instead of `object`; empty: none
  // 0: 64, 16 and 60, or the published sizes.
  int side = 0;      ///< texels per side of the geometry images
  int channels = 0;  ///< of the network's finest level
  int epochs = 0;
  bool cuda = false;   ///< train on the graphics card
  bool paper = false;  ///< the published sizes where none are given
};

/// Options of the study of representations.
struct RepresentationsOptions {
  std::string snerg;       ///< folder of a SNeRG scene to measure too; empty: none
  std::string plenoctree;  ///< file of a PlenOctree to measure too; empty: none
};

/// Input of a study.
struct StudyInput {
  std::function<Renderer&()> renderer;  ///< created on first use; throws DeviceError without OpenGL
  const Scene& scene;
  View view;
  int frames;  ///< number of timed frames per choice; the median is reported
  Progress progress;
  std::string photographs = {};       ///< camera file of photographs of the scene; empty: pictures of it
  std::filesystem::path folder = {};  ///< for further files of the study
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< outputs a message of one line
  DprtOptions dprt = {};
  RepresentationsOptions representations = {};
  bool quick = false;        ///< smaller sizes, for studies that take long
  SourceGuard sources = {};  ///< files that the study reads
};

/// A subject of `rebake study`.
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
StudyTable study_masks(const StudyInput& input);
StudyTable study_register(const StudyInput& input);
StudyTable study_colors(const StudyInput& input);
StudyTable study_fill(const StudyInput& input);
StudyTable study_filtering(const StudyInput& input);
StudyTable study_publish(const StudyInput& input);
StudyTable study_training(const StudyInput& input);
StudyTable study_dprt(const StudyInput& input);
StudyTable study_representations(const StudyInput& input);
StudyTable study_limits(const StudyInput& input);

/// All studies, in the order of `rebake study --help`.
inline constexpr Study study_table[] = {
    {"samples", "samples per pixel, against 64 samples", study_samples},
    {"resolution", "rendering at lower resolution and upscaling, against 64 samples", study_resolution},
    {"decoder", "precision and storage of the decoder's weights, against 32-bit constants", study_decoder},
    {"cage", "cage coordinates, their precision and resolution", study_cage},
    {"rotation", "local rotations, against exact gradients and SVD", study_rotation},
    {"wrap", "coarseness of the wrap around opaque triangles", study_wrap},
    {"fuse", "one decoder fitted to several: method, width, bits per feature", study_fuse},
    {"transfer", "radiance transfer of a deformed body: rotated, learned, traced", study_transfer},
    {"light", "estimation of baked light, by views and albedos", study_light},
    {"slim", "removal of invisible triangles, and fewer bits per feature: size, image error, frame time", study_slim},
    {"masks", "selection by masks: photographs and wrong pixels", study_masks},
    {"register", "registration of captures: overlap, outliers and error", study_register},
    {"colors", "matching of two captures' colours: exposure, samples and error", study_colors},
    {"filtering", "linear filtering by finer textures: memory, error of colours, frame time", study_filtering},
    {"publish", "web pages: position bits, texture coding, moving resolution", study_publish},
    {"training", "training from photographs: steps, grid size, losses; time, size and error", study_training},
    {"dprt", "deep precomputed radiance transfer as published, against linear models, rotation and tracing",
     study_dprt},
    {"representations", "MobileNeRF, SNeRG and PlenOctrees: time, memory, size and error", study_representations},
    {"limits", "MobileNeRF's limits: close-ups, semi-transparent parts, surfaces seen from the side", study_limits},
    {"fill", "filled holes: size, error of place and colours, time", study_fill},
};

/// Empty table for comparisons of images. Columns: median frame time in ms; PSNR in dB, at most 100; largest channel
/// difference in 1/255; fastest and slowest frame in ms; x and y of the largest difference as shares of the image size.
StudyTable picture_table();
/// Row of picture_table() for a choice: times its frames and compares its image with the reference. An image of another
/// size is resized bilinearly first.
StudyTable::Row measured(const StudyInput& input, const std::string& choice, const View& view,
                         const RenderOptions& options, const Image& reference);

/// A picture of another size, interpolated bilinearly.
Image enlarged(const Image& image, int width, int height);

/// Median time of `repeats` runs in milliseconds.
double median_milliseconds(int repeats, const std::function<void()>& run);

/// Writes NAME.csv, NAME.svg and NAME.png, and NAME-2.svg and NAME-2.png for a second plot. Throws FileError if a file
/// cannot be written or `guard` protects it, and Error if gnuplot, which plots need, is missing.
void write_study(const Study& study, const StudyTable& table, const std::filesystem::path& folder,
                 const SourceGuard& guard);
/// Writes a picture into a study's own folder, in which tables are replaced, but no picture that no study made, or that
/// someone changed since. Throws FileError for those.
void write_study_picture(const Image& picture, const std::filesystem::path& file);

/// A line of a line_plot(): points in the order of x.
struct PlottedLine {
  std::string name;
  std::vector<std::array<double, 2>> points;
};
/// Writes BASE.svg and BASE.png into a study's own folder, as write_study_picture() does. Throws FileError, and Error
/// if gnuplot is missing. `log_y`: logarithmic.
void write_line_plot(const std::string& title, const std::string& x, const std::string& y, bool log_y,
                     const std::vector<PlottedLine>& lines, const std::string& base);

/// The folder for further files of a study, FOLDER/`study`, with a marker in it. Throws FileError if there is something
/// of that name that the study did not make, if there is a picture in it that no study made or that someone changed, or
/// if the study reads something in it.
std::filesystem::path own_folder(const StudyInput& input, const std::string& study);

/// Creates the folder and checks all outputs, so that problems are found before the measurement. Throws FileError.
void prepare_study_folder(const Study& study, const std::filesystem::path& folder, const SourceGuard& guard);

}  // namespace rebake
