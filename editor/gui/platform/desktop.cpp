#include "editor/gui/platform/desktop.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <sstream>
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
  // "(<<uint32 1>>,)": 1 means dark, 2 light, 0 no preference.
  return std::string(text.data(), size).find("uint32 2") == std::string::npos;
}

bool DesktopFileDialog::there() { return !program_path("zenity").empty() || !program_path("kdialog").empty(); }

DesktopFileDialog::DesktopFileDialog(Kind kind, const std::string& title, const std::filesystem::path& start,
                                     const std::string& ending) {
  std::vector<std::string> command;
  const std::string pattern = "*" + ending;
  if (const std::string zenity = program_path("zenity"); !zenity.empty()) {
    command = {zenity, "--file-selection", "--title=" + title, "--filename=" + start.string(), "--separator=\n"};
    if (kind == Kind::open_folders) command.insert(command.end(), {"--directory", "--multiple"});
    if (kind == Kind::open_file || kind == Kind::save_file) command.push_back("--file-filter=" + pattern);
    if (kind == Kind::save_file || kind == Kind::save_folder) command.emplace_back("--save");
  } else {
    command = {program_path("kdialog"), "--title", title};
    const char* const question = kind == Kind::open_folders ? "--getexistingdirectory"
                                 : kind == Kind::open_file  ? "--getopenfilename"
                                                            : "--getsavefilename";
    command.insert(command.end(), {question, start.string()});
    if (kind == Kind::open_file || kind == Kind::save_file) command.push_back(pattern);
  }
  process_ = std::make_unique<ChildProcess>(command);
}

std::optional<std::vector<std::string>> DesktopFileDialog::answer() {
  const std::optional<int> status = process_->ended();
  if (!status) return std::nullopt;
  std::vector<std::string> paths;
  std::istringstream lines(*status == 0 ? process_->output() : "");
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) paths.push_back(line);
  return paths;
}

}  // namespace rebake
