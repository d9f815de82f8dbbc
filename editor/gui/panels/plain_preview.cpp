#include "editor/gui/panels/plain_preview.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "editor/actions/lit.h"
#include "editor/actions/plain_scene.h"
#include "editor/edits/support.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/fonts.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/error.h"
#include "render/compare.h"

namespace rebake {

// Results of the worker's jobs. The window reads them once the first job is done.
struct PlainPreview::Measured {
  Scene scene;
  View view;
  std::optional<PlainSceneBuilder> parts;
  bool exact = false;  ///< one decoder reproduces all texels, so nothing is fitted
  std::vector<NodeRef> nodes;
  struct Row {
    FuseTrial trial;
    std::optional<Image> picture;
    double psnr_db = 0, frame_ms = 0;  ///< PSNR of `picture` against `reference`; median frame time
  };
  std::vector<Row> rows;
  std::size_t chosen = 0;
  Image reference;
  double reference_ms = 0;
};

namespace {

constexpr const char* failed = "The comparison was cancelled or failed. See the message log.";
constexpr int timed_frames = 5;  // frames per row; the median is shown

// Fewer texels and training steps than an export, for a measurement of a few seconds on any scene.
FuseOptions quick_options(const Scene& scene) {
  FuseOptions options;
  options.layout = common_layout(scene);
  options.sample = 4096;
  options.training.steps = 2000;
  return options;
}

}  // namespace

void PlainPreview::begin(const ViewState& view, Jobs& jobs, std::vector<NodeRef> nodes) {
  open_ = true;
  nodes_ = std::move(nodes);
  measured_ = nullptr;
  exact_.reset();
  plain_.reset();
  problem_.clear();
  auto measured = std::make_shared<Measured>();
  constexpr double widest = 520;
  const double scale = std::min(1.0, widest / std::max(view.width, view.height));
  measured->view = {view.camera, std::max(1, static_cast<int>(view.width * scale)),
                    std::max(1, static_cast<int>(view.height * scale)), 4};
  measured->nodes = nodes_;
  wanted_ = std::make_shared<bool>(true);
  working_ = true;
  jobs.worker.start(
      "comparing plain folders",
      [measured](Session& session) {
        measured->scene = with_only(session.scene(), measured->nodes);
        measured->scene.background = Color::Ones();
        const FuseOptions options = quick_options(measured->scene);
        const Lighting lighting = lit(session.scene(), session.progress);
        measured->parts.emplace(measured->scene, lighting, options.layout, session.progress);
        Renderer& renderer = session.renderer();
        measured->reference = renderer.render(measured->scene, measured->view, {}, &lighting);
        measured->reference_ms = median_frame_ms(renderer, measured->scene, measured->view, timed_frames, &lighting);
        measured->exact = measured->parts->composition.exact();
        session.drop_renderer();  // frees a second copy of the scene on the GPU
        if (measured->exact) return;
        const FusePlan& plan = measured->parts->make_plan(options, session.progress);
        for (const FuseCandidate& candidate : plan.candidates) measured->rows.push_back({candidate.trial, {}, 0, 0});
        measured->chosen = plan.chosen;
      },
      [this, &jobs, measured, wanted = wanted_] {
        if (!*wanted) return;
        working_ = false;
        measured_ = measured;
        exact_.emplace(measured->reference);
        if (!measured->exact) show(jobs, measured->chosen);
      },
      [this, wanted = wanted_] {
        if (!*wanted) return;
        working_ = false;
        problem_ = failed;
      });
}

// Fits texels with one Gauss–Newton iteration: quick, and an export only refines the result.
void PlainPreview::show(Jobs& jobs, std::size_t row) {
  row_ = row;
  const auto measured = measured_;
  if (measured->rows[row].picture) {
    plain_.emplace(*measured->rows[row].picture);
    shown_ = row;
    return;
  }
  // The window reads `rows` while the job runs, so the job fills a copy.
  auto seen = std::make_shared<Measured::Row>(measured->rows[row]);
  working_ = true;
  jobs.worker.start(
      "rendering the plain folder",
      [measured, seen, row](Session& session) {
        FuseOptions options = quick_options(measured->scene);
        options.iterations = 1;
        const Scene plain = measured->parts->scene(measured->scene, row, options, session.progress);
        Renderer& renderer = session.renderer();
        seen->picture = renderer.render(plain, measured->view);
        seen->psnr_db = std::min(100.0, compare(*seen->picture, measured->reference, 2).psnr_db);
        seen->frame_ms = median_frame_ms(renderer, plain, measured->view, timed_frames);
        session.drop_renderer();
      },
      [this, measured, seen, row, wanted = wanted_] {
        if (!*wanted) return;
        working_ = false;
        measured->rows[row] = *seen;
        if (row_ != row) return;
        plain_.emplace(*seen->picture);
        shown_ = row;
      },
      [this, wanted = wanted_] {
        if (!*wanted) return;
        working_ = false;
        problem_ = failed;
      });
}

void PlainPreview::draw_table(Jobs& jobs) {
  if (!ImGui::BeginTable("ways", 6, ImGuiTableFlags_SizingStretchProp | ImGuiTableFlags_BordersInnerH)) return;
  ImGui::TableSetupColumn("decoder", 0, 3.2F);
  ImGui::TableSetupColumn("width");
  ImGui::TableSetupColumn("texels dB", 0, 1.4F);
  ImGui::TableSetupColumn("picture dB", 0, 1.2F);
  ImGui::TableSetupColumn("ms per frame", 0, 1.6F);
  ImGui::TableSetupColumn("seconds", 0, 1.2F);
  ImGui::TableHeadersRow();
  for (std::size_t k = 0; k < measured_->rows.size(); ++k) {
    const Measured::Row& row = measured_->rows[k];
    ImGui::PushID(static_cast<int>(k));
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    const std::string name = notation_of(row.trial.way);
    if (ImGui::Selectable(name.c_str(), row_ == k, ImGuiSelectableFlags_SpanAllColumns) && row_ != k) show(jobs, k);
    announce::item(fmt::format("way {}", k));
    // No tooltip on the selected row: it would only cover the others.
    if (row_ != k)
      ui::tip(name, "", k == measured_->chosen ? "Default of an export. Click to compare." : "Click to compare.");
    ImGui::TableNextColumn();
    ImGui::Text("%d", row.trial.width);
    ImGui::TableNextColumn();
    ImGui::Text("%.1f", row.trial.psnr_db);
    ImGui::TableNextColumn();
    row.picture ? ImGui::Text("%.1f", row.psnr_db) : ImGui::TextDisabled("–");
    ImGui::TableNextColumn();
    row.picture ? ImGui::Text("%.1f", row.frame_ms) : ImGui::TextDisabled("–");
    ImGui::TableNextColumn();
    // An export trains four times as long.
    ImGui::Text("%.0f", std::ceil(4 * row.trial.seconds + row.trial.fit_seconds));
    ImGui::PopID();
  }
  ImGui::EndTable();
}

void PlainPreview::draw_wipe(float width) {
  const float height = width * static_cast<float>(measured_->view.height) / static_cast<float>(measured_->view.width);
  const ImVec2 at = ImGui::GetCursorScreenPos(), end{at.x + width, at.y + height};
  ImGui::InvisibleButton("wipe", {width, height});
  announce::item("wipe");
  if (ImGui::IsItemActive()) split_ = std::clamp((ImGui::GetIO().MousePos.x - at.x) / width, 0.0F, 1.0F);
  if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const auto picture = [](const PictureTexture& texture) {
    return reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture.name()));
  };
  list.AddImage(picture(*exact_), at, end);
  const float x = at.x + split_ * width;
  if (plain_) list.AddImage(picture(*plain_), {x, at.y}, end, {split_, 0}, {1, 1});
  list.AddLine({x, at.y}, {x, end.y}, color32(theme().accent), px(2));
  list.AddCircleFilled({x, (at.y + end.y) / 2}, px(7), color32(theme().accent));
  const auto caption = [&](const std::string& text, bool right) {
    const ImVec2 size = ImGui::CalcTextSize(text.c_str()), pad{px(6), px(3)};
    const ImVec2 corner{right ? end.x - size.x - 3 * pad.x : at.x + pad.x, at.y + px(6)};
    list.AddRectFilled(corner, {corner.x + size.x + 2 * pad.x, corner.y + size.y + 2 * pad.y},
                       color32(theme().panel, 0.85F), px(space::rounding));
    list.AddText({corner.x + pad.x, corner.y + pad.y}, color32(theme().text), text.c_str());
  };
  caption("original", false);
  caption(plain_ ? fmt::format("plain folder: {:.1f} dB", measured_->rows[shown_].psnr_db) : "plain folder ...", true);
}

