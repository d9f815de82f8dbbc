#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <set>
#include <string>

#include "editor/document/document.h"
#include "mesh_ops/base/progress.h"

namespace rebake {

class Renderer;

/// State of a running script, command or window: the document, outputs, progress, messages, and a renderer that is
/// created on first use.
class Session {
 public:
  Session();
  ~Session();

  Document document;
  std::uint64_t document_number = 0;  ///< changes when `document` is replaced by another one
  const Scene& scene() const { return document.scene(); }
  /// Applies an edit and reports its effect.
  void edit(const Edit& edit);
  /// Applies edits as one step, or none if one throws; see Document::edits().
  void edits(const std::vector<Edit>& edits, const AppliedEdits* made = nullptr);
  /// Replaces the last step; see Document::adjust().
  void adjust(const std::vector<Edit>& edits, const AppliedEdits* made = nullptr);
  /// Replaces the last step by a new one; undo returns to the replaced step. See Document::revise().
  void revise(const std::vector<Edit>& edits, const AppliedEdits* made = nullptr);

  /// Records a written scene folder and ends the protection of its earlier content.
  void wrote_scene(const std::string& folder, bool exported);
  std::vector<std::string> exports;  ///< folders written by ExportAction
  std::vector<std::string> outputs;  ///< pictures, projects and scene folders written by other actions
  std::multiset<std::filesystem::path> projects_to_come;  ///< absolute paths that later lines of the script save to
  bool below_requested_psnr = false;                      ///< an export missed its requested PSNR
  std::function<void()> after_line;                       ///< called after each line of a script, if set
  Progress progress;                                      ///< for long operations
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< outputs a message of one line

  /// Outputs a report line of an edit; by default as a message.
  std::function<void(const std::string&)> report = [this](const std::string& line) { say(line); };

  /// Throws DeviceError if OpenGL is not available.
  Renderer& renderer();
  /// Frees the renderer; call it on the thread that used it.
  void drop_renderer();

 private:
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace rebake
