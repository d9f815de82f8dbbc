#include "editor/gui/window/desktop.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace rebake {

bool desktop_is_dark() {
  const char* const gtk = std::getenv("GTK_THEME");
  if (gtk != nullptr) return std::string(gtk).find("dark") != std::string::npos;
  if (std::getenv("DBUS_SESSION_BUS_ADDRESS") == nullptr) return true;
  FILE* const answer = ::popen(
      "timeout 0.5 gdbus call --session --dest org.freedesktop.portal.Desktop "
      "--object-path /org/freedesktop/portal/desktop --method org.freedesktop.portal.Settings.Read "
      "org.freedesktop.appearance color-scheme 2>/dev/null",
      "r");
  if (answer == nullptr) return true;
  std::array<char, 128> text{};
  const std::size_t size = std::fread(text.data(), 1, text.size() - 1, answer);
  ::pclose(answer);
  // "(<<uint32 1>>,)": 1 is dark, 2 light, 0 no wish.
  return std::string(text.data(), size).find("uint32 2") == std::string::npos;
}

}  // namespace rebake
