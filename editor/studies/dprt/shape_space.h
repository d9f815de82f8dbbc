#pragma once

#include "editor/studies/study.h"

namespace rebake {

/// Compares networks and linear models over the linear space of shapes between a head with expressions and a plane (the
/// paper's Figure 6), and along a path from the half-way shape to an expression that no training shape has (Figure 7).
/// Appends a row per method, and plots both sweeps.
void study_shape_space(const StudyInput& input, const DprtOptions& options, StudyTable& table);

}  // namespace rebake
