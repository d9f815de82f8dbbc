#pragma once

#include <functional>
#include <memory>
#include <string>

#include "editor/document/document.h"
#include "mesh_ops/base/progress.h"

namespace rebake {

class Renderer;

/// What a script or command works on: the scene now, and a renderer that is made when it is first needed.
class Session {
 public:
  Session();
  ~Session();

  Document document;
  const Scene& scene() const { return document.scene(); }
  /// Carries an edit out and says in numbers what became of selections and triangles.
  void edit(const Edit& edit);
  /// All of them, to be undone together, or none where one throws. `made` as Document::edits() takes it.
  void edits(const std::vector<Edit>& edits, const CarriedOut* made = nullptr);
  /// In place of the last step.
  void adjust(const std::vector<Edit>& edits, const CarriedOut* made = nullptr);
  /// In place of the last step, as a step of its own: undo returns to the last one.
  void revise(const std::vector<Edit>& edits, const CarriedOut* made = nullptr);

  /// To be called when a scene folder was written.
  void wrote_scene(const std::string& folder, bool exported);
  std::vector<std::string> exports;  ///< folders that export wrote
  std::vector<std::string> outputs;  ///< pictures, projects and scene folders that other actions wrote
  bool below_asked = false;          ///< an export was done, but missed the quality that was asked for
  Progress progress;
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< one line for people

  /// What edits did, a line each; said too, unless somebody wants it apart.
  std::function<void(const std::string&)> report = [this](const std::string& line) { say(line); };

  /// Throws DeviceError where there is no OpenGL.
  Renderer& renderer();
  /// Frees it, on the thread that used it.
  void drop_renderer();

 private:
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace rebake
