#include "editor/gui/ui/widgets.h"

#include <cstring>

#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"

namespace rebake::ui {

namespace {

std::string announced(const char* label) {
  const char* hidden = std::strstr(label, "##");
  if (hidden == nullptr) return label;
  while (*hidden == '#') ++hidden;
  return hidden;
}

// RAII: while an instance exists, buttons have the colours of a selected or primary button.
class SelectedButtonColors {
 public:
  explicit SelectedButtonColors(bool chosen) : chosen_(chosen) {
    if (!chosen_) return;
    const Rgb accent = theme().accent;
    for (const ImGuiCol one : {ImGuiCol_Button, ImGuiCol_ButtonHovered, ImGuiCol_ButtonActive})
      ImGui::PushStyleColor(one, color(accent, one == ImGuiCol_Button ? 1.0F : 0.92F));
    ImGui::PushStyleColor(ImGuiCol_Text, color(theme().on_accent));
  }
  ~SelectedButtonColors() {
    if (chosen_) ImGui::PopStyleColor(4);
  }
  SelectedButtonColors(const SelectedButtonColors&) = delete;
  SelectedButtonColors& operator=(const SelectedButtonColors&) = delete;

 private:
  bool chosen_;
};

}  // namespace

void tip(const std::string& title, const std::string& key, const std::string& sentence) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(10), px(8)});
  ImGui::BeginTooltip();
  ImGui::TextUnformatted(title.c_str());
  if (!key.empty()) {
    ImGui::SameLine(0, px(16));
    ImGui::TextDisabled("%s", key.c_str());
  }
  if (!sentence.empty()) {
    ImGui::PushTextWrapPos(px(300));
    ImGui::PushStyleColor(ImGuiCol_Text, color(theme().muted));
    ImGui::TextUnformatted(sentence.c_str());
    ImGui::PopStyleColor();
    ImGui::PopTextWrapPos();
  }
  ImGui::EndTooltip();
  ImGui::PopStyleVar();
}

bool button(const char* label, const ImVec2& size) {
  const bool pressed = ImGui::Button(label, size);
  announce::item(announced(label));
  return pressed;
}

bool primary_button(const char* label, const ImVec2& size) {
  const SelectedButtonColors colors(true);
  return button(label, size);
}

bool icon_button(const char* icon, const char* name, bool chosen) {
  const float side = px(34);
  ImGui::PushID(name);
  bool pressed = false;
  {
    const SelectedButtonColors colors(chosen);
    if (!chosen) ImGui::PushStyleColor(ImGuiCol_Button, color(theme().panel, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0, 0});
    if (fonts().have_icons) {
      ImGui::PushFont(fonts().icons);
      pressed = ImGui::Button(icon, {side, side});
      ImGui::PopFont();
    } else {
      pressed = ImGui::Button(std::string(name).substr(0, 4).c_str(), {side, side});
    }
    ImGui::PopStyleVar();
    if (!chosen) ImGui::PopStyleColor();
  }
  ImGui::PopID();
  announce::item(name);
  return pressed;
}

bool quiet_icon(const char* icon, const char* name, bool chosen, bool on_accent) {
  ImGui::PushID(name);
  ImGui::PushStyleColor(ImGuiCol_Button, color(theme().panel, 0));
  ImGui::PushStyleColor(ImGuiCol_Text, color(on_accent ? theme().on_accent : chosen ? theme().text : theme().muted));
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {px(3), 0});
  const bool pressed = ImGui::Button(fonts().have_icons ? icon : std::string(name).substr(0, 3).c_str());
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  ImGui::PopID();
  announce::item(name);
  return pressed;
}

bool toggle(const char* label, bool& value) {
  // The border makes an unchecked box visible on the panel.
  ImGui::PushStyleVar(ImGuiStyleVar_FrameBorderSize, px(1));
  ImGui::PushStyleColor(ImGuiCol_Border, color(theme().muted));
  const bool changed = ImGui::Checkbox(label, &value);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  announce::item(announced(label));
  return changed;
}

bool choice(const char* label, int& value, std::initializer_list<const char*> names) {
  ImGui::PushID(label);
  const int before = value;
  int index = 0;
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {px(1), px(space::gap)});
  for (const char* name : names) {
    if (index > 0) ImGui::SameLine();
    const SelectedButtonColors colors(index == value);
    if (ImGui::Button(name)) value = index;
    announce::item(announced(name));
    ++index;
  }
  ImGui::PopStyleVar();
  ImGui::PopID();
  return value != before;
}

void label(const char* text) {
  ImGui::AlignTextToFramePadding();
  ImGui::PushStyleColor(ImGuiCol_Text, color(theme().muted));
  ImGui::TextUnformatted(text);
  ImGui::PopStyleColor();
  ImGui::SameLine(px(92));
  ImGui::SetNextItemWidth(-1);
}

bool section(const char* title, bool& open) {
  ImGui::PushStyleColor(ImGuiCol_Header, color(theme().panel, 0));
  ImGui::PushID(title);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (ImGui::Selectable("##section", false, 0, {0, px(space::heading + 6)})) open = !open;
  announce::item(title);
  ImGui::PopID();
  ImGui::PopStyleColor();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float middle = at.y + px(space::heading + 6) / 2;
  const float x = at.x + px(6), r = px(4);
  if (open)
    list.AddTriangleFilled({x - r, middle - r / 2}, {x + r, middle - r / 2}, {x, middle + r}, color32(theme().muted));
  else
    list.AddTriangleFilled({x - r / 2, middle - r}, {x + r, middle}, {x - r / 2, middle + r}, color32(theme().muted));
  list.AddText(fonts().heading, px(space::heading) * 0.9F, {at.x + px(18), middle - px(space::heading) * 0.45F},
               color32(theme().text), title);
  return open;
}

void muted(const std::string& text) { wrapped(text, theme().muted); }

void wrapped(const std::string& text, Rgb value) {
  ImGui::PushStyleColor(ImGuiCol_Text, color(value));
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

void flow(float width) {
  const float right = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width;
  if (right < ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) ImGui::SameLine();
}

void hint(const std::string& text) {
  ImGui::SameLine(0, px(space::section));
  const float room = ImGui::GetContentRegionAvail().x;
  if (room < px(60)) {
    ImGui::NewLine();
    return;
  }
  ImGui::AlignTextToFramePadding();
  const std::string fits = shortened(text, room);
  ImGui::TextDisabled("%s", fits.c_str());
  if (fits != text) tip(text);
}

std::string shortened(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  std::string result = text;
  while (!result.empty() && ImGui::CalcTextSize((result + "…").c_str()).x > width) {
    // Removes one whole UTF-8 character.
    while (!result.empty() && (result.back() & 0xC0) == 0x80) result.pop_back();
    if (!result.empty()) result.pop_back();
  }
  return result + "…";
}

}  // namespace rebake::ui
