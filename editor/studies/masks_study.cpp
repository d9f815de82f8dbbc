#include <fmt/format.h>

#include <cmath>
#include <random>

#include "editor/studies/study.h"
#include "mesh_ops/index/index.h"
#include "mesh_ops/select/mask_votes.h"
#include "mesh_ops/select/picture.h"

namespace rebake {

namespace {

constexpr int side = 300;  // pixels of a photograph

// Per object and triangle, 1 if its centroid lies in the upper half of the scene: what the masks show.
std::vector<TriangleSet> upper_half(const std::vector<PlacedNode>& objects, double middle) {
  std::vector<TriangleSet> flags;
  for (const PlacedNode& placed : objects) {
    TriangleSet& own = flags.emplace_back();
    for (const TextureSet& set : placed.node->object->sets)
      for (const Face& face : set.soup.faces()) {
        Vec3 sum = Vec3::Zero();
        for (const std::uint32_t vertex : face) sum += placed.to_world * set.soup.positions()[vertex];
        own.push_back(sum.y() / 3 > middle ? 1 : 0);
      }
  }
  return flags;
}

// Photographs from `count` eyes around the scene, with exact masks.
std::vector<MaskedPhoto> photographs(const std::vector<PlacedNode>& objects, const std::vector<TriangleSet>& inside,
                                     const Box& box, int count) {
  const SceneRays rays = rays_through(objects);
  std::vector<MaskedPhoto> photos;
  for (const Viewpoint& from : viewpoints_around(box, count, 2.5)) {
    Camera view;
    view.eye = from.eye;
    view.target = box.center();
    view.fov_degrees = 50;
    MaskedPhoto photo{photo_camera(view, "", side, side), {side, side, {}}};
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Vec2 plane = (Vec2(x + 0.5, y + 0.5) - photo.camera.center).cwiseQuotient(photo.camera.focal);
        const auto hit = rays.nearest(view.eye, photo.camera.axes * Vec3(plane.x(), -plane.y(), -1), 0,
                                      std::numeric_limits<double>::infinity());
        photo.mask.labels.push_back(hit ? inside[hit->instance][hit->triangle] : 0);
      }
    photos.push_back(std::move(photo));
  }
  return photos;
}

// Inverts a share of the pixels, the same in each run.
void add_noise(std::vector<MaskedPhoto>& photos, double share) {
  std::mt19937 random(1);
  for (MaskedPhoto& photo : photos)
    for (std::uint8_t& label : photo.mask.labels)
      if (static_cast<double>(random()) < share * 4294967296.0) label = label == 0 ? 1 : 0;
}

}  // namespace

StudyTable study_masks(const StudyInput& input) {
  StudyTable table{
      {"ms", "wrong triangles %", "photographs", "wrong pixels %", "unseen triangles %"}, {}, 0, 1, true, false};
  std::vector<PlacedNode> objects;
  for (const PlacedNode& placed : placed_nodes(input.scene))
    if (placed.visible && placed.node->object) objects.push_back(placed);
  const Box box = world_bounds(input.scene);
  const std::vector<TriangleSet> inside = upper_half(objects, box.center().y());
  for (const int count : {4, 8, 16, 32, 64})
    for (const double noise : {0.0, 0.1, 0.3}) {
      input.progress.at("voting", static_cast<double>(table.rows.size()) / 15);
      std::vector<MaskedPhoto> photos = photographs(objects, inside, box, count);
      add_noise(photos, noise);
      std::vector<MaskVotes> votes;
      const double time =
          median_milliseconds(std::min(input.frames, 3), [&] { votes = mask_votes(objects, objects, photos, {1}); });
      std::size_t seen = 0, wrong = 0, all = 0;
      for (std::size_t k = 0; k < objects.size(); ++k) {
        const MaskDecision decision = decide(votes[k], 0.5);
        seen += decision.seen;
        all += inside[k].size();
        for (std::size_t f = 0; f < inside[k].size(); ++f)
          if (votes[k].seen[f] > 0 && decision.chosen[0][f] != inside[k][f]) ++wrong;
      }
      const auto percent = [](std::size_t part, std::size_t whole) {
        return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
      };
      table.rows.push_back(
          {fmt::format("{} masks, {:g} % wrong", count, noise * 100),
           {time, percent(wrong, seen), static_cast<double>(count), noise * 100, percent(all - seen, all)}});
    }
  return table;
}

}  // namespace rebake
