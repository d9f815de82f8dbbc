#include "render/web_page/web_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "render/gl/shader_library.h"
#include "render/graph/effects.h"
#include "render/graph/plan.h"
#include "render/passes/decoder_glsl.h"
#include "render/passes/gloss_uniforms.h"
#include "render/web_page/page_text.h"
#include "render/web_page/scene_motion.h"
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
  bool glossy = false;
  std::string name() const { return fmt::format("{}{}{}", turned ? "turned" : "plain", lit, glossy ? " glossy" : ""); }
  std::string defines() const {
    return fmt::format("#define TURNED_MESH {}\n#define LIT_MESH {}\n#define GLOSSY_MESH {}\n#define GLOSS_SUNS {}\n",
                       turned ? 1 : 0, lit, glossy ? 1 : 0, Gloss::max_suns);
  }
};

// One scene of a page while it is made.
class Publisher {
 public:
  // `prefix`: of the names of its files.
  // `poses`: of nodes that bend, or null.
  Publisher(const FramePlan& plan, const WebPageOptions& options, std::string prefix, WebPage& page,
            const std::map<NodeId, BendPoses>* poses = nullptr)
      : plan_(plan),
        poses_(poses),
        frame_list_(plan.frames),
        camera_to_world_(Affine(world_to_camera(plan.view.camera).transpose())),
        options_(options),
        prefix_(std::move(prefix)),
        page_(page) {
    camera_to_world_.translation() = plan.view.camera.eye;
    for (const Draw& draw : plan.draws) frame_of_.push_back(draw.frame);
    for (const Draw& draw : plan.draws) {
      light_ = std::max(light_, light_of(draw));
      rays_ = rays_ || rotates(draw);
      glossy_ = glossy_ || is_glossy(draw);
    }
    if (glossy_) light_ = 2;  // highlights are added
  }

  // Writes the scene's files. `motion`: keyframes, or null.
  json manifest(const SceneMotion* motion, const Progress& progress) {
    if (motion != nullptr) give_own_frames(*motion);
    frames_ = frame_list_.size() > 1;
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
    if (options_.transparent) manifest["transparent"] = true;
    if (motion != nullptr) manifest["motion"] = motion_entry(*motion);
    manifest["triangles"] = triangles_;
    return manifest;
  }

  // The parts that the scene needs, and why.
  std::vector<std::string> decisions() const {
    std::vector<std::string> said;
    const auto say = [&](const char* name, bool carried, const std::string& why) {
      said.push_back(fmt::format("{} {}: {}", carried ? "carried" : "left out", name, why));
    };
    say("node target", frames_,
        frames_ ? fmt::format("{} decoders, orientations or alpha codes", frame_list_.size())
                : "one decoder and orientation");
    say("rotated rays", rays_,
        rays_ ? "edits or bends rotate triangles" : "no triangle was rotated relative to its object");
    say("light maps", light_ > 0, light_ > 0 ? "light follows edits" : "light changes nothing");
    if (light_ > 0)
      say("moving highlights", glossy_, glossy_ ? "specular surfaces were rotated" : "no rotated surface is specular");
    say("view direction", plan_.uses_view_direction,
        plan_.uses_view_direction ? "colours depend on it" : "no decoder depends on it");
    return said;
  }
  std::size_t triangles() const { return triangles_; }

 private:
  // Nodes that move have frames of their own, which the page rotates. Leaves out those that no draw uses then.
  void give_own_frames(const SceneMotion& motion) {
    frame_list_.clear();
    std::map<std::pair<NodeId, std::size_t>, std::size_t> number_of;  // by the node, if it moves, and its former frame
    for (std::size_t k = 0; k < plan_.draws.size(); ++k) {
      const Draw& draw = plan_.draws[k];
      const auto moved = motion.places.find(draw.node);
      const NodeId own = moved == motion.places.end() ? NodeId::none : draw.node;
      const auto [frame, added] = number_of.emplace(std::pair(own, draw.frame), frame_list_.size());
      if (added) frame_list_.push_back(plan_.frames[draw.frame]);
      frame_of_[k] = frame->second;
      if (moved == motion.places.end()) continue;
      moving_.push_back(k);
      const Affine rest = camera_to_world_ * draw.to_camera;
      const Box bounds = bounds_of(draw);
      for (const Affine& place : moved->second.at_times)
        box_.extend(transformed(bounds, place * moved->second.rest.inverse() * rest));
    }
  }

