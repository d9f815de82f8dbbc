#include "editor/gui/state/worker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <new>
#include <utility>

#include "editor/gui/state/titles.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

std::string sentence(std::string title) {
  if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
  return title;
}

}  // namespace

Worker::Worker(std::function<void()> wake) : wake_(std::move(wake)) {
  session_.progress = Progress(
      [this](std::string_view what, double share) {
        {
          const std::lock_guard lock(mutex_);
          status_.what = what;
          status_.share = share;
        }
        wake_();
      },
      &cancel_);
  session_.say = [this](const std::string& line) {
    const std::lock_guard lock(mutex_);
    messages_.push_back({line, Message::Kind::said});
  };
  session_.report = [this](const std::string& line) {
    const std::lock_guard lock(mutex_);
    messages_.push_back({line, Message::Kind::reported});
  };
  thread_ = std::thread([this] { loop(); });
}

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    waiting_.clear();
    cancel_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Worker::start(std::string title, Job job, std::function<void()> then, std::function<void()> otherwise, On on) {
  add({std::move(title), std::move(job), std::move(then), std::move(otherwise),
       on == On::seen_document ? std::optional<std::uint64_t>(0) : std::nullopt, false});
}

void Worker::start_change(std::string title, Job job, std::function<void()> then, std::function<void()> otherwise,
                          On on) {
  add({std::move(title), std::move(job), std::move(then), std::move(otherwise),
       on == On::seen_document ? std::optional<std::uint64_t>(0) : std::nullopt, true});
}

void Worker::add(Waiting job) {
  {
    const std::lock_guard lock(mutex_);
    if (job.document) job.document = seen_document_;
    unseen_changes_ = unseen_changes_ || job.changes;
    waiting_.push_back(std::move(job));
  }
  changed_.notify_all();
}

void Worker::saw(const Snapshot& snapshot) {
  const std::lock_guard lock(mutex_);
  seen_document_ = snapshot.document;
}

bool Worker::busy() const {
  const std::lock_guard lock(mutex_);
  return running_ || !waiting_.empty();
}

bool Worker::changes() const {
  const std::lock_guard lock(mutex_);
  return unseen_changes_;
}

void Worker::cancel() {
  {
    const std::lock_guard lock(mutex_);
    std::string dropped;
    for (Waiting& forgotten : waiting_) {
      dropped += (dropped.empty() ? "" : ", ") + forgotten.title;
      if (forgotten.otherwise) finished_.push_back(std::move(forgotten.otherwise));
    }
    if (!waiting_.empty()) messages_.push_back({"Not begun, and dropped too: " + dropped, Message::Kind::said});
    waiting_.clear();
    if (running_) cancel_ = true;
  }
  wake_();
}

void Worker::set_prepare(std::function<void(const Scene&)> prepare) {
  const std::lock_guard lock(prepare_mutex_);
  prepare_ = std::move(prepare);
}

Worker::Status Worker::status() const {
  const std::lock_guard lock(mutex_);
  return status_;
}

std::shared_ptr<const Snapshot> Worker::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

std::vector<Worker::Message> Worker::take_messages() {
  const std::lock_guard lock(mutex_);
  return std::exchange(messages_, {});
}

std::vector<std::function<void()>> Worker::take_finished() {
  const std::lock_guard lock(mutex_);
  unseen_changes_ = (running_ && running_changes_) ||
                    std::any_of(waiting_.begin(), waiting_.end(), [](const Waiting& job) { return job.changes; });
  return std::exchange(finished_, {});
}

