#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// Linear undo history: edits, and a cache of the scenes after them. Scenes share unchanged data. If the memory budget
/// is exceeded, the scenes farthest from the present are evicted first, every 32nd scene last. Evicted scenes are
/// recomputed from the edits on demand.
class History {
 public:
  static constexpr std::uint64_t default_budget = 2ULL << 30;
  /// `budget` in bytes; the first and the present scene are always cached.
  explicit History(Scene start = {}, std::uint64_t budget = default_budget);

  /// The present scene.
  const Scene& now() const { return *steps_[position_].scene; }
  /// Edits that lead from the start to now(), without those that a later edit replaced.
  std::vector<Edit> edits() const;
  /// Of each of edits(): the number of edits before it, including replaced ones, for scene_at().
  std::vector<std::size_t> edits_before() const;
  /// One edit of the history.
  struct Entry {
    Edit edit;
    bool joined;           ///< belongs to the same step as the edit before
    std::size_t replaced;  ///< number of edits directly before it that it replaces; 0 for most
  };
  /// All edits in the order in which they were made: first undo_count() edits up to now(), then the undone ones.
  std::vector<Entry> entries() const;
  /// Edits that were undone, in the order in which redo() does them.
  std::vector<Edit> undone() const;
  /// Number of edits that can be undone.
  std::size_t undo_count() const { return position_; }
  /// Number of edits that can be redone.
  std::size_t redo_count() const { return steps_.size() - 1 - position_; }
  /// Number of edits of the last step, and of the next step to redo; 0 if there is none.
  std::size_t undo_step() const;
  std::size_t redo_step() const;
  /// The scene that the last step was applied to, if it is cached.
  std::optional<Scene> before_last_step() const;
  /// The scenes before and after `count` edits from number `first`, from 0, if both are cached.
  std::optional<std::pair<Scene, Scene>> scenes_around(std::size_t first, std::size_t count) const;
  /// Number of edits before the last step that the step replaces.
  std::size_t replaced_by_last_step() const;
  /// The scene after the first `edits` edits (at most undo_count()); recomputed if not cached. Throws as undo() does.
  Scene scene_at(std::size_t edits, const Progress& progress = {}) const;

  /// Adds an edit and its result, computed from scene_at(undo_count() - replaced); forgets undone edits. `joined`: the
  /// edit belongs to the same step as the one before. `replaced`: number of edits that it replaces; undo returns to
  /// them.
  void add(Edit edit, Scene scene, bool joined = false, std::size_t replaced = 0);
  /// Forgets the last `edits` edits and all undone ones. now() is valid again only after the next add().
  void forget_last(std::size_t edits);
  /// Undoes or redoes this many edits; false if there are fewer. Recomputes the scene if it is not cached: throws Error
  /// if that fails (a source changed), and then changes nothing.
  bool undo(std::size_t edits = 1, const Progress& progress = {});
  bool redo(std::size_t edits = 1, const Progress& progress = {});

  /// Bytes of all cached scenes; shared data counts once.
  std::uint64_t memory() const { return memory_; }
  /// Number of cached scenes, of undo_count() + redo_count() + 1.
  std::size_t kept() const;

 private:
  struct Step {
    std::optional<Edit> edit;    ///< edit that led to this step; none at the start
    std::optional<Scene> scene;  ///< scene after the edit, if cached
    bool joined = false;         ///< belongs to the same step as the edit before
    std::size_t base = 0;        ///< index of the step whose scene the edit was applied to
  };
  std::vector<std::size_t> uncached_chain(std::size_t step) const;
  void keep(std::size_t step, Scene scene);
  void drop(std::size_t step);
  void evict_to_budget();
  void go_to(std::size_t step, const Progress& progress);

  std::vector<Step> steps_;   ///< the start, then one entry per edit
  std::size_t position_ = 0;  ///< index of the present scene in steps_
  std::uint64_t budget_;      ///< bytes
  std::uint64_t memory_ = 0;  ///< bytes of all cached scenes
  /// A shared allocation.
  struct Part {
    std::uint32_t uses;  ///< number of cached scenes that contain it
    std::uint64_t bytes;
  };
  std::unordered_map<const void*, Part> parts_;  ///< allocations of all cached scenes, by address
};

}  // namespace rebake
