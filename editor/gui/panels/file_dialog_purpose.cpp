#include "editor/gui/panels/file_dialog_purpose.h"

#include <fmt/format.h>

#include "editor/gui/panels/folder_list.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/formats.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr FileDialogText questions[] = {
    {FileDialogPurpose::open, "Open", "A scene's folder, a textured mesh, or a project (.rebake).", "Open", "",
     ".rebake"},
    {FileDialogPurpose::save_project, "Save project", "A file with all steps of the history.", "Save", ".rebake"},
    {FileDialogPurpose::save_scene, "Save Rebake scene", "A folder with all nodes, without the history.", "Save", ""},
    {FileDialogPurpose::export_folder, "Export", "A MobileNeRF folder, or a Rebake scene if one folder cannot hold it.",
     "Export", ""},
    {FileDialogPurpose::web_page, "Publish web page", "One file that shows the scene in any browser, without a server.",
     "Publish", ".html"},
    {FileDialogPurpose::screenshot, "Screenshot", "A picture of the scene, without grid and handles.", "Write", ".png",
     ".png .jpg .jpeg .webp .exr"},
    {FileDialogPurpose::turntable, "Turntable", "A folder for pictures of a full orbit: 000.png, 001.png, …", "Write",
     ""},
    {FileDialogPurpose::camera_path, "Camera path", "A folder for pictures along a path through the stored views.",
     "Write", ""},
    {FileDialogPurpose::save_script, "Save as script", "A script file with one edit per line.", "Save", ".jsonl"},
    {FileDialogPurpose::run_script, "Run script", "A script file with one edit or action per line.", "Run", ".jsonl"},
    {FileDialogPurpose::light_picture, "Environment map", "An equirectangular picture, twice as wide as high.", "Use",
     "", ".exr .hdr .png .jpg .jpeg .tif .tiff .webp"},
    {FileDialogPurpose::light_model, "Light model", "A model that training or rebake light train has written.", "Use",
     "", ".light"},
    {FileDialogPurpose::photographs, "Photographs", "A capture's folder, or its camera file.", "Use", "", ".json .npy"},
};

}  // namespace

const FileDialogText& text_of(FileDialogPurpose kind) {
  for (const FileDialogText& question : questions)
    if (question.kind == kind) return question;
  return questions[0];
}

std::string listed_endings(FileDialogPurpose kind) {
  std::string endings = text_of(kind).listed;
  if (kind == FileDialogPurpose::open)
    for (const Format& format : formats())
      if (format.read != nullptr && !format.is_folder) endings += fmt::format(" {}", format.marker);
  return endings;
}

bool reads(FileDialogPurpose kind) {
  return kind == FileDialogPurpose::open || kind == FileDialogPurpose::run_script ||
         kind == FileDialogPurpose::light_picture || kind == FileDialogPurpose::light_model ||
         kind == FileDialogPurpose::photographs;
}

bool makes_film(FileDialogPurpose kind) {
  return kind == FileDialogPurpose::turntable || kind == FileDialogPurpose::camera_path;
}

std::string problem_with(const fs::path& path, FileDialogPurpose kind) {
  const bool writes = !reads(kind);
  std::error_code error;
  if (path.empty()) return "Type or choose a path.";
  const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (writes && !fs::is_directory(parent, error)) return "Folder not found: " + parent.string() + ".";
  if (!writes && !fs::exists(path, error)) return "File not found: " + path.string() + ".";
  if (kind == FileDialogPurpose::light_picture)
    return fs::is_regular_file(path, error) ? "" : path.filename().string() + " is not a file. Choose a picture file.";
  if (kind == FileDialogPurpose::light_model)
    return fs::is_regular_file(path, error) ? "" : path.filename().string() + " is not a file. Choose a model.";
  if (kind == FileDialogPurpose::photographs)
    return camera_format_at(path) != nullptr ? "" : path.filename().string() + " has no cameras in a known format.";
  if (!writes && fs::is_directory(path, error) && !holds_scene(path))
    return path.filename().string() + " is not a scene in a known format.";
  return "";
}

}  // namespace rebake
