#pragma once

#include <functional>
#include <memory>
#include <string>

#include "editor/document/document.h"
#include "mesh_ops/progress.h"

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
  /// All of them, to be undone together, or none where one throws.
  void edits(const std::vector<Edit>& edits);

  /// Throws FieldError when a folder that is to be written is a source of the document: it would not be what was
  /// imported any more, and undo and projects want it again.
  void check_not_a_source(const char* field, const std::string& folder) const;

  std::vector<std::string> exports;  ///< folders that export wrote
  Progress progress;
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< one line for people

  /// Throws DeviceError where there is no OpenGL.
  Renderer& renderer();
  /// Frees it, on the thread that used it.
  void drop_renderer();

 private:
  std::unique_ptr<Renderer> renderer_;
};

/// The camera that frames everything visible; forward-facing when all objects are.
Camera framing_of(const Scene& scene, double aspect, double fov_degrees = Camera{}.fov_degrees);

}  // namespace rebake
