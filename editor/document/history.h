#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// All scenes since the start, each as a value that shares with its neighbours what did not change. What they hold
/// together is kept within a budget: those farthest from the present are dropped first (one in 32 stays longer), and
/// computed again from the edits when they are wanted.
class History {
 public:
  static constexpr std::uint64_t default_budget = 2ULL << 30;
  /// `budget` in bytes; the present scene and the start are kept whatever they take.
  explicit History(Scene start = {}, std::uint64_t budget = default_budget);

  const Scene& now() const { return *steps_[position_].scene; }
  /// Edits that lead from the start to now(), without those that a later edit replaced.
  std::vector<Edit> edits() const;
  /// One edit of the history.
  struct Entry {
    Edit edit;
    bool joined;           ///< made together with the edit before, and undone with it
    std::size_t replaced;  ///< number of edits directly before it that it replaces; 0 for most
  };
  /// All edits in the order in which they were made: first undo_count() edits up to now(), then the undone ones.
  std::vector<Entry> entries() const;
  /// Edits that were undone, in the order in which redo() does them.
  std::vector<Edit> undone() const;
  std::size_t undo_count() const { return position_; }
  std::size_t redo_count() const { return steps_.size() - 1 - position_; }
  /// How many edits were made together with the last one, and with the next one to redo; 0 where there is none.
  std::size_t undo_step() const;
  std::size_t redo_step() const;
  /// The scene that the last step was applied to, if it is cached.
  std::optional<Scene> before_last_step() const;
  /// Number of edits before the last step that the step replaces.
  std::size_t replaced_by_last_step() const;
  /// The scene after the first `edits` edits (at most undo_count()); computed again if it is not cached. Throws as
  /// undo() does.
  Scene scene_at(std::size_t edits, const Progress& progress = {}) const;

  /// Adds an edit and the scene that it made of scene_at(undo_count() - replaced); forgets undone edits. `joined`: it
  /// belongs to the same step as the edit before. `replaced`: number of edits that it replaces. Undo returns to them.
  void add(Edit edit, Scene scene, bool joined = false, std::size_t replaced = 0);
  /// Forgets the last edits and all undone ones; at least one edit must be added before now() is asked for.
  void forget_last(std::size_t edits);
  /// So many edits back or forth; false where there are fewer. A dropped value is computed again: throws Error when
  /// that fails (a source changed), and nothing changes then.
  bool undo(std::size_t edits = 1, const Progress& progress = {});
  bool redo(std::size_t edits = 1, const Progress& progress = {});

  /// Bytes that the kept scenes hold, what is shared counted once.
  std::uint64_t memory() const { return memory_; }
  /// Scenes kept as values, of undo_count() + redo_count() + 1.
  std::size_t kept() const;

 private:
  struct Step {
    std::optional<Edit> edit;  ///< that led here; none at the start
    std::optional<Scene> scene;
    bool joined = false;
    std::size_t base = 0;  ///< index of the step whose scene the edit was applied to
  };
  std::vector<std::size_t> uncached_chain(std::size_t step) const;
  void keep(std::size_t step, Scene scene);
  void drop(std::size_t step);
  void fit_budget();
  void go_to(std::size_t step, const Progress& progress);

  std::vector<Step> steps_;
  std::size_t position_ = 0;
  std::uint64_t budget_;
  std::uint64_t memory_ = 0;
  struct Part {
    std::uint32_t uses;
    std::uint64_t bytes;
  };
  std::unordered_map<const void*, Part> parts_;
};

}  // namespace rebake
