#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels.h"

namespace rebake {

void draw_costs(Desk& desk, const FrameReport& report, bool& each_pass) {
  ImGui::Text(
      "%s", fmt::format("{:.1f} ms a picture at {} samples a pixel, {:.0f} % of the resolution; at most {:.1f} MB on "
                        "the GPU; {:.1f} MB of history; {:.0f} pictures a second while moving",
                        report.times.frame_ms, report.samples, report.scale * 100,
                        static_cast<double>(report.gpu_bytes) / 1e6, static_cast<double>(desk.now->history_bytes) / 1e6,
                        report.pictures_a_second)
                .c_str());
  ImGui::TextDisabled("%s", report.device.c_str());
  ImGui::Checkbox("time each pass (waits between them)", &each_pass);
  ImGui::SameLine();
  // Errors against 64 samples, measured by `rebake study samples` on the sample ficus.
  struct Choice {
    int samples;
    const char* label;
  };
  for (const Choice& choice : {Choice{1, "1 sample (35.5 dB)"}, Choice{4, "4 (44.2 dB)"}, Choice{16, "16 (52.8 dB)"}}) {
    if (ImGui::RadioButton(choice.label, desk.samples == choice.samples)) desk.samples = choice.samples;
    ImGui::SameLine();
  }
  ImGui::TextDisabled("against 64, sample ficus");
  if (!ImGui::BeginTable("passes", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
  for (const PlannedPass& pass : report.passes) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.runs ? "runs" : "left out");
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.name.c_str());
    ImGui::TableNextColumn();
    if (const auto found = report.times.pass_ms.find(pass.name); found != report.times.pass_ms.end())
      ImGui::Text("%.1f ms", found->second);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(pass.why.c_str());
  }
  ImGui::EndTable();
}

void draw_log(const Desk& desk) {
  for (const Desk::Line& line : desk.log)
    if (line.failed)
      ImGui::TextColored({1, 0.5F, 0.4F, 1}, "%s", line.text.c_str());
    else
      ImGui::TextWrapped("%s", line.text.c_str());
}

}  // namespace rebake
