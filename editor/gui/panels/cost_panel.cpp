#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "editor/gui/panels/panels.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"

namespace rebake {

namespace {

/// A measured render setting: a number of samples or a share of the resolution.
struct Choice {
  std::string name;
  double ms, decibels, largest, fastest, slowest;
  Vec2 worst;        ///< position of the largest error, as shares of the image size
  int samples = 0;   ///< per pixel; 0: the setting is a share of the resolution
  double share = 1;  ///< share of the resolution, each way
};

// Parses the rows of the studies `samples` ("4 samples") and `resolution` ("50 %, 1 sample").
std::vector<Choice> choices_of(const Jobs::Costs& costs) {
  std::vector<Choice> list;
  for (const StudyTable::Row& row : costs.rows) {
    // The name ends at the comma, since all resolutions have 1 sample.
    Choice choice{row.choice.substr(0, row.choice.find(',')),
                  row.values.at(0),
                  row.values.at(1),
                  row.values.at(2),
                  row.values.at(3),
                  row.values.at(4),
                  Vec2(row.values.at(5), row.values.at(6))};
    const double number = std::atof(row.choice.c_str());
    if (row.choice.find('%') != std::string::npos)
      choice.share = number / 100;
    else
      choice.samples = static_cast<int>(number);
    // Other rows cannot be plotted.
    if (std::isfinite(choice.decibels) && choice.ms > 0) list.push_back(choice);
  }
  return list;
}

// Axes of the chart: PSNR in dB (vertical) over frame time in ms (horizontal, logarithmic).
class ChartAxes {
 public:
  ChartAxes(const std::vector<Choice>& choices, const ImVec2& at, const ImVec2& size) : at_(at), size_(size) {
    for (const Choice& choice : choices) {
      min_ms_ = std::min(min_ms_, choice.fastest / 1.2);
      max_ms_ = std::max(max_ms_, choice.slowest * 1.4);
      min_db_ = std::min(min_db_, choice.decibels - 3);
      max_db_ = std::max(max_db_, choice.decibels + 3);
    }
  }
  ImVec2 place(double ms, double decibels) const {
    const double x = std::log(ms / min_ms_) / std::log(max_ms_ / min_ms_);
    const double y = (decibels - min_db_) / std::max(1e-9, max_db_ - min_db_);
    return {at_.x + left_ + static_cast<float>(x) * (size_.x - left_ - right_),
            at_.y + size_.y - below_ - static_cast<float>(y) * (size_.y - below_ - above_)};
  }
  void draw(ImDrawList& list) const {
    const auto text = [&](const ImVec2& where, const std::string& said, float align) {
      const ImVec2 extent = ImGui::CalcTextSize(said.c_str());
      list.AddText({where.x - align * extent.x, where.y - extent.y / 2}, color32(theme().muted), said.c_str());
    };
    for (int tens = static_cast<int>(std::ceil(min_db_ / 10)); tens * 10 <= max_db_; ++tens) {
      const double db = 10.0 * tens;
      const ImVec2 p = place(min_ms_, db), q = place(max_ms_, db);
      list.AddLine(p, q, color32(theme().text, 0.12F));
      text({p.x - px(6), p.y}, fmt::format("{:.0f}", db), 1);
    }
    const int last = static_cast<int>(std::floor(std::log10(max_ms_)));
    for (int power = static_cast<int>(std::floor(std::log10(min_ms_))); power <= last; ++power)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double decade = std::pow(10, power);
        if (decade * factor < min_ms_ || decade * factor > max_ms_) continue;
        const ImVec2 p = place(decade * factor, min_db_), q = place(decade * factor, max_db_);
        list.AddLine(p, q, color32(theme().text, 0.07F));
        text({p.x, at_.y + size_.y - below_ + px(11)}, fmt::format("{:g} ms", decade * factor), 0.5F);
      }
    text({at_.x + px(6), at_.y + px(12)}, "dB", 0);
  }

