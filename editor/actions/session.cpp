#include "editor/actions/session.h"

#include <fmt/format.h>

#include <filesystem>

#include "mesh_ops/deform/deform_object.h"
#include "render/picture.h"

namespace rebake {

Session::Session() = default;
Session::~Session() = default;

namespace {

struct Numbers {
  std::size_t triangles = 0, selected = 0;
  std::uint64_t opaque_texels = 0;
};

Numbers numbers_of(const Scene& scene, bool texels) {
  Numbers numbers;
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object) continue;
    numbers.triangles += placed.node->object->triangle_count();
    if (texels) numbers.opaque_texels += placed.node->object->opaque_texel_count();
    if (placed.node->selection) numbers.selected += count(*placed.node->selection);
  }
  return numbers;
}

// Collects the hidden nodes that an edit's fields name: what it does to them will not be seen.
struct HiddenNodes {
  const Scene& scene;
  std::vector<std::string> names;
  void operator()(const char*, const NodeRef& node, Need, const char*) {
    if (const auto placed = find_placed(scene, node.id); placed && !placed->visible)
      names.push_back(placed->node->name);
  }
  void operator()(const char* name, const std::optional<NodeRef>& node, Need need, const char* help) {
    if (node) (*this)(name, *node, need, help);
  }
  void operator()(const char* name, const std::vector<NodeRef>& nodes, Need need, const char* help) {
    for (const NodeRef& node : nodes) (*this)(name, node, need, help);
  }
  template <class T>
  void operator()(const char*, const T&, Need, const char*) {}
};

std::string in_words(const std::string& name, const DeformationReport& report) {
  std::string line =
      fmt::format("{} points of \"{}\" deformed, least det J {:.3g}", report.points, name, report.least_determinant);
  if (report.folded > 0)
    line += fmt::format("; {} lie where it folds or collapses (det J ≤ 0): select_folded selects their triangles",
                        report.folded);
  if (report.undefined > 0)
    line += fmt::format("; {} have no rotation of their own and got a neighbour's", report.undefined);
  if (report.outside > 0) line += fmt::format("; {} that show nothing lie outside the cage and stay", report.outside);
  if (report.not_finite > 0)
    line += fmt::format("; {} are no numbers, or would become none, and stay", report.not_finite);
  for (const std::string& note : report.notes) line += "; " + note;
  return line;
}

// In numbers, what an edit did to selections and triangles.
void say_what_became(const Edit& edit, const Scene& earlier, const Scene& scene,
                     const std::function<void(const std::string&)>& say) {
  const bool erases = std::holds_alternative<Erase>(edit);
  const bool selects = std::visit([](const auto& e) { return changes_selection<std::decay_t<decltype(e)>>(); }, edit);
  const Numbers before = numbers_of(earlier, erases), after = numbers_of(scene, erases);
  const char* op = std::visit([](const auto& e) { return e.op; }, edit);
  HiddenNodes hidden{scene, {}};
  std::visit([&](const auto& e) { e.fields(e, hidden); }, edit);
  if (!std::holds_alternative<Hide>(edit))
    for (const std::string& name : hidden.names) say(fmt::format("note: \"{}\" is hidden", name));
  if (selects) say(fmt::format("{}: {} of {} triangles selected", op, after.selected, after.triangles));
  if (erases)
    say(fmt::format("{}: {} texels cleared, {} opaque ones left", op, before.opaque_texels - after.opaque_texels,
                    after.opaque_texels));
  for (const PlacedNode& placed : placed_nodes(scene)) {
    if (!placed.node->object || !placed.node->object->deformation) continue;
    const NodePtr old = find(earlier, placed.node->id);
    if (!old || !old->object || old->object->deformation == placed.node->object->deformation) continue;
    say(fmt::format("{}: {}", op, in_words(placed.node->name, *placed.node->object->deformation)));
  }
  if (std::holds_alternative<DeleteSelected>(edit))
    say(fmt::format("{}: {} triangles removed, {} left", op, before.triangles - after.triangles, after.triangles));
}

}  // namespace

void Session::edit(const Edit& edit) { edits({edit}); }

void Session::edits(const std::vector<Edit>& edits) {
  Scene before = scene();
  const std::vector<Scene> after = document.edits(edits, progress);
  for (std::size_t k = 0; k < edits.size(); ++k) {
    say_what_became(edits[k], before, after[k], say);
    before = after[k];
  }
}

void Session::check_not_a_source(const char* field, const std::string& folder) const {
  std::error_code error;
  for (const Edit& edit : document.history().edits())
    if (const auto* import = std::get_if<Import>(&edit);
        import != nullptr && std::filesystem::equivalent(import->path, folder, error))
      throw FieldError(field, "\"" + folder +
                                  "\" is what was imported: write to another folder, else it could not be undone, nor "
                                  "a project of it opened");
}

Renderer& Session::renderer() {
  if (!renderer_) renderer_ = std::make_unique<Renderer>();
  return *renderer_;
}

void Session::drop_renderer() { renderer_.reset(); }

Camera framing_of(const Scene& scene, double aspect, double fov_degrees) {
  bool forward = true;
  for (const PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object) forward = forward && placed.node->object->axes == Axes::forward;
  return framing(world_bounds(scene), aspect, forward, fov_degrees);
}

}  // namespace rebake
