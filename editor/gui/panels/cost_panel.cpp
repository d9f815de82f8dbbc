#include <fmt/format.h>
#include <imgui.h>

#include "editor/gui/panels/panels.h"

namespace rebake {

namespace {

void draw_measured(const Jobs::Costs& costs, const ViewState& view, const Scene& scene) {
  const bool same = costs.view.camera == view.camera && costs.view.width == view.width &&
                    costs.view.height == view.height && costs.roots == scene.roots &&
                    costs.background == scene.background;
  ImGui::TextDisabled("%s",
                      fmt::format("against 64 samples, {}x{}, {}{}", costs.view.width, costs.view.height, costs.device,
                                  same ? "" : "; of the view or scene as it was: measure again for this one")
                          .c_str());
  if (!ImGui::BeginTable("measured", 4, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
  for (const char* heading : {"choice", "ms", "PSNR dB", "largest of 255"}) ImGui::TableSetupColumn(heading);
  ImGui::TableHeadersRow();
  for (const StudyTable::Row& row : costs.rows) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(row.choice.c_str());
    for (const double value : row.values) {
      ImGui::TableNextColumn();
      ImGui::Text("%.1f", value);
    }
  }
  ImGui::EndTable();
}

}  // namespace

void draw_costs(Jobs& jobs, ViewState& view, const Snapshot& now, const FrameReport& report, bool& each_pass) {
  ImGui::Text("%s",
              fmt::format("{:.1f} ms a picture at {} samples a pixel, {:.0f} % of the resolution; at most {:.1f} MB on "
                          "the GPU; {:.1f} MB of history; {:.0f} pictures a second while moving",
                          report.times.frame_ms, report.samples, report.scale * 100,
                          static_cast<double>(report.gpu_bytes) / 1e6, static_cast<double>(now.history_bytes) / 1e6,
                          report.pictures_a_second)
                  .c_str());
  ImGui::TextDisabled("%s", report.device.c_str());
  ImGui::Checkbox("time each pass (waits between them)", &each_pass);
  ImGui::SameLine();
  for (const int samples : {1, 4, 16}) {
    if (ImGui::RadioButton(fmt::format("{} sample{}", samples, samples == 1 ? "" : "s").c_str(),
                           view.samples == samples))
      view.samples = samples;
    ImGui::SameLine();
  }
  ImGui::BeginDisabled(jobs.worker.busy() || now.scene.roots.empty());
  if (ImGui::Button("Measure this view")) jobs.measure_costs(view, now.scene);
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("times each choice and compares it with 64 samples a pixel");
  if (jobs.costs) draw_measured(*jobs.costs, view, now.scene);
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

}  // namespace rebake
