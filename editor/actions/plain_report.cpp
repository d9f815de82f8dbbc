#include "editor/actions/plain_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "editor/actions/views.h"
#include "render/compare.h"

namespace rebake {

namespace {

Scene on_background(Scene scene, const Color& background) {
  scene.background = background;
  return scene;
}

// A flag per channel of a picture, the same for all channels of a pixel.
using Mask = std::vector<bool>;

template <class Wanted>
Mask pixels(const Image& picture, Wanted wanted) {
  Mask mask(picture.rgb.size());
  for (std::size_t k = 0; k < mask.size(); k += 3) mask[k] = mask[k + 1] = mask[k + 2] = wanted(k);
  return mask;
}

bool same_pixel(const Image& a, const Image& b, std::size_t k) {
  const auto at = static_cast<std::ptrdiff_t>(k);
  return std::equal(a.rgb.begin() + at, a.rgb.begin() + at + 3, b.rgb.begin() + at);
}

Mask differing(const Image& a, const Image& b) {
  return pixels(a, [&](std::size_t k) { return !same_pixel(a, b, k); });
}

// Pixels that are not pure background, from pictures of the same scene on white and on black.
Mask covered(const Image& on_white, const Image& on_black) {
  return pixels(on_white, [&](std::size_t k) {
    return !std::all_of(on_white.rgb.begin() + static_cast<std::ptrdiff_t>(k),
                        on_white.rgb.begin() + static_cast<std::ptrdiff_t>(k + 3),
                        [](std::uint8_t v) { return v == 255; }) ||
           !std::all_of(on_black.rgb.begin() + static_cast<std::ptrdiff_t>(k),
                        on_black.rgb.begin() + static_cast<std::ptrdiff_t>(k + 3),
                        [](std::uint8_t v) { return v == 0; });
  });
}

// Sums of squared differences of channels, 0 … 1.
struct Squares {
  double sum = 0, count = 0, pixels_far_off = 0;
  void add(const Image& a, const Image& b, const Mask& mask) {
    for (std::size_t k = 0; k < mask.size(); k += 3) {
      if (!mask[k]) continue;
      int most = 0;
      for (std::size_t c = k; c < k + 3; ++c) {
        const int off = std::abs(a.rgb[c] - b.rgb[c]);
        sum += off * off / (255.0 * 255.0);
        most = std::max(most, off);
      }
      count += 3;
      if (most > PictureErrors::speckle_threshold) ++pixels_far_off;
    }
  }
  void add(const Squares& other) {
    sum += other.sum;
    count += other.count;
    pixels_far_off += other.pixels_far_off;
  }
  double psnr() const { return sum > 0 ? std::min(100.0, -10 * std::log10(sum / count)) : 100; }
};

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

}  // namespace

double median_frame_ms(Renderer& renderer, const Scene& scene, const View& view, int frames, const Lighting* lighting) {
  renderer.render(scene, view, {}, lighting);
  std::vector<double> times;
  for (int k = 0; k < frames; ++k) times.push_back(renderer.time_frame(scene, view, {}, false, lighting).frame_ms);
  return median(std::move(times));
}

const char* notation_of(FuseMethod way) {
  switch (way) {
    case FuseMethod::keep:
      return "one decoder unchanged";
    case FuseMethod::train:
      return "one decoder fine-tuned";
    case FuseMethod::scratch:
      return "a new decoder";
    case FuseMethod::side_by_side:
      return "decoders side by side";
  }
  return "";
}

std::vector<View> measurement_views(const Scene& scene, int size) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  const Camera front = framing_camera(scene, 1);
  const Vec3 away = front.eye - front.target, up = front.up.normalized(), right = up.cross(away).normalized();
  constexpr int count = 20;
  std::vector<View> views;
  for (int k = 0; k < count; ++k) {
    constexpr double degrees = std::numbers::pi / 180;
    const int row = k / 5;
    const double turn = forward ? (k % 5 - 2) * 6.0 : k * 360.0 / count,
                 lift = forward ? (row - 1.5) * 6 : (k % 4 - 1) * 14;
    View view;
    view.width = view.height = size;
    view.camera = front;
    view.camera.eye =
        front.target + Eigen::AngleAxisd(turn * degrees, up) * (Eigen::AngleAxisd(-lift * degrees, right) * away);
    views.push_back(view);
  }
  return views;
}

