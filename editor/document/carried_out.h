#pragma once

#include <vector>

#include "editor/edits/edit.h"

namespace rebake {

/// Edits as a document carries them out, one on what the other made. A document may take it in in place of doing the
/// same again.
struct CarriedOut {
  Scene start;
  std::vector<Edit> edits;    ///< as journals and projects read them
  std::vector<Scene> scenes;  ///< after each
  std::vector<Report> reports;

  /// Whether it is of this very scene and these edits.
  bool is_of(const Scene& scene, const std::vector<Edit>& wanted) const;
};

/// What is carried out is what journals and projects will read, to the last bit: nothing can be accepted now and
/// refused, or done otherwise, later. Throws as apply() does.
CarriedOut carried_out(const Scene& start, const std::vector<Edit>& edits, const Progress& progress = {});

}  // namespace rebake
