#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "editor/actions/session.h"

namespace rebake {

/// Immutable copy of the document's state after a job, for the window's thread.
struct Snapshot {
  std::uint64_t document = 0;  ///< Session::document_number
  Scene scene;
  std::vector<Edit> done, undone;  ///< oldest first; redo begins with the first of `undone`
  /// A step of history: edits that are undone together. Its title never changes.
  struct Step {
    std::string title;
    std::size_t edits = 0;  ///< number of edits
    Edit first, last;       ///< of them
  };
  std::vector<Step> steps;     ///< done steps, oldest first, then undone steps
  std::size_t steps_done = 0;  ///< number of done steps
  int revised_steps = 0;       ///< steps from the current scene back to the last step's input: 1, more after revisions
  std::optional<Scene> before_last;  ///< the scene that the last step was applied to, if cached
  SourceGuard sources;               ///< files and folders that must not be overwritten
  std::uint64_t history_bytes = 0;   ///< memory of the cached scenes of history
  std::filesystem::path journal;     ///< the journal; empty for none
};

/// Owns the document and runs jobs on it, one after another, on a background thread.
class Worker {
 public:
  using Job = std::function<void(Session&)>;
  /// `wake` is called on progress and after each job, from the background thread, and by cancel().
  explicit Worker(std::function<void()> wake);
  /// Cancels the running job and waits for it.
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// seen: only the document that the user saw when the job was started (see saw()); the job fails if another one was
  /// opened in the meantime.
  enum class On { seen_document, any_document };
  /// Queues a job. take_finished() returns `then` after its success, `otherwise` if it failed or was cancelled (also
  /// before it began). `title` is shown during the job and in errors.
  void start(std::string title, Job job, std::function<void()> then = {}, std::function<void()> otherwise = {},
             On on = On::seen_document);
  /// As start(), for jobs that change the document, or whose callbacks change picks.
  void start_change(std::string title, Job job, std::function<void()> then = {}, std::function<void()> otherwise = {},
                    On on = On::seen_document);
  /// The window shows this snapshot from now on.
  void saw(const Snapshot& snapshot);
  /// Whether a job is running or waiting.
  bool busy() const;
  /// Whether a job of start_change() was running or waiting at the last take_finished(), or has begun since.
  bool changes() const;
  /// Cancels the running job and removes the waiting ones.
  void cancel();
  /// `prepare` is called on the background thread with each scene before snapshot() returns it; null for none.
  void set_prepare(std::function<void(const Scene&)> prepare);
  /// Frees the session's renderer before the next job, because its GPU objects may be lost.
  void drop_renderer() { drops_renderer_ = true; }

  /// Progress of the running job.
  struct Status {
    std::string title, what;  ///< title of the job, and its current task
    double share = 0;         ///< completed share of the task, 0 … 1
  };
  Status status() const;
  std::shared_ptr<const Snapshot> snapshot() const;
  /// A message of a job: for the user, a report of edits (for the log only), or an error.
  struct Message {
    std::string text;
    enum class Kind { said, reported, failed } kind = Kind::said;
  };
  /// Messages since the last call, in order.
  std::vector<Message> take_messages();
  /// Callbacks of jobs that ended since the last call, to be called by the window's thread.
  std::vector<std::function<void()>> take_finished();

 private:
  void loop();
  /// Creates a new snapshot. `before`: the scene before the job.
  void publish();
  /// Fills the steps of `next`. Known steps keep their titles.
  void name_steps(Snapshot& next);

  std::function<void()> wake_;
  std::mutex prepare_mutex_;
  std::function<void(const Scene&)> prepare_;
  Session session_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  /// A queued job, see start().
  struct Waiting {
    std::string title;
    Job job;
    std::function<void()> then, otherwise;
    std::optional<std::uint64_t> document;  ///< number of the only document on which it may run; nothing: any
    bool changes = false;
  };
  void add(Waiting job);
  std::uint64_t seen_document_ = 0;
  std::deque<Waiting> waiting_;
  bool running_ = false, running_changes_ = false, unseen_changes_ = false, ending_ = false;
  std::atomic<bool> cancel_ = false, drops_renderer_ = false;
  Status status_;
  std::shared_ptr<const Snapshot> snapshot_ = std::make_shared<const Snapshot>();
  std::vector<Message> messages_;
  struct Titled {
    Edit first;  ///< kept, so that its address stays its own
    std::size_t edits;
    std::string title;
  };
  std::map<const void*, Titled> titles_;  ///< of steps, by address of their first edit's value
  std::vector<std::function<void()>> finished_;
  std::thread thread_;  // declared last because it uses the other members
};

}  // namespace rebake