  // The times, and the numbers of each sample: per moving draw the rows of object to world and of world to decoder,
  // then the camera.
  json motion_entry(const SceneMotion& motion) {
    std::string bytes;
    const auto put = [&](double value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    const auto put_all = [&](const auto& m) {
      for (Eigen::Index row = 0; row < m.rows(); ++row)
        for (Eigen::Index column = 0; column < m.cols(); ++column) put(m(row, column));
    };
    for (const double seconds : motion.times) put(seconds);
    for (std::size_t t = 0; t < motion.times.size(); ++t) {
      for (const std::size_t k : moving_) {
        const NodePlaces& places = motion.places.at(plan_.draws[k].node);
        const Affine& place = places.at_times[t];
        put_all(
            (place * places.rest.inverse() * camera_to_world_ * plan_.draws[k].to_camera).matrix().topRows<3>().eval());
        // Decoders rotate with their object.
        put_all((frame_list_[frame_of_[k]].world_to_decoder * orthogonal_factor(places.rest.linear()) *
                 orthogonal_factor(place.linear()).transpose())
                    .eval());
      }
      if (motion.cameras.empty()) continue;
      const Camera& camera = motion.cameras[t];
      for (const Vec3& v : {camera.eye, camera.target, camera.up}) put_all(v);
      for (const double value : {camera.fov_degrees, camera.ortho_height, camera.near_plane, camera.far_plane})
        put(value);
    }
    return {{"file", add_file("motion.gz", gzipped(bytes))},
            {"samples", motion.times.size()},
            {"draws", moving_},
            {"bends", bends_},
            {"camera", !motion.cameras.empty()}};
  }

  // Whether edits rotated triangles of a draw, or its poses do.
  bool has_rotations(const Draw& draw) const {
    if (draw.set.soup.rotations() != nullptr) return true;
    if (poses_ == nullptr || !poses_->contains(draw.node)) return false;
    const auto& poses = poses_->at(draw.node).poses;
    return std::any_of(poses.begin(), poses.end(), [](const auto& pose) { return pose->any_rotations(); });
  }
  bool rotates(const Draw& draw) const { return plan_.uses_view_direction && has_rotations(draw); }
  static bool is_glossy(const Draw& draw) { return draw.light && draw.light->gloss; }
  static int light_of(const Draw& draw) { return !draw.light ? 0 : draw.light->offset.empty() ? 1 : 2; }

  json draw_of(const Draw& draw, std::size_t number) {
    const Affine to_world = camera_to_world_ * draw.to_camera;
    Kind kind{rotates(draw), light_of(draw), is_glossy(draw)};
    kinds_[kind.name()] = kind;
    box_.extend(transformed(bounds_of(draw), to_world));
    json result = {{"set", set_of(draw, number)},
                   {"frame", frame_of_[number]},
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
      if (is_glossy(draw)) result["light"]["gloss"] = gloss_entry(*draw.light->gloss, number);
    }
    return result;
  }

  json gloss_entry(const GlossMap& map, std::size_t number) {
    const GlossUniforms values = gloss_uniforms(*map.gloss);
    const auto flat = [](const auto& vectors) {
      json list = json::array();
      for (const Eigen::Vector3f& v : vectors)
        for (int c = 0; c < 3; ++c) list.push_back(v[c]);
      return list;
    };
    return {{"before", add_file(fmt::format("light{}.before.gz", number), web_gloss_normals(map.before.normals))},
            {"after", add_file(fmt::format("light{}.after.gz", number), web_gloss_normals(map.after.normals))},
            {"suns", add_file(fmt::format("light{}.suns.gz", number), web_gloss_suns(map))},
            {"sky", flat(values.sky)},
            {"directions", flat(values.directions)},
            {"lights", flat(values.lights)},
            {"count", values.suns},
            {"sharpness", values.sharpness}};
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
        triangles_ += known_[k].triangles;
        return k;
      }
    const PreparedSurface surface = prepared_surface(draw.set, false);
    json set;
    const WebMesh mesh = web_mesh(surface, step_of(draw), has_rotations(draw), draw.light.get(), set);
    add_poses(draw, surface, number);
    triangles_ += mesh.triangles;
    set["mesh"] = add_file(fmt::format("mesh{}.gz", number), mesh.bytes);
    WebTexels texels = web_texels(surface, options_.coding);
    set["texels"] = {{"width", texels.width}, {"height", texels.height}};
    for (const auto& [image, texel_image] : {std::pair(0, &texels.image0), {1, &texels.image1}})
      set["texels"]["images"].push_back(
          add_file(fmt::format("feat{}.{}.{}", number, image, texel_image->extension), std::move(texel_image->bytes)));
    sets_.push_back(set);
    known_.push_back({&draw, mesh.triangles});
    return sets_.size() - 1;
  }

  // A draw's triangles in all poses of its node; empty if it does not bend.
  std::vector<const Soup*> poses_of(const Draw& draw) const {
    if (poses_ == nullptr || !poses_->contains(draw.node)) return {};
    const BendPoses& bend = poses_->at(draw.node);
    const auto set = std::find_if(bend.rest->sets.begin(), bend.rest->sets.end(), [&](const TextureSet& one) {
      return one.soup.shared_positions() == draw.set.soup.shared_positions();
    });
    if (set == bend.rest->sets.end()) throw std::logic_error("a draw that is not of its node's poses");
    std::vector<const Soup*> soups;
    for (const auto& pose : bend.poses)
      soups.push_back(&pose->sets[static_cast<std::size_t>(set - bend.rest->sets.begin())].soup);
    return soups;
  }

