#include "editor/actions/session.h"

#include "render/picture.h"

namespace rebake {

Session::Session() = default;
Session::~Session() = default;

void Session::edit(const Edit& edit) { edits({edit}); }

void Session::edits(const std::vector<Edit>& edits, const AppliedEdits* made) {
  for (const Report& done : document.edits(edits, progress, made))
    for (const std::string& line : done.lines) report(line);
}

void Session::adjust(const std::vector<Edit>& edits, const AppliedEdits* made) {
  for (const Report& done : document.adjust(edits, progress, made))
    for (const std::string& line : done.lines) report(line);
}

void Session::revise(const std::vector<Edit>& edits, const AppliedEdits* made) {
  for (const Report& done : document.revise(edits, progress, made))
    for (const std::string& line : done.lines) report(line);
}

void Session::wrote_scene(const std::string& folder, bool exported) {
  (exported ? exports : outputs).push_back(folder);
  document.release_contents(folder);
}

Renderer& Session::renderer() {
  if (!renderer_) renderer_ = std::make_unique<Renderer>();
  return *renderer_;
}

void Session::drop_renderer() { renderer_.reset(); }

}  // namespace rebake
