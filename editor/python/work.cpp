#include "editor/python/work.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>

#include "mesh_ops/base/error.h"

namespace py = pybind11;

namespace rebake {

namespace {

std::atomic<pid_t> worker_process = 0;  // process that called run_without_gil() first; 0: none

void refuse_forked() {
  const pid_t here = ::getpid();
  pid_t before = 0;
  if (!worker_process.compare_exchange_strong(before, here) && before != here)
    throw Error(
        "this process was forked from one that used rebake, and threads do not survive a fork: start processes by "
        "multiprocessing's \"spawn\", or fork before rebake is first used");
}

// State of all ModuleGuard guards: one entry in `flags` per guard, the cancel flag or null.
struct Running {
  std::mutex mutex;
  std::condition_variable changed;
  std::multiset<std::atomic<bool>*> flags;
  bool ending = false;
};
Running& running() {
  static Running one;
  return one;
}

// Handles an exception that Python raised during work that succeeded nevertheless.
void report_late_exception(py::error_already_set& raised) {
  if (raised.matches(PyExc_KeyboardInterrupt))
    PyErr_SetInterrupt();
  else
    raised.discard_as_unraisable("the progress callback of rebake");
}

}  // namespace

ModuleGuard::ModuleGuard(std::atomic<bool>* flag) : flag_(flag) {
  const std::scoped_lock lock(running().mutex);
  if (running().ending) throw Error("the interpreter is shutting down; rebake accepts no more work");
  running().flags.insert(flag_);
}
ModuleGuard::~ModuleGuard() {
  const std::scoped_lock lock(running().mutex);
  running().flags.erase(running().flags.find(flag_));
  running().changed.notify_all();
}

void shut_down_workers() {
  // In a forked process there are no worker threads, and one may have held the mutex during the fork.
  if (worker_process != 0 && worker_process != ::getpid()) return;
  const py::gil_scoped_release others;
  std::unique_lock lock(running().mutex);
  running().ending = true;
  for (std::atomic<bool>* flag : running().flags)
    if (flag != nullptr) *flag = true;
  constexpr std::chrono::seconds patience(5);
  if (!running().changed.wait_for(lock, patience, [] { return running().flags.empty(); })) ::_exit(1);
}

void run_without_gil(const py::object& callback, const std::function<void(const Progress&)>& work) {
  refuse_forked();
  std::mutex mutex;
  std::condition_variable changed;
  bool ended = false;
  std::exception_ptr failed;
  std::optional<std::pair<std::string, double>> latest;
  std::atomic<bool> cancel = false;
  const ModuleGuard inside(&cancel);
  const Progress progress(
      [&](std::string_view what, double share) {
        const std::scoped_lock lock(mutex);
        latest.emplace(what, share);
      },
      &cancel);
  std::thread worker([&] {
    try {
      work(progress);
    } catch (...) {
      failed = std::current_exception();
    }
    const std::scoped_lock lock(mutex);
    ended = true;
    changed.notify_all();
  });
  // Ctrl+C, or an exception of the callback.
  std::optional<py::error_already_set> raised;
  for (bool done = false; !done;) {
    std::optional<std::pair<std::string, double>> now;
    {
      const py::gil_scoped_release others;
      std::unique_lock lock(mutex);
      changed.wait_for(lock, std::chrono::milliseconds(100), [&] { return ended; });
      done = ended;
      now.swap(latest);
    }
    if (raised) continue;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (now && !callback.is_none()) callback(now->first, now->second);
    } catch (const py::error_already_set& error) {
      raised = error;
      cancel = true;
    }
  }
  {
    const py::gil_scoped_release others;
    worker.join();
  }
  if (failed && raised) throw std::move(*raised);
  if (failed) std::rethrow_exception(failed);
  if (raised) report_late_exception(*raised);
}

}  // namespace rebake
