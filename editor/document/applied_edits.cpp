#include "editor/document/applied_edits.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/document/sources.h"
#include "editor/edits/nodes/import.h"

namespace rebake {

namespace {

// Records in an import the name that its node got, because a relinked folder may have another name on replay.
Edit with_name(const Edit& edit, const Scene& before, const Scene& after) {
  const auto* import = edit.as<Import>();
  // A scene without objects adds no node.
  if (import == nullptr || !import->as.empty() || after.roots.size() == before.roots.size()) return edit;
  Import named = *import;
  named.as = after.roots.back()->name;
  return named;
}

// Compares edits by their JSON; an import without a name matches any name.
bool is_same(const Edit& own, const Edit& wanted) {
  if (&own.type() != &wanted.type()) return false;
  nlohmann::json a = to_json(own), b = to_json(completed(wanted));
  if (const auto* import = wanted.as<Import>(); import != nullptr && import->as.empty()) {
    a.erase("as");
    b.erase("as");
  }
  return a == b;
}

// Compares all input of edits; nodes and light by pointer, since unchanged data is shared.
bool same_scene(const Scene& a, const Scene& b) {
  return a.roots == b.roots && a.background == b.background && a.views == b.views && a.next_id == b.next_id &&
         a.light == b.light && a.ground == b.ground && a.camera_keys == b.camera_keys;
}

}  // namespace

bool AppliedEdits::matches_input(const Scene& scene, const std::vector<Edit>& wanted) const {
  return same_scene(start, scene) && std::equal(edits.begin(), edits.end(), wanted.begin(), wanted.end(), is_same);
}

AppliedEdits apply_edits(const Scene& start, const std::vector<Edit>& edits, const Progress& progress) {
  AppliedEdits done{start, {}, {}, {}};
  for (const Edit& edit : edits) {
    const Scene& before = done.scenes.empty() ? start : done.scenes.back();
    done.edits.push_back(read_edit(to_json(completed(edit)), before));
    Outcome outcome = apply(before, done.edits.back(), progress);
    done.edits.back() = with_name(done.edits.back(), before, outcome.scene);
    done.scenes.push_back(std::move(outcome.scene));
    done.reports.push_back(std::move(outcome.report));
  }
  return done;
}

}  // namespace rebake
