#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "editor/commands/session.h"

namespace rebake {

/// What the window knows of the document: a copy as it was after the last job.
struct Snapshot {
  Scene scene;
  std::vector<Edit> done, undone;  ///< oldest first; the first of `undone` is what redo does
  /// What was made together, in a sentence that never changes again; those that are done, then the undone.
  struct Step {
    std::string title;
    std::size_t edits = 0;
  };
  std::vector<Step> steps;
  std::size_t steps_done = 0;
  int revised_steps = 0;  ///< steps back to the scene that the last step was applied to: 1, more after revisions
  std::optional<Scene> before_last;  ///< the scene before the last step; nothing where it is not kept
  SourceGuard sources;               ///< where nothing may be written
  std::uint64_t history_bytes = 0;   ///< that the kept scenes hold
  std::filesystem::path journal;     ///< that keeps the work safe; empty for none
};

/// Carries jobs out on the document, one after the other, off the window's thread.
class Worker {
 public:
  using Job = std::function<void(Session&)>;
  /// `wake` is called, from another thread, when there is something new to take, or progress to show.
  explicit Worker(std::function<void()> wake);
  /// Asks what runs to stop, and waits for it.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// `then` is carried out by take_finished()'s caller once the job is done; `otherwise`, when it failed or was
  /// cancelled, also while it still waited.
  void start(std::string title, Job job, std::function<void()> then = {}, std::function<void()> otherwise = {});
  bool busy() const;
  /// Asks the present job to stop and forgets those that wait.
  void cancel();
  /// Called with every scene before the window sees it, on the worker's thread; null for none.
  void set_prepare(std::function<void(const Scene&)> prepare);
  /// Before the next job: what its renderer holds may be lost.
  void drop_renderer() { drops_renderer_ = true; }

  struct Status {
    std::string title, what;  ///< the job, and what it is at
    double share = 0;         ///< done of that, 0 … 1
  };
  Status status() const;
  std::shared_ptr<const Snapshot> snapshot() const;
  /// What jobs had to say since the last call, in order.
  struct Message {
    std::string text;
    enum class Kind { said, reported, failed } kind = Kind::said;
  };
  std::vector<Message> take_messages();
  std::vector<std::function<void()>> take_finished();

 private:
  void loop();
  /// `before`: the scene as it was before the job.
  void publish(const Scene& before);
  void name_steps(Snapshot& next, const Scene& before);

  std::function<void()> wake_;
  std::mutex prepare_mutex_;
  std::function<void(const Scene&)> prepare_;
  Session session_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  struct Waiting {
    std::string title;
    Job job;
    std::function<void()> then, otherwise;
  };
  std::deque<Waiting> waiting_;
  bool running_ = false, ending_ = false;
  std::atomic<bool> cancel_ = false, drops_renderer_ = false;
  Status status_;
  std::shared_ptr<const Snapshot> snapshot_ = std::make_shared<const Snapshot>();
  std::vector<Message> messages_;
  std::map<const void*, std::string> titles_;  ///< of steps, by the value of their first edit
  std::vector<std::function<void()>> finished_;
  std::thread thread_;  // last: it uses the others
};

}  // namespace rebake
