#include "editor/gui/tools/typed_number.h"

#include <GLFW/glfw3.h>

#include "editor/gui/ui/expression.h"

namespace rebake {

bool TypedNumber::key(const KeyPress& press) {
  if (press.control || press.alt) return false;
  const bool times = press.key == GLFW_KEY_KP_MULTIPLY || (press.key == GLFW_KEY_8 && press.shift);
  if (times) {
    text_ += '*';
  } else if (press.key >= GLFW_KEY_0 && press.key <= GLFW_KEY_9) {
    text_ += static_cast<char>(press.key);
  } else if (press.key >= GLFW_KEY_KP_0 && press.key <= GLFW_KEY_KP_9) {
    text_ += static_cast<char>('0' + press.key - GLFW_KEY_KP_0);
  } else if (press.key == GLFW_KEY_PERIOD || press.key == GLFW_KEY_KP_DECIMAL) {
    text_ += '.';
  } else if (press.key == GLFW_KEY_SLASH || press.key == GLFW_KEY_KP_DIVIDE) {
    text_ += '/';
  } else if (press.key == GLFW_KEY_MINUS || press.key == GLFW_KEY_KP_SUBTRACT) {
    text_ += '-';
  } else if (press.key == GLFW_KEY_BACKSPACE && !text_.empty()) {
    text_.pop_back();
  } else {
    return false;
  }
  // An incomplete expression keeps the previous value.
  if (text_.empty())
    value_.reset();
  else if (const std::optional<double> read = evaluated(text_))
    value_ = read;
  return true;
}

}  // namespace rebake
