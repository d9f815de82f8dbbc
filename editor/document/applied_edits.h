#pragma once

#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// Precomputed result of consecutive edits, for example from a background job. Document::edits(), adjust() and revise()
/// accept it instead of applying the same edits again.
struct AppliedEdits {
  Scene start;                  ///< scene before the first edit
  std::vector<Edit> edits;      ///< completed and read back from JSON
  std::vector<Scene> scenes;    ///< scene after each edit
  std::vector<Report> reports;  ///< one per edit

  /// Whether it was computed for these edits from this scene, compared by shared data, not by value.
  bool matches_input(const Scene& scene, const std::vector<Edit>& wanted) const;
};

/// Applies edits one after another. Each edit is first completed() and read back from its JSON, so that replaying a
/// journal or project gives the same bits and refuses nothing that was accepted. Throws as apply() does.
AppliedEdits apply_edits(const Scene& start, const std::vector<Edit>& edits, const Progress& progress = {});

}  // namespace rebake
