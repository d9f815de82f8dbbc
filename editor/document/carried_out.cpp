#include "editor/document/carried_out.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/document/sources.h"

namespace rebake {

namespace {

// All that edits look at, by what scenes share.
bool same_scene(const Scene& a, const Scene& b) {
  return a.roots == b.roots && a.background == b.background && a.views == b.views && a.next_id == b.next_id &&
         a.light == b.light && a.ground == b.ground;
}

}  // namespace

bool CarriedOut::is_of(const Scene& scene, const std::vector<Edit>& wanted) const {
  return same_scene(start, scene) &&
         std::equal(edits.begin(), edits.end(), wanted.begin(), wanted.end(), [](const Edit& own, const Edit& other) {
           return &own.type() == &other.type() && to_json(own) == to_json(completed(other));
         });
}

CarriedOut carried_out(const Scene& start, const std::vector<Edit>& edits, const Progress& progress) {
  CarriedOut done{start, {}, {}, {}};
  for (const Edit& edit : edits) {
    const Scene& before = done.scenes.empty() ? start : done.scenes.back();
    done.edits.push_back(read_edit(to_json(completed(edit)), before));
    Outcome outcome = apply(before, done.edits.back(), progress);
    done.scenes.push_back(std::move(outcome.scene));
    done.reports.push_back(std::move(outcome.report));
  }
  return done;
}

}  // namespace rebake
