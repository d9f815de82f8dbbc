#include "editor/gui/ui/announce.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

namespace rebake::announce {

namespace {

struct AnnounceState {
  int pipe = -1;
  std::vector<std::string> parts;
  nlohmann::json items = nlohmann::json::object();
  std::string written;
};

// For the window's thread only.
AnnounceState& told() {
  static AnnounceState one = [] {
    AnnounceState made;
    const char* const path = std::getenv("REBAKE_ANNOUNCE");
    if (path == nullptr) return made;
    std::signal(SIGPIPE, SIG_IGN);
    made.pipe = ::open(path, O_WRONLY | O_CLOEXEC);
    // Text that somebody keeps in a file would be overwritten.
    struct stat about {};
    if (made.pipe >= 0 && (::fstat(made.pipe, &about) != 0 || S_ISREG(about.st_mode))) {
      ::close(made.pipe);
      made.pipe = -1;
    }
    return made;
  }();
  return one;
}

std::string full(const std::string& name) {
  std::string result;
  for (const std::string& part : told().parts) result += part + "/";
  return result + name;
}

}  // namespace

bool on() { return told().pipe >= 0; }

void item(const std::string& name) {
  if (!on() || !ImGui::IsItemVisible()) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  told().items[full(name)] = {low.x, low.y, high.x - low.x, high.y - low.y};
}

void point(const std::string& name, const ImVec2& at) {
  if (on()) told().items[full(name)] = {at.x, at.y, 0, 0};
}

Part::Part(const std::string& name) {
  if (on()) told().parts.push_back(name);
}
Part::~Part() {
  if (on()) told().parts.pop_back();
}

void frame(const nlohmann::json& state) {
  if (!on()) return;
  nlohmann::json object = state;
  object["items"] = std::exchange(told().items, nlohmann::json::object());
  const std::string text = object.dump() + "\n";
  if (text == told().written) return;
  told().written = text;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t more = ::write(told().pipe, text.data() + sent, text.size() - sent);
    if (more < 0 && errno != EINTR) {
      told().pipe = -1;  // the reader has closed the pipe
      return;
    }
    if (more > 0) sent += static_cast<std::size_t>(more);
  }
}

}  // namespace rebake::announce
