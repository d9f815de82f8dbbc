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
  /// Edits that led to now().
  std::vector<Edit> edits() const;
  /// Edits that were undone, in the order in which redo() does them.
  std::vector<Edit> undone() const;
  std::size_t undo_count() const { return position_; }
  std::size_t redo_count() const { return steps_.size() - 1 - position_; }
  /// For each of edits() and then of undone(), whether it was made together with the one before.
  std::vector<bool> joined() const;
  /// How many edits were made together with the last one, and with the next one to redo; 0 where there is none.
  std::size_t undo_step() const;
  std::size_t redo_step() const;
  /// The scene before what was made last, where it is kept.
  std::optional<Scene> before_last_step() const;

  /// Adds the scene after an edit; what was undone is forgotten. With `joined` it was made together with the last one.
  void add(Edit edit, Scene scene, bool joined = false);
  /// So many edits back or forth; false where there are fewer. A dropped value is computed again: throws Error when
  /// that fails (a source changed), and nothing changes then.
  bool undo(std::size_t edits = 1, const Progress& progress = {});
  bool redo(std::size_t edits = 1, const Progress& progress = {});

  /// So many edits forth, to the scene that was there: nothing is computed. There are as many.
  void return_to(std::size_t edits, Scene scene);

  /// Bytes that the kept scenes hold, what is shared counted once.
  std::uint64_t memory() const { return memory_; }
  /// Scenes kept as values, of undo_count() + redo_count() + 1.
  std::size_t kept() const;

 private:
  struct Step {
    std::optional<Edit> edit;  ///< that led here; none at the start
    std::optional<Scene> scene;
    bool joined = false;
  };
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