 private:
  ImVec2 at_, size_;
  float left_ = px(44), below_ = px(30), above_ = px(10), right_ = px(14);
  double min_ms_ = 1e300, max_ms_ = 0, min_db_ = 1e300, max_db_ = -1e300;
};

// Draws a point with its name, and an error bar from the fastest to the slowest run. `right`: end of the chart.
void draw_point(const Choice& choice, const ChartAxes& axes, bool strong, bool now, float right, ImDrawList& list) {
  const ImVec2 p = axes.place(choice.ms, choice.decibels);
  announce::point(choice.name, p);
  const ImU32 ink = color32(choice.samples > 0 ? theme().accent_text : theme().muted);
  const ImVec2 first = axes.place(choice.fastest, choice.decibels),
               last_run = axes.place(choice.slowest, choice.decibels);
  list.AddLine(first, last_run, ink, px(1.5F));
  for (const ImVec2& end : {first, last_run})
    list.AddLine({end.x, end.y - px(4)}, {end.x, end.y + px(4)}, ink, px(1.5F));
  list.AddCircleFilled(p, px(strong ? 7 : 5), color32(now ? theme().accent : theme().panel));
  list.AddCircle(p, px(strong ? 7 : 5), ink, 0, px(2));
  // Resolutions are labelled below their points and samples above, since the points are close together.
  const float name_width = ImGui::CalcTextSize(choice.name.c_str()).x;
  const bool fits = p.x + px(9) + name_width < right;
  list.AddText({fits ? p.x + px(9) : p.x - px(9) - name_width, p.y + (choice.samples > 0 ? -px(18) : px(3))},
               color32(strong ? theme().text : theme().muted), choice.name.c_str());
}

// Describes the point under the pointer. A click applies its setting. `same`: the measurement is of the current view.
void point_at(const Choice& choice, ViewState& view, bool same) {
  if (same) view.marked = choice.worst;
  ImGui::SetTooltip(
      "%s: %.1f ms (%.1f to %.1f), %.1f dB, largest error %.0f of 255%s\n%s", choice.name.c_str(), choice.ms,
      choice.fastest, choice.slowest, choice.decibels, choice.largest, same ? ", circled in the viewport" : "",
      choice.samples > 0 ? "Click to use this when the view is still." : "Click to use this while the view moves.");
  if (!ImGui::IsMouseClicked(ImGuiMouseButton_Left)) return;
  if (choice.samples > 0)
    view.samples = choice.samples;
  else
    view.moving_share = view.moving_share == choice.share ? 0 : choice.share;
}

// Plots the choices. `same`: the measurement is of the current view.
void draw_chart(const std::vector<Choice>& choices, ViewState& view, bool same, const ImVec2& size) {
  const announce::Part part("chart");
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("chart", size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, color32(theme().field), px(space::rounding));
  if (choices.empty()) return;
  const ChartAxes axes(choices, at, size);
  axes.draw(list);
  for (const bool samples : {true, false}) {
    std::vector<ImVec2> line;
    for (const Choice& choice : choices)
      if ((choice.samples > 0) == samples) line.push_back(axes.place(choice.ms, choice.decibels));
    std::sort(line.begin(), line.end(), [](const ImVec2& a, const ImVec2& b) { return a.x < b.x; });
    list.AddPolyline(line.data(), static_cast<int>(line.size()),
                     color32(samples ? theme().accent_text : theme().muted, 0.6F), 0, px(2));
  }
  // The point nearest to the pointer, within 10 pixels.
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const bool over = ImGui::IsItemHovered();
  const Choice* nearest = nullptr;
  float least = px(10);
  for (const Choice& choice : choices) {
    const ImVec2 p = axes.place(choice.ms, choice.decibels);
    const float away = std::hypot(mouse.x - p.x, mouse.y - p.y);
    if (!over || away >= least) continue;
    least = away;
    nearest = &choice;
  }
  for (const Choice& choice : choices) {
    const bool now =
        choice.samples > 0 ? choice.samples == view.samples : std::abs(choice.share - view.moving_share) < 0.01;
    const bool hot = nearest == &choice;
    draw_point(choice, axes, hot || now, now, at.x + size.x, list);
    if (hot) point_at(choice, view, same);
  }
}

void draw_effects(const FrameReport& report) {
  if (!ImGui::BeginTable("effects", 3, ImGuiTableFlags_SizingFixedFit)) return;
  for (const PlannedPass& pass : report.passes) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::PushStyleColor(ImGuiCol_Text, color(pass.runs ? theme().text : theme().muted));
    ImGui::TextUnformatted(fmt::format("{}  {}", pass.runs ? icons::check : icons::minus, pass.name).c_str());
    ImGui::TableNextColumn();
    if (const auto found = report.times.pass_ms.find(pass.name); found != report.times.pass_ms.end())
      ImGui::Text("%.1f ms", found->second);
    else
      ImGui::TextUnformatted(pass.runs ? "runs" : "skipped");
    ImGui::PopStyleColor();
    ImGui::TableNextColumn();
    ImGui::TextDisabled("%s", pass.why.c_str());
  }
  ImGui::EndTable();
}

}  // namespace

