#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "editor/studies/representations/fitted_files.h"
#include "editor/studies/representations/marched_volume.h"
#include "editor/studies/representations/plenoctree_files.h"
#include "editor/studies/representations/snerg_files.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/formats.h"
#include "render/compare.h"
#include "render/contact_sheet.h"
#include "render/flip.h"
#include "render/gl/objects.h"

namespace rebake {

namespace fs = std::filesystem;
using Method = FittedFiles::Method;

namespace {

constexpr double megabyte = 1e6;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

double megabytes_in(const fs::path& folder) {
  double bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
  return bytes / megabyte;
}

// Draws pictures; time of a frame; memory on the GPU.
struct Drawn {
  std::function<Image(const View&)> picture;
  std::function<double(const View&)> milliseconds;
  double gpu_megabytes;
};

struct Errors {
  double psnr = 0, ssim = 0, flip = 0;
};

Errors mean_errors(const Drawn& drawn, const std::vector<HeldOutView>& views) {
  Errors sum;
  for (const HeldOutView& one : views) {
    const Image picture = drawn.picture(one.view);
    const Difference difference = compare(picture, one.truth, 2);
    sum.psnr += difference.psnr_db;
    sum.ssim += difference.ssim;
    const std::vector<double> flip = flip_map(one.truth, picture);
    double total = 0;
    for (const double value : flip) total += value;
    sum.flip += total / static_cast<double>(flip.size());
  }
  const auto count = static_cast<double>(views.size());
  return {sum.psnr / count, sum.ssim / count, sum.flip / count};
}

double median_frame(const Drawn& drawn, const View& view, int frames) {
  drawn.picture(view);  // compiles and uploads
  std::vector<double> times;
  for (int k = 0; k < frames; ++k) times.push_back(drawn.milliseconds(view));
  std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
  return times[static_cast<std::size_t>(frames / 2)];
}

// Draws the contents of a folder or file. `use` gets them while they are on the GPU.
class Drawer {
 public:
  explicit Drawer(const StudyInput& input) : input_(input) {}

  void mobilenerf(const fs::path& folder, Axes axes, const View& view, const std::function<void(const Drawn&)>& use) {
    // A renderer of its own, so that memory of other scenes does not count.
    const double before = static_cast<double>(gl::memory_use().now);
    Renderer renderer;
    const Scene scene = read_any(folder, ReadOptions(axes), input_.progress);
    renderer.render(scene, view);
    use({[&](const View& one) { return renderer.render(scene, one); },
         [&](const View& one) { return renderer.time_frame(scene, one, {}, false).frame_ms; },
         (static_cast<double>(gl::memory_use().now) - before) / megabyte});
  }
  template <class Volume>
  void volume(const Volume& volume, const View& view, const std::function<void(const Drawn&)>& use) {
    MarchedVolume drawing(volume, input_.renderer().context());
    drawing.draw(view);
    const double target = 4.0 * view.width * view.height;
    use({[&](const View& one) { return drawing.picture(one); }, [&](const View& one) { return drawing.draw(one); },
         (static_cast<double>(drawing.gpu_bytes()) + target) / megabyte});
  }

 private:
  const StudyInput& input_;
};

// The middle of a picture, enlarged without interpolation.
Image enlarged_middle(const Image& image, int side, int times) {
  Image out{side * times, side * times, {}, {}};
  const int left = (image.width - side) / 2, top = (image.height - side) / 2;
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      for (int c = 0; c < 3; ++c)
        out.rgb.push_back(
            image.rgb[static_cast<std::size_t>(((top + y / times) * image.width + left + x / times) * 3 + c)]);
  return out;
}

// One row of pictures of a sample: the truth, then the largest of each method, whole and enlarged.
void write_crops(const std::vector<Image>& pictures, const fs::path& file) {
  constexpr int times = 4;
  std::vector<Image> cells = pictures;
  for (const Image& picture : pictures) cells.push_back(enlarged_middle(picture, picture.width / times, times));
  write_study_picture(contact_sheet(cells, static_cast<int>(pictures.size()), 4, {255, 255, 255}), file);
}

class Run {
 public:
  Run(const StudyInput& input, const RepresentationSizes& sizes, StudyTable& table)
      : input_(input), sizes_(sizes), table_(table), drawer_(input) {}

  void sample(const std::string& name, const fs::path& own) {
    SampleTruth truth(name, sizes_, input_.progress);
    const std::vector<FittedFiles> all = fitted_files(input_, sizes_, name, truth, own / name);
    const std::vector<HeldOutView> views = truth.held_out(own / name);
    // The largest of each method is the last.
    std::map<Method, Image> shown;
    for (const FittedFiles& fitted : all) {
      const auto use = [&](const std::string& what, const fs::path& files, const Drawn& drawn) {
        add_row(fitted, what, views, megabytes_in(files), drawn);
        shown[fitted.method] = drawn.picture(views.front().view);
      };
      const fs::path baked = fitted.folder / "baked", web = fitted.folder / "web";
      const View& view = views.front().view;
      if (fitted.method == Method::mobilenerf)
        drawer_.mobilenerf(baked, truth.model().axes, view,
                           [&](const Drawn& drawn) { use(fitted.name, baked, drawn); });
      else if (fitted.method == Method::snerg)
        drawer_.volume(read_snerg(baked), view, [&](const Drawn& drawn) { use(fitted.name, baked, drawn); });
      else
        drawer_.volume(read_plenoctree(baked / "tree.npz"), view,
                       [&](const Drawn& drawn) { use(fitted.name, baked, drawn); });
    }
    for (const FittedFiles& fitted : all)
      if (fitted.method == Method::plenoctree)
        drawer_.volume(
            read_plenoctree(fitted.folder / "web" / "tree.npz"), views.front().view, [&](const Drawn& drawn) {
              add_row(fitted, fitted.name + ", for the web", views, megabytes_in(fitted.folder / "web"), drawn);
            });
    write_crops({views.front().truth, shown[Method::mobilenerf], shown[Method::snerg], shown[Method::plenoctree]},
                own / (name + ".png"));
    for (const FittedFiles& fitted : all) curves_.push_back({fitted.sample + ", " + fitted.name, relative(fitted)});
  }

