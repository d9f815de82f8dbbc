#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct SaveAction {
  static constexpr const char* op = "save";
  static constexpr const char* help = "Writes a Rebake scene folder that keeps every node.";
  std::string out;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("out", self.out, Need::required, "folder to write");
  }
};

void run(Session& session, const SaveAction& action);

}  // namespace rebake
