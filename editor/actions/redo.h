#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct RedoAction {
  static constexpr const char* op = "redo";
  static constexpr const char* help = "Does edits again that were taken back.";
  int steps = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("steps", self.steps, Need::optional, "how many");
  }
};

void run(Session& session, const RedoAction& action);

}  // namespace rebake