  void given(const std::string& name, double megabytes, const View& view, const Drawn& drawn) {
    const double milliseconds = median_frame(drawn, view, input_.frames);
    input_.say(fmt::format("{}: {:.1f} ms per frame, {:.1f} MB on the GPU, {:.1f} MB on disk", name, milliseconds,
                           drawn.gpu_megabytes, megabytes));
    table_.rows.push_back(
        {name, {milliseconds, none, drawn.gpu_megabytes, megabytes, none, none, none, none, none}, name});
  }

  void write_curves(const fs::path& own) const {
    try {
      write_line_plot("held-out pictures after 1, 2, 4, … passes (MobileNeRF: tens of epochs)",
                      "passes, or epochs / 10", "PSNR dB", false, curves_, (own / "budget").string());
    } catch (const Error& error) {
      input_.say(fmt::format("warning: the curves were not plotted: {}", error.what()));
    }
  }

 private:
  static std::vector<std::array<double, 2>> relative(const FittedFiles& fitted) {
    std::vector<std::array<double, 2>> points = fitted.curve;
    if (fitted.method == Method::mobilenerf)
      for (auto& point : points) point[0] /= 10;
    return points;
  }

  void add_row(const FittedFiles& fitted, const std::string& what, const std::vector<HeldOutView>& views,
               double megabytes, const Drawn& drawn) {
    input_.say(fmt::format("measuring {}, {}", fitted.sample, what));
    const Errors errors = mean_errors(drawn, views);
    const std::size_t steps = fitted.curve.size();
    const double gain = steps > 1 ? fitted.curve[steps - 1][1] - fitted.curve[steps - 2][1] : none;
    const char* method = fitted.method == Method::mobilenerf ? "MobileNeRF"
                         : fitted.method == Method::snerg    ? "SNeRG"
                         : what == fitted.name               ? "PlenOctree"
                                                             : "PlenOctree, for the web";
    table_.rows.push_back(
        {fitted.sample + ", " + what,
         {median_frame(drawn, views.front().view, input_.frames), errors.psnr, drawn.gpu_megabytes, megabytes,
          errors.ssim, errors.flip, fitted.minutes, static_cast<double>(fitted.passes), gain},
         fitted.sample + ", " + method});
  }

  const StudyInput& input_;
  const RepresentationSizes& sizes_;
  StudyTable& table_;
  Drawer drawer_;
  std::vector<PlottedLine> curves_;
};

RepresentationSizes sizes_of(bool quick) {
  RepresentationSizes sizes;
  if (quick) {
    sizes.samples = {"ficus"};
    sizes.resolutions = {32, 64};
    sizes.texels = {5, 9};
    sizes.views = 24;
    sizes.ray_side = 100;
    sizes.held_out = 2;
    sizes.picture = 200;
    sizes.most_passes = 16;
    return sizes;
  }
  for (const SceneKind& kind : scene_kinds) sizes.samples.emplace_back(kind.sample);
  sizes.resolutions = {64, 128, 256};
  sizes.texels = {9, 17, 25};
  return sizes;
}

}  // namespace

StudyTable study_representations(const StudyInput& input) {
  StudyTable table{
      {"milliseconds per frame", "PSNR dB", "GPU megabytes", "megabytes on disk", "SSIM", "FLIP",
       "processor minutes of fitting", "passes (MobileNeRF: epochs)", "dB gained by the last doubling of passes"},
      {},
      0,
      1,
      true,
      false,
      2};
  const RepresentationsOptions& options = input.representations;
  const RepresentationSizes sizes = sizes_of(input.quick);
  input.say("driver: " + input.renderer().device());
  input.say(input.quick
                ? "one scene at small sizes: about half a minute on two cores"
                : "three scenes, three methods, three resolutions: about 30 minutes on two cores; finished fits "
                  "stay in the output folder, so the study can be stopped and started again");
  // Files that were given are read first, so that faults in them show at once.
  const fs::path own = own_folder(input, input.quick ? "representations-quick" : "representations");
  Run run(input, sizes, table);
  Drawer drawer(input);
  if (!options.snerg.empty()) {
    const SnergScene scene = read_snerg(options.snerg);
    drawer.volume(scene, input.view, [&](const Drawn& drawn) {
      run.given("SNeRG of " + options.snerg, megabytes_in(options.snerg), input.view, drawn);
      write_study_picture(drawn.picture(input.view), own / "given-snerg.png");
    });
  }
  if (!options.plenoctree.empty()) {
    const PlenOctree tree = read_plenoctree(options.plenoctree);
    drawer.volume(tree, input.view, [&](const Drawn& drawn) {
      run.given("PlenOctree of " + options.plenoctree,
                static_cast<double>(fs::file_size(options.plenoctree)) / megabyte, input.view, drawn);
      write_study_picture(drawn.picture(input.view), own / "given-plenoctree.png");
    });
  }
  for (const std::string& sample : sizes.samples) run.sample(sample, own);
  run.write_curves(own);
  return table;
}

}  // namespace rebake
