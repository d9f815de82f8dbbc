#include "editor/gui/app/scene_thumbnails.h"

#include "editor/edits/nodes/import.h"
#include "editor/edits/support.h"
#include "editor/gui/state/lost_work.h"
#include "render/image.h"
#include "render/thumbnail.h"

namespace rebake {

void SceneThumbnails::write_for_recovery(const EditorContext& editor, Renderer& renderer) {
  constexpr std::chrono::seconds min_time{2};
  if (editor.now->journal.empty() || editor.scene().roots.empty()) return;
  const bool other = journal_ != editor.now->journal;
  if (!other && (journal_step_ == editor.now->steps_done || Clock::now() - journal_time_ < min_time)) return;
  journal_ = editor.now->journal;
  journal_step_ = editor.now->steps_done;
  journal_time_ = Clock::now();
  try {
    const std::filesystem::path file = thumbnail_path(editor.now->journal);
    std::filesystem::create_directories(file.parent_path());
    write_picture(thumbnail_of(renderer.shown_image(), Thumbnails::width, Thumbnails::height), file, {});
  } catch (const std::exception&) {
    // The dialog then shows an icon instead.
  }
}

void SceneThumbnails::write_for_recent_files(const EditorContext& editor, Renderer& renderer) {
  const std::vector<Edit>& done = editor.now->done;
  const bool imported = done.size() == 1 && done.front().is<Import>() && !editor.settings.recent.empty();
  const std::string file = !editor.project.path.empty() ? (editor.project.unsaved() ? "" : editor.project.path.string())
                           : imported                   ? editor.settings.recent.front()
                                                        : "";
  if (file.empty() || (file == recent_file_ && recent_step_ == editor.now->steps_done)) return;
  recent_file_ = file;
  recent_step_ = editor.now->steps_done;
  try {
    thumbnails_.keep(file, editor.settings.recent, renderer.shown_image());
  } catch (const std::exception&) {
    // Without a writable cache the list has no thumbnails; nothing else depends on them.
  }
}

}  // namespace rebake
