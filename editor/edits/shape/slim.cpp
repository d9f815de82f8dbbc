#include "editor/edits/shape/slim.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "editor/edits/describe.h"
#include "editor/edits/select/selecting.h"
#include "editor/edits/stored_view.h"
#include "mesh_ops/features/atlas.h"
#include "mesh_ops/features/slim.h"
#include "mesh_ops/select/duplicates.h"

namespace rebake {

namespace {

constexpr int largest_side = 4096;

EyeRegion eyes_for(const PlacedNode& placed, const std::vector<Camera>& cameras, const Slim& edit) {
  EyeRegion eyes;
  eyes.world_to_object = placed.to_world.inverse();
  if (edit.eyes) eyes.box = Box(edit.eyes->min, edit.eyes->max);
  for (const Camera& camera : cameras) {
    const Vec3 back = eyes.world_to_object.linear() * world_to_camera(camera).row(2).transpose();
    eyes.standpoints.push_back(
        {eyes.world_to_object * camera.eye, camera.orthographic() ? Vec3(back.normalized()) : Vec3::Zero()});
  }
  return eyes;
}

std::uint64_t texel_area(const BakedObject& object) {
  std::uint64_t area = 0;
  for (const TextureSet& set : object.sets)
    area += static_cast<std::uint64_t>(set.texels->width()) * static_cast<std::uint64_t>(set.texels->height());
  return area;
}

// Packed, with what shows nothing emptied; as it was where its texels cannot be moved.
std::vector<TextureSet> packed(const BakedObject& object, const std::string& name, std::vector<std::string>& lines) {
  std::vector<TextureSet> sets = object.sets;
  if (!std::all_of(sets.begin(), sets.end(), can_pack)) {
    lines.push_back(fmt::format("{}: textures keep their size: some UVs lie outside 0 … 1", name));
  } else {
    std::vector<TextureSet> smaller = pack(sets, largest_side, sets.front().texels->alpha_code()).sets;
    BakedObject made;
    made.sets = smaller;
    // Textures that are full already only gain borders.
    if (texel_area(made) < texel_area(object)) sets = std::move(smaller);
  }
  for (TextureSet& set : sets) set.texels = with_empty_rest(*set.texels);
  return sets;
}

std::string bits_words(const BitsFound& found) {
  if (!std::isfinite(found.psnr_db)) return "all features keep their 8 bits";
  std::string words;
  int sum = 0;
  for (const int bits : found.bits) {
    words += fmt::format("{}{}", words.empty() ? "" : ", ", bits);
    sum += bits;
  }
  return fmt::format("features keep {} bits ({:.1f} on average): texels' colours at {:.1f} dB", words, sum / 8.0,
                     found.psnr_db);
}

}  // namespace

Outcome apply(const Scene& scene, const Slim& edit, const Progress& progress) {
  if (edit.rays < 16 || edit.rays > 65536) throw FieldError("rays", "must lie between 16 and 65536");
  if (edit.psnr != 0 && !(edit.psnr >= 20 && edit.psnr <= 80))
    throw FieldError("psnr", "must lie between 20 and 80 dB, or be 0: nothing may be lost");
  if (edit.eyes && !edit.views.empty()) throw FieldError("eyes", "either eyes or views, not both");
  if (edit.eyes && !((edit.eyes->max - edit.eyes->min).minCoeff() >= 0))
    throw FieldError("eyes", "its min must not lie above its max");
  std::vector<Camera> cameras;
  for (const std::string& name : edit.views) cameras.push_back(stored_view(scene, name, "views"));
  Scene result = scene;
  std::vector<std::string> lines;
  const std::vector<PlacedNode> targets = selectable(scene, edit.node);
  for (const PlacedNode& placed : targets) {
    const BakedObject& before = *placed.node->object;
    const std::string& name = placed.node->name;
    const Sightings seen = look_from(before, eyes_for(placed, cameras, edit), edit.rays, progress);
    const TriangleSet twins = duplicate_triangles(before);
    TriangleSet dropped = seen.unseen;
    std::size_t duplicates = 0;
    for (std::size_t f = 0; f < dropped.size(); ++f) {
      duplicates += dropped[f] == 0 && twins[f] != 0 ? 1 : 0;
      dropped[f] |= twins[f];
    }
    if (count(dropped) == dropped.size())
      throw EditError(
          fmt::format("nothing of \"{}\" is seen from there: name other views or eyes, or remove it", name));
    auto made = std::make_shared<BakedObject>(*triangles_of(before, dropped, false));
    // What is hidden shades nothing that is seen any less: light stays as it was baked.
    made->bodies = before.bodies;
    made->sets = packed(*made, name, lines);
    lines.push_back(
        fmt::format("{}: {} of {} triangles removed ({} unseen, {} duplicates), texels {:.1f} → {:.1f} million, memory "
                    "{:.0f} → {:.0f} MB",
                    name, count(dropped), dropped.size(), count(seen.unseen), duplicates,
                    static_cast<double>(texel_area(before)) / 1e6, static_cast<double>(texel_area(*made)) / 1e6,
                    static_cast<double>(before.memory()) / 1e6, static_cast<double>(made->memory()) / 1e6));
    lines.push_back(fmt::format(
        "{}: {} rays; what was removed is reached by at most {:.2g} % of the lines of sight (95 % sure); the smallest "
        "opening found lets {:.2g} % through, {} triangles were seen by one ray only",
        name, seen.rays, 100 * most_missed(edit.rays), 100 * seen.smallest_opening, seen.seen_once));
    if (edit.psnr > 0) {
      const BitsFound found = fewest_bits(*made, edit.psnr, progress);
      for (TextureSet& set : made->sets) set.texels = with_bits(*set.texels, found.bits);
      lines.push_back(fmt::format("{}: {}", name, bits_words(found)));
    }
    if (!placed.node->saved_selections.empty())
      lines.push_back(fmt::format("{}: its stored selections are gone, since triangles have other numbers", name));
    result = with_changed(result, placed.node->id, [&](Node& node) {
      node.object = made;
      node.selection = nullptr;
      node.saved_selections.clear();
    });
  }
  return {std::move(result), {std::move(lines)}};
}

REBAKE_DESCRIBE_EDIT(
    Slim,
    "Removes triangles that nobody sees and duplicates, packs the texels that are left, and, where psnr is given, "
    "keeps "
    "fewer bits of the features: smaller folders, faster pictures.",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::optional,
            "only this node and those inside it; left out: all that is visible. Objects hide themselves only");
      visit("views", edit.views, Need::optional, "names of stored views: what none of their eyes sees goes");
      visit("eyes", edit.eyes, Need::optional,
            "box in the world: what no eye in it sees goes; with neither, what no eye outside the object sees");
      visit("rays", edit.rays, Need::optional,
            "sent from each triangle before it counts as unseen: 300 leave at most 1 % of its lines of sight (95 % "
            "sure)");
      visit("psnr", edit.psnr, Need::optional,
            "dB that texels' colours keep while features lose bits; 0: nothing of what is seen is lost");
    })

}  // namespace rebake
