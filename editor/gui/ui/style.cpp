#include "editor/gui/ui/style.h"

namespace rebake {

namespace {

const Theme* present = &dark_theme();
float pixels = 1;

}  // namespace

const Theme& theme() { return *present; }
float px(float plain) { return plain * pixels; }

void set_style(const Theme& theme, float scale) {
  present = &theme;
  pixels = scale;
  ImGuiStyle style;
  style.WindowPadding = {space::panel, space::panel};
  style.FramePadding = {8, 5};
  style.ItemSpacing = {space::gap, space::gap};
  style.ItemInnerSpacing = {space::gap, space::gap};
  style.CellPadding = {6, 3};
  style.IndentSpacing = 18;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 10;
  style.WindowRounding = 0;
  style.ChildRounding = space::rounding;
  style.FrameRounding = space::rounding;
  style.PopupRounding = 2 * space::rounding;
  style.ScrollbarRounding = style.GrabRounding = style.TabRounding = space::rounding;
  style.WindowBorderSize = 0;
  style.ChildBorderSize = 0;
  style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.WindowMinSize = {1, 1};
  style.WindowMenuButtonPosition = ImGuiDir_None;
  style.DisabledAlpha = 0.45F;
  style.ScaleAllSizes(scale);
  ImVec4* c = style.Colors;
  const auto all = [&](Rgb value, std::initializer_list<ImGuiCol> which) {
    for (const ImGuiCol one : which) c[one] = color(value);
  };
  all(theme.text, {ImGuiCol_Text});
  all(theme.muted, {ImGuiCol_TextDisabled});
  all(theme.panel, {ImGuiCol_WindowBg, ImGuiCol_MenuBarBg, ImGuiCol_TitleBg, ImGuiCol_TitleBgCollapsed});
  all(theme.popup, {ImGuiCol_PopupBg, ImGuiCol_TitleBgActive});
  all(theme.border, {ImGuiCol_Border, ImGuiCol_Separator, ImGuiCol_TableBorderStrong, ImGuiCol_TableBorderLight});
  all(theme.field, {ImGuiCol_FrameBg, ImGuiCol_ScrollbarBg});
  all(theme.raised, {ImGuiCol_Button, ImGuiCol_Header, ImGuiCol_ScrollbarGrab, ImGuiCol_Tab, ImGuiCol_TabUnfocused,
                     ImGuiCol_TableHeaderBg});
  all(theme.hovered,
      {ImGuiCol_FrameBgHovered, ImGuiCol_ButtonHovered, ImGuiCol_HeaderHovered, ImGuiCol_ScrollbarGrabHovered,
       ImGuiCol_TabHovered, ImGuiCol_SeparatorHovered, ImGuiCol_ResizeGripHovered});
  all(theme.pressed, {ImGuiCol_FrameBgActive, ImGuiCol_ButtonActive, ImGuiCol_HeaderActive,
                      ImGuiCol_ScrollbarGrabActive, ImGuiCol_TabActive, ImGuiCol_TabUnfocusedActive});
  all(theme.accent, {ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive, ImGuiCol_SeparatorActive,
                     ImGuiCol_ResizeGripActive, ImGuiCol_PlotHistogram, ImGuiCol_NavHighlight});
  all(theme.accent_text, {ImGuiCol_CheckMark, ImGuiCol_PlotLines, ImGuiCol_DragDropTarget});
  c[ImGuiCol_ChildBg] = color(theme.panel, 0);
  c[ImGuiCol_BorderShadow] = color(theme.border, 0);
  c[ImGuiCol_ResizeGrip] = color(theme.hovered, 0);
  c[ImGuiCol_TextSelectedBg] = color(theme.accent, 0.45F);
  c[ImGuiCol_TableRowBg] = color(theme.field, 0);
  c[ImGuiCol_TableRowBgAlt] = color(theme.text, 0.03F);
  c[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.45F};
  ImGui::GetStyle() = style;
}

}  // namespace rebake
