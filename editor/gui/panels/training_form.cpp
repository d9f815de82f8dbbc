#include "editor/gui/panels/training_form.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "editor/actions/describe_action.h"
#include "editor/gui/ui/announce.h"
#include "editor/gui/ui/icons.h"
#include "editor/gui/ui/widgets.h"
#include "mesh_ops/base/error.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

const std::set<std::string> main_fields{"photographs", "out", "kind", "minutes", "side"};

std::vector<FieldInfo> fields_of_training(bool main) {
  std::vector<FieldInfo> fields = action_type<TrainAction>().fields();
  std::erase_if(fields, [&](const FieldInfo& field) { return main_fields.contains(field.name) != main; });
  return fields;
}

// The PSNR of the training pixels over the steps.
void draw_curve(const std::vector<std::array<double, 3>>& rows) {
  std::vector<float> psnr;
  for (const std::array<double, 3>& row : rows) psnr.push_back(static_cast<float>(row[2]));
  if (psnr.size() < 2) return;
  const auto [low, high] = std::minmax_element(psnr.begin(), psnr.end());
  ImGui::PlotLines("##curve", psnr.data(), static_cast<int>(psnr.size()), 0,
                   fmt::format("{:.1f} dB on training pixels", psnr.back()).c_str(), *low - 1, *high + 1,
                   {ImGui::GetContentRegionAvail().x, px(90)});
  announce::item("curve");
}

}  // namespace

// Sets the output folder, unless the user has typed one, to a new folder beside the photographs.
void TrainingForm::suggest(const fs::path& photographs) {
  if (inputs_.values().value("out", suggested_) != suggested_) return;
  std::error_code gone;
  suggested_ = photographs.string() + "-trained";
  for (int number = 2; fs::exists(suggested_, gone); ++number)
    suggested_ = fmt::format("{}-trained-{}", photographs.string(), number);
  inputs_.set("out", suggested_);
}

// Takes the answer of the file dialog, and suggests a new output folder for it and after a training.
void TrainingForm::take_photographs(EditorContext& editor) {
  const std::string chosen = std::exchange(editor.dialogs.photographs, {});
  if (!chosen.empty()) inputs_.set("photographs", chosen);
  const bool runs = editor.training.state() != TrainingJob::State::none, ended = std::exchange(ran_, runs) && !runs;
  if (chosen.empty() && !ended) return;
  const fs::path path(inputs_.values().value("photographs", ""));
  std::error_code gone;
  if (!path.empty()) suggest(fs::is_directory(path, gone) ? path : path.parent_path());
}

void TrainingForm::draw_fields(EditorContext& editor) {
  ui::muted("Makes a scene from photographs with known cameras. It appears and sharpens in view while it trains.");
  if (ui::button("Photographs...##choose")) editor.dialogs.path = FileDialogPurpose::photographs;
  ui::tip("Photographs...", "", "Chooses the camera file or the folder of a capture.");
  ImGui::SameLine();
  options_.draw(editor, "Fields, held-out photographs, cameras and exposure.", fields_of_training(false), inputs_,
                problem_);
  const std::vector<FieldInfo> fields = fields_of_training(true);
  inputs_.draw(editor, fields, problem_);
  const bool said = std::any_of(fields.begin(), fields.end(), [&](const FieldInfo& field) {
    return problem_.find("\"" + field.name + "\"") != std::string::npos;
  });
  if (!problem_.empty() && !said) ui::wrapped(problem_, theme().danger);
  const std::string out = inputs_.values().value("out", "");
  std::error_code gone;
  const bool replaces = fs::is_directory(out, gone) && !fs::is_empty(out, gone), asks = replaces && replacing_ == out;
  if (asks)
    ui::wrapped(out + " already exists. Press the button again to replace it when the training is done.",
                theme().danger);
  if (ui::primary_button(asks ? "Replace##train" : "Train##train")) {
    if (replaces && !asks)
      replacing_ = out;
    else
      start(editor);
  }
  ImGui::SameLine();
  if (ui::button("Close##close")) editor.dialogs.training = false;
}

void TrainingForm::start(EditorContext& editor) {
  replacing_.clear();
  problem_.clear();
  try {
    editor.training.start(read_action<TrainAction>(inputs_.values(), editor.scene()));
  } catch (const Error& error) {
    problem_ = error.what();
  }
}

void TrainingForm::draw_progress(EditorContext& editor) {
  TrainingJob& job = editor.training;
  using State = TrainingJob::State;
  const Worker::Status status = job.status();
  const bool paused = job.state() == State::paused;
  const std::string what = paused ? "paused" : job.state() == State::pausing ? "writing the checkpoint" : status.what;
  ui::muted(job.action().photographs);
  ImGui::ProgressBar(static_cast<float>(status.share), {-1, px(8)}, "");
  ImGui::TextWrapped("%s", what.c_str());
  announce::item("progress: " + what);
  draw_curve(job.progress_rows());
  if (paused) {
    if (ui::primary_button("Continue##continue")) job.resume();
  } else {
    ImGui::BeginDisabled(job.state() == State::pausing);
    if (ui::button("Pause##pause")) job.pause();
    ui::tip("Pause", "",
            "Writes a checkpoint and stops. Training to the same folder continues from there, also after a restart.");
    ImGui::EndDisabled();
  }
  ImGui::SameLine();
  ImGui::BeginDisabled(job.state() == State::keeping || job.state() == State::pausing || !job.node());
  if (ui::button("Stop and keep##keep")) job.keep();
  ui::tip("Stop and keep", "", "Writes the scene as it is now and opens it. Available once there is something to see.");
  ImGui::EndDisabled();
  if (!paused) return;
  ImGui::SameLine();
  if (ui::button("Close##close")) job.close();
  ui::tip("Close", "", "Removes the scene from view. The checkpoint stays: the same training continues from there.");
}

void TrainingForm::draw(EditorContext& editor, float right) {
  take_photographs(editor);
  if (!editor.dialogs.training) {
    options_.leave();
    return;
  }
  bool open = true;
  ImGui::SetNextWindowPos({right - px(10), px(40)}, ImGuiCond_Appearing, {1, 0});
  ImGui::SetNextWindowSizeConstraints({px(440), 0}, {px(440), ImGui::GetIO().DisplaySize.y - px(60)});
  ImGui::Begin("Train from photographs###training", &open,
               ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_AlwaysAutoResize);
  {
    const announce::Part part("training");
    if (editor.training.state() == TrainingJob::State::none)
      draw_fields(editor);
    else
      draw_progress(editor);
  }
  ImGui::End();
  if (!open) editor.dialogs.training = false;
}

}  // namespace rebake
