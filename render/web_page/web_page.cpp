#include "render/web_page/web_page.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "render/gl/shader_library.h"
#include "render/graph/effects.h"
#include "render/graph/plan.h"
#include "render/passes/decoder_glsl.h"
#include "render/web_page/page_text.h"
#include "render/web_page/web_mesh.h"

namespace rebake {

namespace {

using nlohmann::json;

json json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json json_of(const Camera& camera) {
  return {{"eye", json_of(camera.eye)}, {"target", json_of(camera.target)},   {"up", json_of(camera.up)},
          {"fov", camera.fov_degrees},  {"orthoHeight", camera.ortho_height}, {"near", camera.near_plane},
          {"far", camera.far_plane}};
}

template <class Matrix>
json row_major(const Matrix& m) {
  json values = json::array();
  for (Eigen::Index row = 0; row < m.rows(); ++row)
    for (Eigen::Index column = 0; column < m.cols(); ++column) values.push_back(m(row, column));
  return values;
}

// A plan of all visible nodes, whatever is in view of the cameras.
FramePlan plan_of_all(const Scene& scene, const Lighting& lighting) {
  const Box box = world_bounds(scene);
  if (box.isEmpty()) throw EditError("there is nothing to publish: no visible node has triangles");
  Camera all;
  all.target = box.center();
  all.eye = box.center() + Vec3(0, 0, box.diagonal().norm());
  all.ortho_height = 1.1 * box.diagonal().norm();
  all.near_plane = 0.1 * box.diagonal().norm();
  all.far_plane = 2 * box.diagonal().norm();
  RenderOptions options;
  options.shading = RenderOptions::Shading::deferred;
  options.weights = RenderOptions::Weights::constants;
  options.occlusion = RenderOptions::Occlusion::off;
  View view;
  view.camera = all;
  return plan(scene, view, options, nullptr, &lighting);
}

// Spacing of positions, a power of two: WebPageOptions::steps_per_pixel, but few enough steps that a position fits into
// 30 bits.
double grid_step(const Box& box, const Affine& to_world, const WebPageOptions& options) {
  const double scale = to_world.linear().norm() / std::sqrt(3.0);
  double depth = std::numeric_limits<double>::infinity();
  const Vec3 forward = (options.home.target - options.home.eye).normalized();
  for (int k = 0; k < 8; ++k)
    depth = std::min(depth, forward.dot(to_world * box.corner(static_cast<Box::CornerType>(k)) - options.home.eye));
  const double pixel = 2 * half_height(options.home, std::max(depth, options.home.near_plane)) / options.home_height;
  const double wanted = pixel / options.steps_per_pixel / scale, least = box.diagonal().maxCoeff() * std::exp2(-28);
  return std::exp2(std::floor(std::log2(std::max(wanted, least))));
}

// Defines of the shaders of a draw, all that geometry.vert, geometry.frag and forward.frag test.
struct Kind {
  bool turned = false;
  int lit = 0;  // 1: gain, 2: gain and offset
  std::string name() const { return fmt::format("{}{}", turned ? "turned" : "plain", lit); }
  std::string defines() const {
    return fmt::format("#define TURNED_MESH {}\n#define LIT_MESH {}\n#define GLOSSY_MESH 0\n", turned ? 1 : 0, lit);
  }
};

// The page while it is made.
class Publisher {
 public:
  Publisher(const FramePlan& plan, const Camera& plan_camera, const WebPageOptions& options)
      : plan_(plan), camera_to_world_(Affine(world_to_camera(plan_camera).transpose())), options_(options) {
    camera_to_world_.translation() = plan_camera.eye;
    for (const Draw& draw : plan.draws) {
      light_ = std::max(light_, light_of(draw));
      rays_ = rays_ || (draw.set.soup.rotations() != nullptr && plan.uses_view_direction);
      glossy_ = glossy_ || (draw.light && draw.light->gloss);
    }
    frames_ = plan.frames.size() > 1;
  }

