#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct UndoAction {
  static constexpr const char* op = "undo";
  static constexpr const char* help = "Takes edits back.";
  int steps = 1;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("steps", self.steps, Need::optional, "how many");
  }
};

void run(Session& session, const UndoAction& action);

}  // namespace rebake
