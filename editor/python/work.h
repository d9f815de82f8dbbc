#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>

#include "mesh_ops/base/progress.h"

namespace rebake {

/// Does work that takes no Python object, on a thread of its own, while other Python threads go on. The calling thread
/// tells `callback` (None, or called with what is done and the share) how far it is, ten times a second at most, and
/// asks the work to stop when Ctrl+C was pressed or the callback raises. When the work stops, that is raised; when it
/// was done already, the result stands: an interrupt is raised behind the call, and the callback's exception goes to
/// sys.unraisablehook. Throws what the work throws, and Error in a process that was forked off one that worked (threads
/// do not come along) or while the interpreter ends.
void do_work(const pybind11::object& callback, const std::function<void(const Progress&)>& work);

/// Stands for a thread that is inside the module without the interpreter's lock. `flag`, where not null, is set when
/// the interpreter ends. Throws Error when it is ending already.
class InsideModule {
 public:
  explicit InsideModule(std::atomic<bool>* flag = nullptr);
  ~InsideModule();
  InsideModule(const InsideModule&) = delete;
  InsideModule& operator=(const InsideModule&) = delete;

 private:
  std::atomic<bool>* flag_;
};

/// Asks all work to stop, waits until no thread is inside (5 seconds at most, then ends the process), and refuses
/// more. For atexit: a thread that wants
/// the interpreter back when it has ended would abort the process.
void end_all_work();

}  // namespace rebake
