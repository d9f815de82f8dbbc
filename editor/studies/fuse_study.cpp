#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "editor/actions/plain_scene.h"
#include "editor/studies/study.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

// The scene with a rotated copy of itself beside it. One plain folder cannot represent that exactly, so a decoder must
// be fitted.
Scene with_rotated_copy(const Scene& scene) {
  const Box box = world_bounds(scene);
  Node group;
  group.name = "rotated copy";
  group.to_parent = Eigen::Translation3d(1.1 * box.sizes().x(), 0, 0) * Eigen::Translation3d(box.center()) *
                    Eigen::AngleAxisd(2.6, Vec3(0.3, 1, 0.1).normalized()) * Eigen::Translation3d(-box.center());
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.visible || !placed.node->object) continue;
    Node copy;
    copy.name = placed.node->name + " rotated";
    copy.object = placed.node->object;
    copy.to_parent = placed.to_world;
    group.children.push_back(std::make_shared<const Node>(std::move(copy)));
  }
  return with_added(scene, std::move(group), NodeId::none, scene.roots.size());
}

}  // namespace

StudyTable study_fuse(const StudyInput& input) {
  const FuseOptions standard;
  const Scene scene = composed(input.scene, 4096).exact() ? with_rotated_copy(input.scene) : input.scene;
  PlainSceneBuilder parts(scene, {}, standard.layout, input.progress);
  const Composition& composition = parts.composition;
  const TexelSample sample =
      sampled(composition, *parts.sightlines, standard.sample, standard.training.seed, input.progress);
  StudyTable table{{"seconds", "image PSNR dB", "milliseconds per frame", "worst image dB", "texels dB",
                    "99 % of texels dB", "width"},
                   {},
                   0,
                   1,
                   false,
                   false};
  table.second_x = 2;

  struct Trained {
    Student student;
    double seconds;
  };
  const auto trained = [&](const std::function<Student()>& train) {
    const Clock::time_point start = Clock::now();
    Student student = train();
    return Trained{std::move(student), std::chrono::duration<double>(Clock::now() - start).count()};
  };
  const auto add = [&](const std::string& name, const Trained& way, const FuseOptions& options) {
    const FusePlan plan{{{way.student, {}}}, 0, std::nullopt};
    PlainReport report;
    const Fused fused = fuse(composition, *parts.sightlines, plan, options, input.progress);
    Scene plain;
    Node node;
    node.name = "scene";
    node.object = fused.object;
    plain = with_added(plain, std::move(node), NodeId::none, 0);
    constexpr int size = 400;
    measure_pictures(input.renderer(), scene, {}, plain, report, input.progress, size);
    const double frame_ms = median_frame_ms(input.renderer(), plain, input.view, input.frames);
    const std::size_t width = std::max(way.student.decoder.hidden0, way.student.decoder.hidden1);
    table.rows.push_back(
        {name,
         {way.seconds + fused.report.seconds, report.whole.psnr_db, frame_ms, report.whole.worst_psnr_db,
          fused.report.whole.psnr_db, fused.report.whole.worst_psnr_db, static_cast<double>(width)}});
  };

  // The teacher with the most texels.
  std::vector<std::uint64_t> texels(composition.teachers.size());
  for (const Composition::Block& block : composition.blocks)
    texels[composition.parts[block.part].teacher] += block.opaque;
  const auto base = static_cast<std::size_t>(std::max_element(texels.begin(), texels.end()) - texels.begin());
  const TrainingOptions& training = standard.training;
  const Trained keep = trained([&] { return keeping(composition, sample, base, training, input.progress); });
  add("keep", keep, standard);
  for (const std::size_t width : {16U, 32U})
    add(fmt::format("train {}", width),
        trained([&] { return fine_tuned(keep.student, composition, sample, width, training, input.progress); }),
        standard);
  for (const std::size_t width : {16U, 24U, 32U, 48U}) {
    const Trained fresh = trained([&] { return from_scratch(composition, sample, width, training, input.progress); });
    if (width == 16) {
      FuseOptions options = standard;
      options.iterations = 0;
      add("new 16, map only", fresh, options);
      options = standard;
      options.search = false;
      add("new 16, + Gauss-Newton", fresh, options);
      add("new 16, + bytes", fresh, standard);
    } else {
      add(fmt::format("new {}", width), fresh, standard);
    }
  }
  const Trained beside = trained([&] { return side_by_side(composition, sample, 1); });
  for (const int bits : {8, 7, 6}) {
    FuseOptions options = standard;
    options.bits = bits;
    add(fmt::format("side by side, {} bits", bits), beside, options);
  }
  return table;
}

}  // namespace rebake
