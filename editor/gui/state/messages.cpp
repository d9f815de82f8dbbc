#include "editor/gui/state/messages.h"

#include <algorithm>

namespace rebake {

std::vector<std::size_t> Messages::shown() const {
  std::vector<std::size_t> lines;
  for (std::size_t k = log_.size(); k > 0 && lines.size() < max_shown; --k)
    if (shows(log_[k - 1])) lines.push_back(k - 1);
  std::reverse(lines.begin(), lines.end());
  return lines;
}

bool Messages::close_failures() {
  bool any = false;
  for (Line& line : log_)
    if (line.failed && !line.read) line.read = any = true;
  return any;
}

double Messages::changes_in() const {
  double least = -1;
  for (const std::size_t k : shown()) {
    if (log_[k].failed) continue;
    const double left = std::chrono::duration<double>(log_[k].said + shown_for - Clock::now()).count();
    least = least < 0 ? std::max(left, 0.0) : std::min(least, std::max(left, 0.0));
  }
  return least;
}

}  // namespace rebake