bool PlainPreview::leave(Jobs& jobs) {
  if (!open_) return false;
  open_ = false;
  *wanted_ = false;
  if (std::exchange(working_, false)) jobs.worker.cancel();
  measured_ = nullptr;
  exact_.reset();
  plain_.reset();
  return true;
}

std::optional<PlainPreview::Choice> PlainPreview::draw(Jobs& jobs) {
  if (!open_ && !ImGui::IsPopupOpen("###plain")) return std::nullopt;
  if (open_ && !ImGui::IsPopupOpen("###plain")) ImGui::OpenPopup("###plain");
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const ImVec2 size{std::min(px(620), screen.x - px(20)), std::min(px(760), screen.y - px(20))};
  ImGui::SetNextWindowSize(size);
  ImGui::SetNextWindowPos({screen.x / 2, screen.y / 2}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {px(18), px(16)});
  const bool begun = ImGui::BeginPopupModal("One plain folder###plain", nullptr,
                                            ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize |
                                                ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  if (!begun) return std::nullopt;
  if (!open_) {
    ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
    return std::nullopt;
  }
  const announce::Part part("plain");
  ImGui::PushFont(fonts().heading);
  ImGui::TextUnformatted("One plain folder");
  ImGui::PopFont();
  std::optional<Choice> chosen;
  const float buttons = ImGui::GetFrameHeightWithSpacing() + px(8);
  ImGui::BeginChild("content", {0, -buttons});
  if (!problem_.empty()) {
    ui::wrapped(problem_, theme().danger);
  } else if (!measured_) {
    const Worker::Status status = jobs.worker.status();
    ui::muted("Measuring a sample of the texels. This takes a few seconds.");
    ImGui::ProgressBar(static_cast<float>(status.share), {-1, 0}, status.what.c_str());
  } else if (measured_->exact) {
    ui::muted("One decoder represents the scene exactly. No fit is needed.");
    announce::item("exact");
  } else {
    ui::muted("One plain folder approximates the scene. Drag across the picture to compare.");
    const float most = ImGui::GetContentRegionAvail().y -
                       ImGui::GetTextLineHeightWithSpacing() * (static_cast<float>(measured_->rows.size()) + 4);
    const float aspect = static_cast<float>(measured_->view.width) / static_cast<float>(measured_->view.height);
    draw_wipe(std::clamp(most * aspect, px(160), ImGui::GetContentRegionAvail().x));
    draw_table(jobs);
    ui::muted(
        fmt::format("Texels: PSNR of sampled texels. Picture: PSNR of this picture, in which texels are blended. The "
                    "original takes "
                    "{:.1f} ms per frame.",
                    measured_->reference_ms));
  }
  ImGui::EndChild();
  const float width = px(120);
  ImGui::SetCursorPosX(ImGui::GetWindowContentRegionMax().x - 2 * width - ImGui::GetStyle().ItemSpacing.x);
  const bool cancelled = ui::button("Cancel##cancel", {width, 0});
  ImGui::SameLine();
  const bool can = measured_ && !measured_->exact;
  ImGui::BeginDisabled(!can);
  if (ui::primary_button("Use this##use", {width, 0})) {
    const FuseTrial& trial = measured_->rows[row_].trial;
    chosen = {trial.way, trial.width};
  }
  ImGui::EndDisabled();
  if (cancelled || chosen) leave(jobs);
  ImGui::EndPopup();
  return chosen;
}

}  // namespace rebake
