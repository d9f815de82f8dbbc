#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Runs `work`, which must not use Python objects, on another thread without the GIL, so that other Python threads
/// continue. Calls `callback(task, share 0 … 1)` from the calling thread, at most ten times per second; None: no calls.
///
/// Ctrl+C or an exception of the callback cancels the work and is raised. If the work succeeds nevertheless, its result
/// is valid: the interrupt is raised after the call, and the callback's exception goes to sys.unraisablehook. Throws
/// exceptions of `work`. Throws Error during interpreter shutdown, and in a process forked from one that has called
/// run_without_gil(), because threads do not survive a fork.
void run_without_gil(const pybind11::object& callback, const std::function<void(const Progress&)>& work);

/// RAII guard that registers a thread that is inside the module without the GIL, so that shutdown waits for it. `flag`,
/// if not null, is set to true at shutdown. The constructor throws Error if shutdown has begun.
class ModuleGuard {
 public:
  explicit ModuleGuard(std::atomic<bool>* flag = nullptr);
  ~ModuleGuard();
  ModuleGuard(const ModuleGuard&) = delete;
  ModuleGuard& operator=(const ModuleGuard&) = delete;

 private:
  std::atomic<bool>* flag_;
};

/// Cancels all work, refuses new work, and waits until no ModuleGuard is left; ends the process after 5 s. To be
/// registered with atexit: a thread that requests the GIL after shutdown would abort the process.
void shut_down_workers();

}  // namespace rebake
