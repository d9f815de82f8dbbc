#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

#include "editor/gui/state/editor_context.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {

/// The state of the window without its display, with a folder of its own for journals.
class WindowState : public ::testing::Test {
 protected:
  WindowState() {
    ::setenv("XDG_STATE_HOME", home.path().c_str(), 1);
    editor = std::make_unique<EditorContext>(Settings{}, [] {});
  }
  ~WindowState() override {
    editor->jobs.worker.start("end", [](Session& session) { session.document.discard_journal(); });
    wait();
  }
  /// Until no job and no preview runs.
  void wait() {
    do {
      while (editor->jobs.worker.busy() || editor->previews.busy())
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      editor->update();
    } while (editor->jobs.worker.busy());
  }
  TemporaryFolder home;
  std::unique_ptr<EditorContext> editor;
};

}  // namespace rebake::test
