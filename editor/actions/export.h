#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct ExportAction {
  static constexpr const char* op = "export";
  static constexpr const char* help =
      "Writes the scene in the MobileNeRF format, or as scene.json where one folder cannot hold it.";
  std::string out;
  std::optional<Layout> layout;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("out", self.out, Need::required, "folder to write");
    visit("layout", self.layout, Need::optional, "convert to this layout; left out: as read");
  }
};

void run(Session& session, const ExportAction& action);

}  // namespace rebake