void Worker::name_steps(Snapshot& next) {
  struct StepEdits {
    std::size_t first;  // number of its first edit
    std::vector<Edit> edits;
    std::optional<Edit> replaced;
  };
  const History& history = session_.document.history();
  const std::vector<History::Entry> entries = history.entries();
  std::vector<StepEdits> groups;
  for (std::size_t k = 0; k < entries.size(); ++k) {
    // If a script has undone a part of a step, the rest counts as a separate step.
    if (k == 0 || k == history.undo_count() || !entries[k].joined) {
      groups.push_back({k, {}, {}});
      if (entries[k].replaced > 0) groups.back().replaced = entries[k - 1].edit;
    }
    groups.back().edits.push_back(entries[k].edit);
    if (k < history.undo_count()) next.steps_done = groups.size();
  }
  next.revised_steps = next.steps_done > 0 ? 1 : 0;
  for (std::size_t k = next.steps_done; k > 0 && groups[k - 1].replaced; --k) ++next.revised_steps;
  std::map<const void*, Titled> titles;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const StepEdits& group = groups[k];
    const void* key = group.edits.front().value();
    const auto known = titles_.find(key);
    std::string title;
    if (known != titles_.end() && known->second.edits == group.edits.size())
      title = known->second.title;
    else if (const auto scenes = history.scenes_around(group.first, group.edits.size()))
      title = title_of(group.edits, scenes->first, scenes->second, group.replaced ? &*group.replaced : nullptr);
    else
      title = title_of(group.edits, next.scene);
    titles.insert_or_assign(key, Titled{group.edits.front(), group.edits.size(), title});
    next.steps.push_back({title, group.edits.size(), group.edits.front(), group.edits.back()});
  }
  titles_ = std::move(titles);
}

void Worker::publish() {
  auto next = std::make_shared<Snapshot>();
  const History& history = session_.document.history();
  next->document = session_.document_number;
  next->scene = history.now();
  next->done = history.edits();
  next->undone = history.undone();
  next->sources = session_.document.sources();
  next->history_bytes = history.memory();
  next->journal = session_.document.journal_path();
  name_steps(*next);
  {
    const std::lock_guard lock(prepare_mutex_);
    // Optional: drawing computes anything missing, and reports the error.
    try {
      if (prepare_) prepare_(next->scene);
    } catch (const std::exception&) {
    }
  }
  next->before_last = history.before_last_step();
  const std::lock_guard lock(mutex_);
  snapshot_ = std::move(next);
}

void Worker::loop() {
  for (;;) {
    Waiting next;
    {
      std::unique_lock lock(mutex_);
      running_ = false;
      status_ = {};
      changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
      if (ending_) break;
      next = std::move(waiting_.front());
      waiting_.pop_front();
      running_ = true;
      running_changes_ = next.changes;
      cancel_ = false;
      status_.title = next.title;
    }
    std::string failed;
    bool stopped = false;
    const std::size_t before = session_.document.history().undo_count();
    if (drops_renderer_.exchange(false)) session_.drop_renderer();
    try {
      if (next.document.value_or(session_.document_number) != session_.document_number)
        throw Error("another document was opened in the meantime; nothing was changed, try again");
      next.job(session_);
    } catch (const Cancelled&) {
      failed = sentence(next.title) + " was cancelled";
      stopped = true;
    } catch (const std::filesystem::filesystem_error& error) {
      failed = sentence(next.title) + " failed: " + error.path1().string() + ": " + error.code().message();
    } catch (const std::bad_alloc&) {
      failed = sentence(next.title) + " failed: out of memory";
    } catch (const std::exception& error) {
      failed = sentence(next.title) + " failed: " + error.what();
    }
    if (!failed.empty() && session_.document.history().undo_count() != before)
      failed += " (earlier edits of this job are kept and can be undone)";
    publish();
    {
      const std::lock_guard lock(mutex_);
      if (!failed.empty()) messages_.push_back({failed, stopped ? Message::Kind::said : Message::Kind::failed});
      if (std::function<void()>& after = failed.empty() ? next.then : next.otherwise)
        finished_.push_back(std::move(after));
      if (waiting_.empty()) {
        running_ = false;
        status_ = {};
      }
    }
    wake_();
    // While idle: builds the ray trees that picking needs.
    try {
      for (const PlacedNode& placed : placed_nodes(session_.scene())) {
        if (busy()) break;
        if (placed.node->object) rays_of(*placed.node->object);
      }
    } catch (const std::exception&) {
      // Picking reports the error when it needs the tree.
    }
  }
  // On this thread, because the renderer's context is current here.
  session_.drop_renderer();
}

}  // namespace rebake
