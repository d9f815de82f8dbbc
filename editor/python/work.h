#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Does work that takes no Python object, on a thread of its own, while other Python threads go on. The calling thread
/// tells `callback` (None, or called with what is done and the share) how far it is, ten times a second at most, and
/// asks the work to stop when Ctrl+C was pressed or the callback raises; then raises that. Throws what the work throws,
/// and Error in a process that was forked off one that worked: threads do not come along.
void do_work(const pybind11::object& callback, const std::function<void(const Progress&)>& work);

}  // namespace rebake