  WebPage page(const Progress& progress) {
    json draws = json::array();
    for (const Draw& draw : plan_.draws) add_step(draw);
    for (std::size_t k = 0; k < plan_.draws.size(); ++k) {
      progress.at("publishing", static_cast<double>(k) / static_cast<double>(plan_.draws.size()));
      draws.push_back(draw_of(plan_.draws[k], k));
    }
    json manifest = {{"draws", draws},
                     {"sets", sets_},
                     {"frames", frames()},
                     {"home", json_of(options_.home)},
                     {"background", json_of(plan_.background)},
                     {"up", json_of(options_.up)},
                     {"box", {json_of(box_.min()), json_of(box_.max())}},
                     {"targets", {{"frames", frames_}, {"rays", rays_}, {"light", light_}}},
                     {"programs", programs()}};
    manifest["views"] = json::array();
    for (const auto& [name, camera] : options_.views)
      manifest["views"].push_back({{"name", name}, {"camera", json_of(camera)}});
    decide();
    manifest["decisions"] = page_.decisions;
    manifest["triangles"] = page_.triangles;
    page_.files["scene.json"] = manifest.dump();
    return std::move(page_);
  }

 private:
  static int light_of(const Draw& draw) { return !draw.light ? 0 : draw.light->offset.empty() ? 1 : 2; }

  json draw_of(const Draw& draw, std::size_t number) {
    const Affine to_world = camera_to_world_ * draw.to_camera;
    Kind kind{draw.set.soup.rotations() != nullptr && plan_.uses_view_direction, light_of(draw)};
    kinds_[kind.name()] = kind;
    box_.extend(transformed(draw.set.soup.bounds(), to_world));
    json result = {{"set", set_of(draw, number)},
                   {"frame", draw.frame},
                   {"kind", kind.name()},
                   {"toWorld", row_major(to_world.matrix().topRows<3>())},
                   {"objectToFed", row_major(axes_matrix(draw.axes))}};
    if (draw.light) {
      const LightChart& chart = *draw.light->chart;
      result["light"] = {{"width", chart.width}, {"height", chart.height}};
      result["light"]["gain"] =
          add_file(fmt::format("light{}.gain.gz", number), web_light_texels(chart, draw.light->gain));
      if (!draw.light->offset.empty())
        result["light"]["offset"] =
            add_file(fmt::format("light{}.offset.gz", number), web_light_texels(chart, draw.light->offset));
    }
    return result;
  }

  static bool share_a_set(const Draw& a, const Draw& b) {
    return !a.light && !b.light && a.set.texels == b.set.texels &&
           a.set.soup.shared_positions() == b.set.soup.shared_positions() &&
           a.set.soup.shared_uvs() == b.set.soup.shared_uvs() &&
           a.set.soup.shared_faces() == b.set.soup.shared_faces() && a.set.soup.rotations() == b.set.soup.rotations();
  }

  // The grid of a set suits the instance that needs the finest one.
  void add_step(const Draw& draw) {
    const double step = grid_step(draw.set.soup.bounds(), camera_to_world_ * draw.to_camera, options_);
    for (auto& [other, finest] : steps_)
      if (share_a_set(*other, draw)) {
        finest = std::min(finest, step);
        return;
      }
    steps_.emplace_back(&draw, step);
  }
  double step_of(const Draw& draw) const {
    for (const auto& [other, finest] : steps_)
      if (other == &draw || share_a_set(*other, draw)) return finest;
    throw std::logic_error("a draw without a grid");
  }

  // The number of a draw's set; draws that share everything share it.
  std::size_t set_of(const Draw& draw, std::size_t number) {
    for (std::size_t k = 0; k < known_.size(); ++k)
      if (share_a_set(*known_[k].draw, draw)) {
        page_.triangles += known_[k].triangles;
        return k;
      }
    const PreparedSurface surface = prepared_surface(draw.set, false);
    json set;
    const WebMesh mesh = web_mesh(surface, step_of(draw), draw.light.get(), set);
    page_.triangles += mesh.triangles;
    set["mesh"] = add_file(fmt::format("mesh{}.gz", number), mesh.bytes);
    WebTexels texels = web_texels(surface);
    set["texels"] = {{"width", texels.width}, {"height", texels.height}};
    for (const auto& [image, texel_image] : {std::pair(0, &texels.image0), {1, &texels.image1}})
      set["texels"]["images"].push_back(
          add_file(fmt::format("feat{}.{}.{}", number, image, texel_image->extension), std::move(texel_image->bytes)));
    sets_.push_back(set);
    known_.push_back({&draw, mesh.triangles});
    return sets_.size() - 1;
  }

