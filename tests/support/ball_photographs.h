#pragma once

#include <vector>

#include "mesh_ops/refit/photograph_fit.h"

namespace rebake {

/// Photographs of side² pixels of a coloured ball of radius ½ at the origin over white, from cameras around it.
/// `phase`: 0 … 1, moves the cameras between those of other calls.
std::vector<FitPhotograph> ball_photographs(int count, int side, double phase = 0);

}  // namespace rebake