void measure_pictures(Renderer& renderer, const Scene& composition, const Lighting& lighting, const Scene& fused,
                      PlainReport& report, const Progress& progress, int size) {
  // White background, as in the published viewers; with black as well, covered pixels are found.
  const Scene before = on_background(composition, Color::Ones()), after = on_background(fused, Color::Ones()),
              on_black = on_background(composition, Color::Zero());
  std::vector<PlacedNode> nodes;
  for (const PlacedNode& placed : placed_nodes(composition))
    if (placed.visible && placed.node->object) nodes.push_back(placed);
  // A node's pixels are those that change without it. Skipped for many nodes, because each needs a picture per view.
  constexpr std::size_t max_nodes = 16;
  if (nodes.size() < 2 || nodes.size() > max_nodes) nodes.clear();
  std::vector<Squares> of_node(nodes.size());
  Squares whole;
  double similar = 0;
  const std::vector<View> views = measurement_views(composition, size);
  for (std::size_t v = 0; v < views.size(); ++v) {
    progress.at("comparing pictures", static_cast<double>(v) / static_cast<double>(views.size()));
    const Image exact = renderer.render(before, views[v], {}, &lighting), shown = renderer.render(after, views[v]);
    Squares here;
    here.add(exact, shown, covered(exact, renderer.render(on_black, views[v], {}, &lighting)));
    whole.add(here);
    report.whole.worst_psnr_db = std::min(report.whole.worst_psnr_db, here.psnr());
    similar += compare(exact, shown, 2).ssim / static_cast<double>(views.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Scene without_it = with_changed(before, nodes[k].node->id, [](Node& node) { node.object = nullptr; });
      of_node[k].add(exact, shown, differing(exact, renderer.render(without_it, views[v], {}, &lighting)));
    }
  }
  report.whole.psnr_db = whole.psnr();
  report.whole.ssim = similar;
  report.whole.far_off_share = whole.count > 0 ? whole.pixels_far_off / (whole.count / 3) : 0;
  for (std::size_t k = 0; k < nodes.size(); ++k) report.nodes.push_back({nodes[k].node->name, of_node[k].psnr()});
  const View& view = views.front();
  std::vector<double> times_before, times_after;
  renderer.render(before, view);
  renderer.render(after, view);
  for (int k = 0; k < 9; ++k) {
    times_before.push_back(renderer.time_frame(before, view, {}, false, &lighting).frame_ms);
    times_after.push_back(renderer.time_frame(after, view, {}, false).frame_ms);
  }
  report.composition_frame_ms = median(times_before);
  report.frame_ms = median(times_after);
  report.pictures_measured = true;
}

PlainReport::NodeQuality worst_object(const PlainReport& report) {
  PlainReport::NodeQuality worst{"", report.whole.psnr_db};
  for (const PlainReport::NodeQuality& node : report.nodes)
    if (node.psnr_db < worst.psnr_db) worst = node;
  return worst;
}

namespace {

void add_picture_lines(const PlainReport& report, std::vector<std::string>& lines) {
  for (const PlainReport::NodeQuality& node : report.nodes)
    lines.push_back(fmt::format("{}: {:.1f} dB in pictures", node.node, node.psnr_db));
  lines.push_back(
      fmt::format("covered pixels of 20 pictures: {:.1f} dB, {:.1f} dB at worst, SSIM {:.4f}; {:.3g} % of "
                  "pixels differ by more than {}/255",
                  report.whole.psnr_db, report.whole.worst_psnr_db, report.whole.ssim, 100 * report.whole.far_off_share,
                  PictureErrors::speckle_threshold));
  lines.push_back(
      fmt::format("frame time {:.1f} ms, of the composition {:.1f} ms", report.frame_ms, report.composition_frame_ms));
}

}  // namespace

