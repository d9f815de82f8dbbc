#pragma once

#include "editor/actions/session.h"
#include "editor/fields/fields.h"

namespace rebake {

struct RenderAction {
  static constexpr const char* op = "render";
  static constexpr const char* help = "Draws the scene into a PNG.";
  std::string out;
  std::string view;
  std::optional<Camera> camera;
  int width = 800;
  int height = 800;
  int samples = 4;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("out", self.out, Need::required, "PNG file to write");
    visit("view", self.view, Need::optional,
          "name of a stored view; left out: the camera, or one that frames the scene");
    visit("camera", self.camera, Need::optional, "the camera");
    visit("width", self.width, Need::optional, "pixels");
    visit("height", self.height, Need::optional, "pixels");
    visit("samples", self.samples, Need::optional, "a pixel: 1, 4 or 16");
  }
};

void run(Session& session, const RenderAction& action);

}  // namespace rebake
