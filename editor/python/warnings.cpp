#include "editor/python/warnings.h"

#include <pybind11/pybind11.h>

#include <string_view>

namespace rebake {

void warn(const std::string& message) {
  if (PyErr_WarnEx(PyExc_UserWarning, message.c_str(), 1) != 0) PyErr_WriteUnraisable(nullptr);
}

void warn_of_notes(const std::vector<std::string>& messages) {
  for (const std::string& message : messages)
    for (const std::string_view mark : {"note: ", "warning: "}) {
      const std::size_t at = message.find(mark);
      // After the name of an edit, "import: note: …", which is one word.
      const bool is_marked = at == 0 || (at != std::string::npos && at >= 2 && message.compare(at - 2, 2, ": ") == 0 &&
                                         message.find(' ') == at - 1);
      if (is_marked) warn(message.substr(0, at) + message.substr(at + mark.size()));
    }
}

}  // namespace rebake
