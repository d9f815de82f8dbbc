#pragma once

#include <string>
#include <vector>

namespace rebake {

/// What was said to people.
struct Messages {
  struct Line {
    std::string text;
    bool failed = false;
  };
  std::vector<Line> log;
  std::string error;  ///< shown until it is read
};

}  // namespace rebake
