#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct SaveProjectAction {
  static constexpr const char* op = "save_project";
  static constexpr const char* help =
      "Writes a project: what was imported, by relative path and content, and the edits; open it like a folder.";
  std::string out;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("out", self.out, Need::required, "file to write, NAME.rebake");
  }
};

void run(Session& session, const SaveProjectAction& action);

}  // namespace rebake