  // Bounds of a draw's triangles in object space, in all poses.
  Box bounds_of(const Draw& draw) const {
    Box bounds = draw.set.soup.bounds();
    for (const Soup* pose : poses_of(draw)) bounds.extend(pose->bounds());
    return bounds;
  }

  // The poses of a set that is about to be added, if it bends.
  void add_poses(const Draw& draw, const PreparedSurface& surface, std::size_t number) {
    const std::vector<const Soup*> soups = poses_of(draw);
    if (soups.empty()) return;
    json entry = {{"set", sets_.size()}, {"seconds", poses_->at(draw.node).seconds}};
    entry["mesh"] = add_file(fmt::format("poses{}.gz", number),
                             web_poses(surface, step_of(draw), has_rotations(draw), soups, entry));
    bends_.push_back(entry);
  }

  // Equal files are carried once.
  json add_file(const std::string& name, std::string bytes) {
    for (const auto& [known, content] : page_.files)
      if (content == bytes) return {{"name", known}, {"bytes", bytes.size()}};
    const std::string path = "data/" + prefix_ + name;
    // Otherwise the page could not be replaced by a new one.
    if (!is_page_file(path)) throw std::logic_error("is_page_file() does not know " + path);
    json file = {{"name", path}, {"bytes", bytes.size()}};
    page_.files[path] = std::move(bytes);
    return file;
  }

  json frames() const {
    json frames = json::array();
    for (const DecodeFrame& frame : frame_list_)
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

  const FramePlan& plan_;
  const std::map<NodeId, BendPoses>* poses_;
  json bends_ = json::array();
  std::vector<DecodeFrame> frame_list_;
  std::vector<std::size_t> frame_of_, moving_;  // frame of each draw; draws with keyframes
  Affine camera_to_world_;
  const WebPageOptions& options_;
  std::string prefix_;
  WebPage& page_;
  std::size_t triangles_ = 0;
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

WebPage web_page(const LitScene& scene, const WebPageOptions& options, const Progress& progress,
                 const std::optional<LitScene>& before) {
  WebPage page;
  const FramePlan plan = plan_of_all(scene.scene, scene.lighting);
  const std::map<NodeId, BendPoses> no_poses;
  const std::optional<SceneMotion> motion = scene_motion(scene.scene, scene.poses != nullptr ? *scene.poses : no_poses);
  Publisher publisher(plan, options, "", page, scene.poses);
  json manifest = publisher.manifest(motion ? &*motion : nullptr, progress);
  page.triangles = publisher.triangles();
  page.decisions = publisher.decisions();
  const auto say = [&](const char* name, bool carried, const std::string& why) {
    page.decisions.push_back(fmt::format("{} {}: {}", carried ? "carried" : "left out", name, why));
  };
  std::string moving = "nothing moves";
  if (motion) {
    std::vector<std::string> parts;
    if (const std::size_t nodes = motion->places.size(); nodes > 0)
      parts.push_back(counted(nodes, "node moves", "nodes move"));
    if (!motion->cameras.empty()) parts.emplace_back("the camera moves");
    if (scene.poses != nullptr && !scene.poses->empty()) parts.emplace_back("bends change");
    if (parts.empty()) parts.emplace_back("no node moves");
    moving = fmt::format("{}; {:.4g} s long", fmt::join(parts, ", "), motion->duration());
  }
  say("keyframes", motion.has_value(), moving);
  if (motion && scene.lighting.maps.size() > 0)
    say("light of moving nodes", false, "light maps stay as they are while nodes move");
  double deviation = 0;
  if (scene.poses != nullptr)
    for (const auto& [node, bend] : *scene.poses)
      deviation = std::max(deviation, bend.deviation / bend.rest->bounds().diagonal().norm());
  const bool bends = scene.poses != nullptr && !scene.poses->empty();
  say("bends by keyframes", bends,
      bends ? fmt::format("{} by poses; between them vertices are at most {:.2g} of their object's size from "
                          "their places",
                          counted(scene.poses->size(), "node bends", "nodes bend"), deviation)
            : "nothing bends");
  say("scene before the edits", before.has_value(), before ? "asked for" : "not asked for");
  for (const auto& [name, camera] : options.views) {
    json view = {{"name", name}, {"camera", json_of(camera)}};
    if (const auto picture = options.thumbnails.find(name); picture != options.thumbnails.end()) {
      const std::string file = fmt::format("data/view{}.png", manifest["views"].size());
      page.files[file] = picture->second;
      view["thumbnail"] = {{"name", file}, {"bytes", picture->second.size()}};
    }
    manifest["views"].push_back(view);
  }
  if (!options.poster.empty()) page.files["poster.png"] = options.poster;
  if (before) {
    const FramePlan earlier = plan_of_all(before->scene, before->lighting);
    Publisher other(earlier, options, "before.", page);
    json other_manifest = other.manifest(nullptr, progress);
    other_manifest["decisions"] = other.decisions();
    page.files["before.json"] = other_manifest.dump();
    manifest["before"] = true;
  }
  manifest["decisions"] = page.decisions;
  page.files["scene.json"] = manifest.dump();
  add_page_text(page, options);
  return page;
}

}  // namespace rebake