  json add_file(const std::string& name, std::string bytes) {
    json file = {{"name", "data/" + name}, {"bytes", bytes.size()}};
    page_.files["data/" + name] = std::move(bytes);
    return file;
  }

  json frames() const {
    json frames = json::array();
    for (const DecodeFrame& frame : plan_.frames)
      frames.push_back({{"decoder", frame.decoder},
                        {"worldToDecoder", row_major(frame.world_to_decoder)},
                        {"alpha", frame.alpha_code == AlphaCode::halved ? json{2, -1} : json{1, 0}}});
    return frames;
  }

  // The shaders: geometry and forward for each kind of draw, resolve for the scene.
  json programs() const {
    const std::string decoders = decoder_constants_glsl(plan_.decoders, RenderOptions::Precision::full);
    const std::string targets =
        fmt::format("#define WRITES_FRAME {}\n#define WRITES_RAY {}\n#define WRITES_LIGHT {}\n", frames_ ? 1 : 0,
                    rays_ ? 1 : 0, light_) +
        fmt::format("#define FRAME_TARGET 1\n#define RAY_TARGET {}\n#define GAIN_TARGET {}\n#define OFFSET_TARGET {}\n",
                    frames_ ? 2 : 1, 1 + (frames_ ? 1 : 0) + (rays_ ? 1 : 0), 2 + (frames_ ? 1 : 0) + (rays_ ? 1 : 0));
    const auto pair = [](const std::string& vertex, const std::string& fragment, const std::string& defines,
                         const std::string& functions = "") {
      return json{{"vertex", gl::web_shader_source(vertex, defines)},
                  {"fragment", gl::web_shader_source(fragment, defines + functions)}};
    };
    json programs;
    for (const auto& [name, kind] : kinds_) {
      programs["geometry " + name] = pair("geometry.vert", "geometry.frag", kind.defines() + targets);
      programs["forward " + name] = pair("geometry.vert", "forward.frag", kind.defines(), decoders);
    }
    programs["resolve"] =
        pair("fullscreen.vert", "resolve.frag",
             targets + fmt::format("#define SIDE 2\n#define RAY_PER_SAMPLE {}\n#define FRAME_TEXTURE 1\n",
                                   frames_ || rays_ ? 1 : 0),
             decoders);
    programs["join"] = pair("fullscreen.vert", "join_images.frag", "");
    return programs;
  }

  void decide() {
    const auto say = [&](const char* name, bool carried, const std::string& why) {
      page_.decisions.push_back(fmt::format("{} {}: {}", carried ? "carried" : "left out", name, why));
    };
    say("node target", frames_,
        frames_ ? fmt::format("{} decoders or orientations", plan_.frames.size()) : "one decoder and orientation");
    say("rotated rays", rays_, rays_ ? "edits rotated triangles" : "no triangle was rotated relative to its object");
    say("light maps", light_ > 0, light_ > 0 ? "light follows edits" : "light changes nothing");
    if (glossy_) say("moving highlights", false, "the page does not draw them; light maps keep their diffuse part");
    say("view direction", plan_.uses_view_direction,
        plan_.uses_view_direction ? "colours depend on it" : "no decoder depends on it");
  }

  const FramePlan& plan_;
  Affine camera_to_world_;
  const WebPageOptions& options_;
  WebPage page_;
  json sets_ = json::array();
  struct Known {
    const Draw* draw;  // the first of the set
    std::size_t triangles;
  };
  std::vector<Known> known_;                           // per set
  std::vector<std::pair<const Draw*, double>> steps_;  // first draw and grid of sets that are shared
  std::map<std::string, Kind> kinds_;
  Box box_;
  bool frames_ = false, rays_ = false, glossy_ = false;
  int light_ = 0;
};

}  // namespace

WebPage web_page(const Scene& scene, const Lighting& lighting, const WebPageOptions& options,
                 const Progress& progress) {
  const FramePlan plan = plan_of_all(scene, lighting);
  WebPage page = Publisher(plan, plan.view.camera, options).page(progress);
  add_page_text(page, options);
  return page;
}

}  // namespace rebake
