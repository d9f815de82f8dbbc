#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace rebake {

/// What was said to people: all of it in the log, the latest also over the picture for a while.
class Messages {
 public:
  using Clock = std::chrono::steady_clock;
  struct Line {
    std::string text;
    bool failed = false;
    Clock::time_point said;
    bool read = false;  ///< people closed it
  };

  void say(std::string text) { add(std::move(text), false); }
  /// To the log only.
  void note(std::string text) {
    add(std::move(text), false);
    log_.back().read = true;
  }
  /// What failed stays over the picture until it is closed.
  void fail(std::string text) { add(std::move(text), true); }
  const std::vector<Line>& log() const { return log_; }
  /// Lines that are to be seen over the picture, oldest first.
  std::vector<std::size_t> shown() const;
  void close(std::size_t line) { log_[line].read = true; }
  /// False when none that failed was to be seen.
  bool close_failures();
  /// Seconds until what is shown changes by itself; negative for never.
  double changes_in() const;

 private:
  static constexpr std::chrono::seconds shown_for{5};
  static constexpr std::size_t most_shown = 4;
  void add(std::string text, bool failed) { log_.push_back({std::move(text), failed, Clock::now()}); }
  bool shows(const Line& line) const { return !line.read && (line.failed || Clock::now() - line.said < shown_for); }

  std::vector<Line> log_;
};

}  // namespace rebake
