#include "editor/gui/state/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "editor/document/user_folder.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"

namespace rebake {

namespace fs = std::filesystem;
using nlohmann::json;

NLOHMANN_JSON_SERIALIZE_ENUM(ColorTheme,
                             {{ColorTheme::dark, "dark"}, {ColorTheme::light, "light"}, {ColorTheme::system, "system"}})
NLOHMANN_JSON_SERIALIZE_ENUM(BottomTab, {{BottomTab::history, "history"},
                                         {BottomTab::views, "views"},
                                         {BottomTab::light, "light"},
                                         {BottomTab::script, "script"},
                                         {BottomTab::cost, "cost"},
                                         {BottomTab::log, "messages"}})

namespace {

// Without a home folder, /tmp is used.
fs::path folder_of_user(const char* variable, const char* below_home) {
  return user_folder(variable, below_home).value_or(fs::path("/tmp") / below_home);
}

// Calls visit(name, member) for all fields.
template <class Self, class Visit>
void for_fields(Self& self, Visit visit) {
  visit("looks", self.looks);
  visit("text_scale", self.text_scale);
  visit("scene_background", self.scene_background);
  visit("adjust_open", self.adjust_open);
  visit("bottom_open", self.bottom_open);
  visit("bottom_tab", self.bottom_tab);
  visit("outline_open", self.outline_open);
  visit("properties_open", self.properties_open);
  visit("outline_share", self.outline_share);
  visit("blender_keys", self.blender_keys);
  visit("grid", self.grid);
  visit("brush_radius", self.brush_radius);
  visit("likeness", self.likeness);
  visit("flood_everywhere", self.flood_everywhere);
  visit("side_width", self.side_width);
  visit("bottom_height", self.bottom_height);
  visit("window_width", self.window_width);
  visit("window_height", self.window_height);
  visit("opened_from", self.opened_from);
  visit("written_to", self.written_to);
  visit("recent", self.recent);
}

}  // namespace

void Settings::remember(const std::string& path) {
  constexpr std::size_t most = 12;
  std::erase(recent, path);
  recent.insert(recent.begin(), path);
  if (recent.size() > most) recent.resize(most);
}

fs::path config_folder() { return folder_of_user("XDG_CONFIG_HOME", ".config") / "rebake"; }
fs::path cache_folder() { return folder_of_user("XDG_CACHE_HOME", ".cache") / "rebake"; }
fs::path journal_folder() { return folder_of_user("XDG_STATE_HOME", ".local/state") / "rebake" / "journals"; }

Settings read_settings(const fs::path& file, std::string& problem) {
  if (!fs::exists(file)) return {};
  try {
    const json read = json::parse(read_file(file));
    if (!read.is_object()) throw Error("the top level must be a JSON object");
    Settings settings;
    for_fields(settings, [&](const char* name, auto& value) {
      if (read.contains(name)) read.at(name).get_to(value);
    });
    settings.brush_radius = std::clamp(settings.brush_radius, 1.0, 500.0);
    settings.likeness = std::clamp(settings.likeness, 0.0, 1.0);
    settings.text_scale = std::clamp(settings.text_scale, 0.6, 3.0);
    settings.outline_share = std::clamp(settings.outline_share, 0.15, 0.85);
    settings.side_width = std::clamp(settings.side_width, 200.0, 1000.0);
    settings.bottom_height = std::clamp(settings.bottom_height, 80.0, 800.0);
    settings.window_width = std::clamp(settings.window_width, 640, 16384);
    settings.window_height = std::clamp(settings.window_height, 400, 16384);
    return settings;
  } catch (const std::exception& error) {
    problem = fmt::format(
        "{0}: cannot be read, so default settings are used: {1}. With the next change of a setting, it is renamed to "
        "{2}.unreadable; correct it there and name it {2} again",
        file.string(), error.what(), file.filename().string());
    return {};
  }
}

namespace {

// Renames a file that people may have edited and that cannot be read, so that it is not lost.
void keep_unreadable(const fs::path& file) {
  std::string problem;
  read_settings(file, problem);
  if (problem.empty()) return;
  fs::path kept = file.string() + ".unreadable";
  for (int k = 2; fs::exists(fs::symlink_status(kept)); ++k) kept = fmt::format("{}.unreadable-{}", file.string(), k);
  fs::rename(file, kept);
}

}  // namespace

void write_settings(const Settings& settings, const Settings& known, const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error) throw FileError(file.parent_path(), "cannot be created: " + error.message());
  json object, before;
  try {
    keep_unreadable(file);
    object = fs::exists(file) ? json::parse(read_file(file)) : json::object();
  } catch (const fs::filesystem_error& failed) {
    throw FileError(file, std::string("cannot be read, nor renamed: ") + failed.code().message());
  } catch (const json::exception&) {
    throw FileError(file, "is being written by another program; settings will be saved with the next change");
  }
  for_fields(known, [&](const char* name, const auto& value) { before[name] = value; });
  for_fields(settings, [&](const char* name, const auto& value) {
    if (const json now = value; !object.contains(name) || before.at(name) != now) object[name] = now;
  });
  write_file_atomically(file, object.dump(1) + "\n", {});
}

}  // namespace rebake
