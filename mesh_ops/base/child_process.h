#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace rebake {

/// Path of a program on the PATH; empty if there is none.
std::string program_path(const std::string& name);

/// A child process whose standard output is captured. The destructor kills it.
class ChildProcess {
 public:
  /// Starts a program: its path, then its arguments. Throws Error if it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Exit status once the process has ended (128 + n for signal n), nothing before. Reads available output; does not
  /// block.
  std::optional<int> ended();
  /// Standard output that ended() has read so far.
  const std::string& output() const { return output_; }

 private:
  void read();
  pid_t process_ = -1;
  int pipe_ = -1;  ///< read end of the pipe from its standard output
  std::string output_;
  std::optional<int> status_;
};

}  // namespace rebake
