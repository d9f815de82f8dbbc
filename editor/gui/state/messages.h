#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace rebake {

/// Messages to the user. The log has all of them; recent ones are also shown over the viewport (toasts) for 5 s, errors
/// until they are closed.
class Messages {
 public:
  using Clock = std::chrono::steady_clock;
  struct Line {
    std::string text;
    bool failed = false;
    Clock::time_point said;
    bool read = false;  ///< no longer shown over the viewport: closed, or only meant for the log
  };

  /// Adds a message that is shown for 5 s.
  void say(std::string text) { add(std::move(text), false); }
  /// Adds a message to the log only.
  void note(std::string text) {
    add(std::move(text), false);
    log_.back().read = true;
  }
  /// Adds an error, which is shown until it is closed.
  void fail(std::string text) { add(std::move(text), true); }
  const std::vector<Line>& log() const { return log_; }
  /// Indices in log() of the messages to show over the viewport: the latest four, oldest first.
  std::vector<std::size_t> shown() const;
  void close(std::size_t line) { log_[line].read = true; }
  /// Closes all errors; false if none was open.
  bool close_failures();
  /// Seconds until the next shown message expires; negative: never.
  double changes_in() const;

 private:
  static constexpr std::chrono::seconds shown_for{5};
  static constexpr std::size_t max_shown = 4;
  void add(std::string text, bool failed) { log_.push_back({std::move(text), failed, Clock::now()}); }
  bool shows(const Line& line) const { return !line.read && (line.failed || Clock::now() - line.said < shown_for); }

  std::vector<Line> log_;
};

}  // namespace rebake