void draw_costs(Jobs& jobs, ViewState& view, const Snapshot& now, const FrameReport& report, bool& each_pass) {
  const announce::Part part("cost");
  ImGui::BeginDisabled(jobs.worker.busy() || now.scene.roots.empty());
  const bool measures =
      jobs.costs ? ui::button("Measure again##measure") : ui::primary_button("Measure this view##measure");
  ImGui::EndDisabled();
  if (measures) jobs.measure_costs(view, now.scene);
  ui::tip("Measure this view", "", "Renders each setting five times and compares it with 64 samples per pixel.");
  ImGui::SameLine(0, px(space::section));
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Samples per pixel");
  ImGui::SameLine();
  int index = view.samples == 1 ? 0 : view.samples == 4 ? 1 : view.samples == 16 ? 2 : -1;
  if (ui::choice("samples", index, {"1", "4", "16"})) view.samples = index == 0 ? 1 : index == 1 ? 4 : 16;
  ImGui::SameLine(0, px(space::section));
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("Frames per second while moving");
  ImGui::SameLine();
  int rate = view.target_rate == 10 ? 0 : view.target_rate == 17 ? 1 : view.target_rate == 30 ? 2 : 3;
  if (ui::choice("rate", rate, {"10", "17", "30", "60"}))
    view.target_rate = rate == 0 ? 10 : rate == 1 ? 17 : rate == 2 ? 30 : 60;
  ui::flow(px(140));
  ui::toggle("Time each pass", each_pass);
  ui::tip("Time each pass", "", "Waits for the GPU after each pass. Frames take longer.");
  ImGui::TextDisabled(
      "%s", fmt::format("{:.1f} ms per frame, {:.0f} % of the resolution, {:.0f} frames per second while moving; "
                        "{:.1f} MB on the GPU, {:.1f} MB of history. {}",
                        report.times.frame_ms, report.scale * 100, report.frames_per_second,
                        static_cast<double>(report.gpu_bytes) / 1e6, static_cast<double>(now.history_bytes) / 1e6,
                        report.device)
                .c_str());
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float chart = jobs.costs ? std::min(room.x * 0.5F, px(640)) : 0;
  if (jobs.costs) {
    const bool same = jobs.costs->view.camera == view.camera &&
                      std::abs(jobs.costs->view.width * 1.0 / jobs.costs->view.height - view.aspect()) < 0.01 &&
                      jobs.costs->roots == now.scene.roots;
    const bool smaller = jobs.costs->view.width < view.width;
    ImGui::BeginGroup();
    draw_chart(choices_of(*jobs.costs), view, same,
               {chart, std::max(px(120), room.y - (same && !smaller ? 0 : ImGui::GetTextLineHeightWithSpacing()))});
    if (!same)
      ImGui::TextDisabled("Measured for an earlier view or scene. Measure again for the current one.");
    else if (smaller)
      ImGui::TextDisabled("Measured at %d×%d pixels, since the reference has 64 samples per pixel.",
                          jobs.costs->view.width, jobs.costs->view.height);
    ImGui::EndGroup();
    ImGui::SameLine(0, px(space::section));
  }
  ImGui::BeginChild("effects");
  draw_effects(report);
  ImGui::EndChild();
}

}  // namespace rebake