std::vector<std::string> lines_of(const PlainReport& report) {
  std::vector<std::string> lines;
  if (report.exact) {
    lines.emplace_back("one decoder represents the scene exactly: nothing had to be fitted");
    return lines;
  }
  const FuseReport& texels = report.texels;
  const FuseTrial& chosen = texels.trials[texels.chosen];
  for (std::size_t k = 0; k < texels.trials.size(); ++k) {
    const FuseTrial& trial = texels.trials[k];
    lines.push_back(fmt::format("tried width {}, {}: {:.1f} dB on a sample{}, {:.1f} s{}", trial.width,
                                notation_of(trial.way), trial.psnr_db,
                                trial.worst_node.empty() ? "" : fmt::format(" ({} is worst)", trial.worst_node),
                                trial.seconds, k == texels.chosen ? " (chosen)" : ""));
  }
  lines.push_back(fmt::format("one decoder of width {} ({}): {} texels fitted in {:.1f} s{}", chosen.width,
                              notation_of(chosen.way), texels.fitted_texels, texels.seconds,
                              texels.in_time ? "" : "; stopped by the time limit"));
  for (const FuseReport::Part& part : texels.parts)
    lines.push_back(!part.shares.empty() ? fmt::format("{}: shares the texels of {}", part.node, part.shares)
                    : part.kept          ? fmt::format("{}: {} texels kept bit for bit", part.node, part.errors.texels)
                                : fmt::format("{}: {} texels, {:.1f} dB, 99 % of them at least {:.1f} dB", part.node,
                                              part.errors.texels, part.errors.psnr_db, part.errors.worst_psnr_db));
  if (texels.parts.size() > 1)
    lines.push_back(fmt::format("all texels: {:.1f} dB, 99 % of them at least {:.1f} dB", texels.whole.psnr_db,
                                texels.whole.worst_psnr_db));
  if (report.pictures_measured) add_picture_lines(report, lines);
  if (report.seconds > 0)
    lines.push_back(fmt::format("total time {:.0f} s, with trials and measuring", std::ceil(report.seconds)));
  return lines;
}

constexpr std::string_view report_keys[] = {"exact",   "width",         "all_seconds", "texels", "fitted_texels",
                                            "seconds", "ended_by_time", "parts",       "trials", "pictures"};

void check_report_path(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) == 0) return;
  const auto there = nlohmann::json::parse(read_file(path), nullptr, false);
  bool is_report = there.is_object() && there.contains("exact") && there.contains("width");
  // A report with keys that somebody added is theirs.
  if (is_report)
    for (const auto& [key, value] : there.items())
      if (std::ranges::find(report_keys, key) == std::end(report_keys)) is_report = false;
  if (!is_report)
    throw FileError(path, "is not an export report; name another file for the report, or remove this one");
}

nlohmann::json to_json(const PlainReport& report) {
  const auto errors = [](const TexelErrors& e) {
    return nlohmann::json{{"texels", e.texels}, {"psnr_db", e.psnr_db}, {"worst_psnr_db", e.worst_psnr_db}};
  };
  nlohmann::json json{{"exact", report.exact}, {"width", {report.hidden0, report.hidden1}}};
  if (report.seconds > 0) json["all_seconds"] = report.seconds;
  if (!report.exact) {
    const FuseReport& texels = report.texels;
    json["texels"] = errors(texels.whole);
    json["fitted_texels"] = texels.fitted_texels;
    json["seconds"] = texels.seconds;
    json["ended_by_time"] = !texels.in_time;
    json["parts"] = nlohmann::json::array();
    for (const FuseReport::Part& part : texels.parts) {
      nlohmann::json one = errors(part.errors);
      one["node"] = part.node;
      if (!part.shares.empty()) one["shares"] = part.shares;
      one["kept"] = part.kept;
      json["parts"].push_back(std::move(one));
    }
    json["trials"] = nlohmann::json::array();
    for (std::size_t k = 0; k < texels.trials.size(); ++k) {
      const FuseTrial& trial = texels.trials[k];
      json["trials"].push_back({{"width", trial.width},
                                {"way", notation_of(trial.way)},
                                {"psnr_db", trial.psnr_db},
                                {"seconds", trial.seconds},
                                {"taken", k == texels.chosen}});
    }
  }
  if (report.pictures_measured) {
    json["pictures"] = {{"views", 20},
                        {"psnr_db", report.whole.psnr_db},
                        {"worst_psnr_db", report.whole.worst_psnr_db},
                        {"ssim", report.whole.ssim},
                        {"far_off_share", report.whole.far_off_share},
                        {"frame_ms", report.frame_ms},
                        {"composition_frame_ms", report.composition_frame_ms}};
    for (const PlainReport::NodeQuality& node : report.nodes)
      json["pictures"]["nodes"].push_back({{"node", node.node}, {"psnr_db", node.psnr_db}});
  }
  return json;
}

}  // namespace rebake
