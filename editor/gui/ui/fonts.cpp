#include "editor/gui/ui/fonts.h"

#include <imgui.h>

#include <filesystem>
#include <initializer_list>

#include "editor/gui/ui/theme.h"

namespace rebake {

namespace {

Fonts loaded;

// The first of the files that exists; null if none does.
const char* first_of(std::initializer_list<const char*> files) {
  for (const char* file : files)
    if (std::filesystem::exists(file)) return file;
  return nullptr;
}

// Unicode ranges of the text fonts: Latin, punctuation, arrows and mathematical operators.
constexpr ImWchar letters[] = {0x20, 0x17F, 0x2010, 0x2026, 0x2190, 0x2193, 0x2200, 0x22FF, 0};
constexpr ImWchar signs[] = {0xF001, 0xF66F, 0};
constexpr const char* icon_file =
    "/usr/share/fonts/truetype/materialdesignicons-webfont/materialdesignicons-webfont.ttf";

ImFont* add(const char* file, float size, float scale, bool with_icons) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  ImFont* font = nullptr;
  if (file != nullptr) {
    ImFontConfig config;
    config.OversampleH = 2;
    font = atlas.AddFontFromFileTTF(file, size * scale, &config, letters);
  }
  if (font == nullptr) {
    ImFontConfig config;
    config.SizePixels = size * scale;
    font = atlas.AddFontDefault(&config);
  }
  if (with_icons) {
    ImFontConfig config;
    config.MergeMode = true;
    config.GlyphOffset = {0, 0.12F * size * scale};  // centres icons on the letters
    atlas.AddFontFromFileTTF(icon_file, size * scale, &config, signs);
  }
  return font;
}

}  // namespace

const Fonts& fonts() { return loaded; }

void load_fonts(float scale) {
  ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
  atlas.Clear();
  loaded = {};
  loaded.have_icons = std::filesystem::exists(icon_file);
  const char* const text = first_of({"/usr/share/fonts/opentype/inter/Inter-Regular.otf",
                                     "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                                     "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"});
  const char* const heading = first_of({"/usr/share/fonts/opentype/inter/Inter-SemiBold.otf",
                                        "/usr/share/fonts/truetype/noto/NotoSans-Bold.ttf",
                                        "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"});
  loaded.text = add(text, space::text, scale, loaded.have_icons);
  loaded.heading = add(heading, space::heading, scale, false);
  loaded.icons = loaded.text;
  if (loaded.have_icons) loaded.icons = atlas.AddFontFromFileTTF(icon_file, space::icon * scale, nullptr, signs);
  atlas.Build();
}

}  // namespace rebake
