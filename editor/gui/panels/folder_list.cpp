#include "editor/gui/panels/folder_list.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

std::string small_letters(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

bool holds_scene(const fs::path& path) {
  try {
    return format_at(path) != nullptr;
  } catch (const fs::filesystem_error&) {
    return false;  // no permission to read it
  }
}

bool has_ending(const fs::path& path, const std::string& endings) {
  const std::string ending = small_letters(path.extension().string());
  return !ending.empty() && (" " + endings + " ").find(" " + ending + " ") != std::string::npos;
}

void FolderList::look_at(const fs::path& folder, const std::string& endings, bool again) {
  if (folder_ == folder && endings_ == endings && !again) return;
  folder_ = folder;
  endings_ = endings;
  entries_.clear();
  chosen_.clear();
  last_.clear();
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().filename().string().starts_with('.')) continue;
    std::error_code unknown;
    const bool is_folder = at->is_directory(unknown);
    if (!is_folder && !has_ending(at->path(), endings)) continue;
    entries_.push_back({at->path(), is_folder, holds_scene(at->path())});
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return std::pair(!a.is_folder, a.path) < std::pair(!b.is_folder, b.path);
  });
  filter("");
}

void FolderList::filter(const std::string& name) {
  const std::string wanted = small_letters(name);
  shown_.clear();
  bool exact = false;
  for (const Entry& entry : entries_) {
    const std::string here = small_letters(entry.path.filename().string());
    exact = exact || here == wanted;
    if (here.find(wanted) != std::string::npos) shown_.push_back(&entry);
  }
  if (!exact && !shown_.empty()) return;
  shown_.clear();
  for (const Entry& entry : entries_) shown_.push_back(&entry);
}

FolderList::Taken FolderList::draw(Thumbnails& thumbnails, bool opens, bool several) {
  Taken taken;
  const announce::Part part("entries");
  if (ImGui::Selectable((std::string(icons::arrow_up) + "  ..").c_str(), false))
    taken.path = (folder_ / "..").lexically_normal() / "";
  announce::item("..");
  for (const Entry* const entry : shown_) {
    const std::string name = entry->path.filename().string();
    const unsigned picture = entry->is_folder && !entry->is_scene ? 0 : thumbnails.of_file(entry->path.string());
    const char* icon = entry->is_scene    ? icons::cube_outline
                       : entry->is_folder ? icons::folder_outline
                                          : icons::file_outline;
    ImGui::PushID(name.c_str());
    const ImVec2 at = ImGui::GetCursorScreenPos(), small{px(48), px(30)};
    const float line = ImGui::GetTextLineHeight(), high = picture != 0 ? small.y : line;
    const bool clicked =
        ImGui::Selectable("##entry", chosen_.contains(entry->path), ImGuiSelectableFlags_AllowDoubleClick, {0, high});
    announce::item(name);
    if (scrolls_ && entry->path == last_) ImGui::SetScrollHereY();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const float across = picture != 0 ? small.x + px(8) : px(24);
    if (picture != 0)
      list.AddImageRounded(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture)), at,
                           {at.x + small.x, at.y + small.y}, {0, 0}, {1, 1}, IM_COL32_WHITE, px(3));
    const ImU32 ink = color32(entry->is_folder && !entry->is_scene ? theme().muted : theme().text);
    if (picture == 0) list.AddText(at, ink, icon);
    list.AddText({at.x + across, at.y + (high - line) / 2}, ink, name.c_str());
    ImGui::PopID();
    if (!clicked) continue;
    const bool enters = entry->is_folder && !(entry->is_scene && opens);
    const ImGuiIO& io = ImGui::GetIO();
    if (!several || enters || (!io.KeyCtrl && !io.KeyShift)) {
      chosen_ = {entry->path};
    } else if (io.KeyCtrl && chosen_.contains(entry->path)) {
      chosen_.erase(entry->path);
      if (chosen_.empty()) continue;
      taken.path = last_ = *chosen_.begin();
      continue;
    } else if (io.KeyCtrl) {
      chosen_.insert(entry->path);
    } else {
      // Shift: choose the range from the last clicked entry, if it is still shown. Skip folders that are not scenes.
      const bool from_last =
          std::any_of(shown_.begin(), shown_.end(), [&](const Entry* e) { return e->path == last_; });
      bool within = false;
      for (const Entry* const other : shown_) {
        const bool end = other->path == entry->path || (from_last && other->path == last_);
        if ((within || end) && (!other->is_folder || other->is_scene)) chosen_.insert(other->path);
        if (end && from_last && entry->path != last_) within = !within;
      }
    }
    last_ = entry->path;
    taken.path = enters ? entry->path / "" : entry->path;
    taken.at_once = !enters && ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left);
  }
  scrolls_ = false;
  return taken;
}

fs::path FolderList::step(int by) {
  if (shown_.empty()) return {};
  const auto found =
      std::find_if(shown_.begin(), shown_.end(), [&](const Entry* entry) { return entry->path == last_; });
  const auto last = static_cast<std::ptrdiff_t>(shown_.size()) - 1;
  const std::ptrdiff_t next = found == shown_.end() ? (by > 0 ? 0 : last) : found - shown_.begin() + by;
  last_ = shown_[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(next, 0, last))]->path;
  chosen_ = {last_};
  scrolls_ = true;
  return last_;
}

std::string FolderList::completed(const std::string& name) const {
  std::string result;
  std::size_t matches = 0;
  bool enters = false;
  for (const Entry& entry : entries_) {
    const std::string here = entry.path.filename().string();
    if (!small_letters(here).starts_with(small_letters(name))) continue;
    enters = entry.is_folder && !entry.is_scene;
    if (matches++ == 0)
      result = here;
    else
      result.resize(static_cast<std::size_t>(
          std::mismatch(result.begin(), result.end(), here.begin(), here.end()).first - result.begin()));
  }
  if (matches == 0 || result.size() < name.size()) return name;
  return matches == 1 && enters ? result + "/" : result;
}

}  // namespace rebake
