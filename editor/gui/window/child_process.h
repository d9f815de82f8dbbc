#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace rebake {

/// Where a program of that name lies on the PATH; empty where there is none.
std::string program_path(const std::string& name);

/// A program that runs beside this one. It is killed when this goes.
class ChildProcess {
 public:
  /// The program, by its path, and its arguments. Throws Error where it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Its exit status once it has ended (128 + n for a signal n), nothing before. Does not wait.
  std::optional<int> ended();
  /// What it wrote to its standard output, as far as ended() has read it.
  const std::string& output() const { return output_; }

 private:
  void read();
  pid_t process_ = -1;
  int pipe_ = -1;  ///< the reading end of its standard output
  std::string output_;
  std::optional<int> status_;
};

}  // namespace rebake
