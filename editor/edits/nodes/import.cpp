#include "editor/edits/nodes/import.h"

#include "editor/edits/describe_edit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/scene_files.h"

namespace rebake {

Outcome apply(const Scene& scene, const Import& edit, const Progress& progress) {
  if (edit.path.empty()) throw FieldError("path", "is empty");
  if (!edit.content.empty() && hash_text(content_hash_at(edit.path)) != edit.content)
    throw EditError(edit.path + ": has changed since it was imported; restore the original files");
  const Scene read = read_any(edit.path, {edit.axes, edit.dialect()}, progress);
  const bool empty = read.roots.empty();
  if (empty && read.views.empty() && read.camera_keys.empty() && read.light == nullptr &&
      read.background == Scene{}.background && read.ground == Ground{})
    throw EditError(edit.path + ": contains no objects");
  Node node;
  if (read.roots.size() == 1) {
    node = without_ids(*read.roots.front());
  } else if (!empty) {
    node.name = folder_title(edit.path);
    for (const NodePtr& root : read.roots) node.children.push_back(std::make_shared<const Node>(without_ids(*root)));
  }
  if (!edit.as.empty()) {
    if (find(scene, edit.as) != nullptr)
      throw FieldError("as", "\"" + edit.as + "\" is already the name of another node; choose another name");
    node.name = edit.as;
  }
  Scene result = empty ? scene : with_added(scene, std::move(node), NodeId::none, scene.roots.size());
  std::vector<std::string> dropped;
  for (const auto& [name, camera] : read.views)
    if (const auto [known, fresh] = result.views.try_emplace(name, camera); !fresh && known->second != camera)
      dropped.push_back(fmt::format("the view \"{}\"", name));
  // The first import also sets the background, the ground and the light, unless the scene has others than the default.
  const bool first = scene.roots.empty();
  std::vector<std::string> taken;
  const auto take = [&](const char* what, bool states, bool is_free) {
    const bool takes = states && first && is_free;
    if (states) (takes ? taken : dropped).emplace_back(what);
    return takes;
  };
  if (take("its background", read.background != Scene{}.background && read.background != scene.background,
           scene.background == Scene{}.background))
    result.background = read.background;
  if (take("its light settings", read.light != nullptr, scene.light == nullptr)) result.light = read.light;
  if (take("its keyframes of the camera", !read.camera_keys.empty() && read.camera_keys != scene.camera_keys,
           scene.camera_keys.empty()))
    result.camera_keys = read.camera_keys;
  if (take("its ground", read.ground != Ground{} && read.ground != scene.ground, scene.ground == Ground{}))
    set_ground(result, read.ground);
  else if (const double lowest = lowest_visible(result); edit.ground && std::isfinite(lowest))
    set_ground(result, {Vec3::UnitY(), lowest});
  Report report;
  if (empty) report.lines.push_back(fmt::format("note: {}: contains no objects", edit.path));
  if (!taken.empty()) report.lines.push_back(fmt::format("{}: also imported {}", edit.path, fmt::join(taken, ", ")));
  if (!dropped.empty())
    report.lines.push_back(
        fmt::format("note: {}: not imported, because the scene has its own: {}", edit.path, fmt::join(dropped, ", ")));
  for (const std::string& assumption : assumptions_of(read))
    report.lines.push_back(fmt::format("warning: {}: {}", edit.path, assumption));
  return {std::move(result), std::move(report)};
}

Dialect Import::dialect() const {
  if (linear && (*linear < 3 || *linear > 9 || *linear % 2 == 0)) throw FieldError("linear", "must be 3, 5, 7 or 9");
  return {half_direction.set, direction_first.set, bgr.set, alpha, no_holes.set, linear.value_or(0)};
}

bool describes_folder(const FieldInfo& field) {
  constexpr std::array<std::string_view, 7> names{"axes",  "half_direction", "direction_first", "bgr",
                                                  "alpha", "no_holes",       "linear"};
  return std::find(names.begin(), names.end(), field.name) != names.end();
}

std::string whole_title(const Import& edit) { return "Imported " + folder_title(edit.path); }

REBAKE_DESCRIBE_EDIT(
    Import, "Reads a scene or a textured mesh into the scene.", (auto& edit, auto& visit) {
      visit("path", edit.path, Need::required, read_formats_help());
      visit("as", edit.as, Need::optional, "name of the new node; empty: the folder's name");
      visit("axes", edit.axes, Need::optional, "orientation of a MobileNeRF folder; Rebake scenes contain theirs");
      visit("half_direction", edit.half_direction, Need::optional,
            "the folder's decoder takes (d + 1) / 2 instead of the view direction d");
      visit("direction_first", edit.direction_first, Need::optional,
            "the folder's decoder takes the view direction before the features");
      visit("bgr", edit.bgr, Need::optional, "the folder's images have the channels blue, green, red, alpha");
      visit("alpha", edit.alpha, Need::optional,
            "code of the alpha channels; default: halved, but plain in unsplit folders");
      visit("no_holes", edit.no_holes, Need::optional, "texels whose first feature is 0 are opaque; it becomes 1/255");
      visit("linear", edit.linear, Need::optional,
            "the folder's textures are meant for linear filtering: they become 3, 5, 7 or 9 times as fine per side, "
            "which takes the square of it in memory");
      visit("ground", edit.ground, Need::optional, "move the scene's ground to the lowest point of the scene");
      visit("content", edit.content, Need::optional,
            "expected hash of the folder's files, from projects and journals; other contents are refused");
    })

}  // namespace rebake
