#include "editor/gui/state/commands.h"

#include <algorithm>
#include <stdexcept>

#include "editor/edits/deform/bend.h"
#include "editor/edits/deform/taper.h"
#include "editor/edits/deform/twist.h"
#include "editor/edits/nodes/align.h"
#include "editor/edits/nodes/drop.h"
#include "editor/edits/nodes/duplicate.h"
#include "editor/edits/nodes/ground.h"
#include "editor/edits/nodes/group.h"
#include "editor/edits/nodes/hide.h"
#include "editor/edits/nodes/remove.h"
#include "editor/edits/nodes/show.h"
#include "editor/edits/nodes/view.h"
#include "editor/edits/select/grow.h"
#include "editor/edits/select/select.h"
#include "editor/edits/select/select_connected.h"
#include "editor/edits/select/shrink.h"
#include "editor/edits/shape/delete_and_fill.h"
#include "editor/edits/shape/delete_selected.h"
#include "editor/edits/shape/refit.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/support.h"
#include "editor/gui/state/navigation.h"

namespace rebake {

namespace {

bool always(const EditorContext&) { return true; }
bool has_scene(const EditorContext& editor) { return !editor.scene().roots.empty(); }
bool has_something_to_see(const EditorContext& editor) { return has_scene(editor) || editor.beside; }
bool has_steps(const EditorContext& editor) { return has_scene(editor) || !editor.now->done.empty(); }
bool has_views(const EditorContext& editor) { return editor.scene().views.size() > 1; }
bool has_active(const EditorContext& editor) { return !editor.active.empty(); }
bool has_selection(const EditorContext& editor) { return editor.selected_triangles() > 0; }
bool has_either(const EditorContext& editor) { return has_active(editor) || has_selection(editor); }

template <ToolKind kind>
void take(EditorContext& editor) {
  editor.tools.kind = kind;
}
// In the Blender keymap, the key of a tool also begins a drag, after which the previous tool returns.
template <ToolKind kind>
void grab(EditorContext& editor) {
  if (editor.settings.blender_keys && has_either(editor)) {
    editor.tools.before = editor.tools.kind;
    editor.tools.pending_drag = kind;
  }
  editor.tools.kind = kind;
}
template <FileDialogPurpose question>
void ask(EditorContext& editor) {
  editor.dialogs.path = question;
}

void select(EditorContext& editor, bool all, bool none, bool invert) {
  Select edit;
  edit.all = all;
  edit.none = none;
  edit.invert = invert;
  editor.edit_scope(edit);
}

// One edit per picked node.
template <class T>
std::vector<Edit> for_each_active(const EditorContext& editor) {
  std::vector<Edit> list;
  for (const NodeId id : editor.active_tops()) {
    T edit;
    edit.node = NodeRef{id};
    list.emplace_back(edit);
  }
  return list;
}

template <class T>
void each_active(EditorContext& editor) {
  editor.edits(for_each_active<T>(editor));
}

void drop(EditorContext& editor) { editor.edits_if_changing(for_each_active<Drop>(editor)); }

// Sets the ground plane to the scene's lowest point, or fits it to the selection.
template <bool GroundEdit::*from>
void set_ground(EditorContext& editor) {
  GroundEdit edit;
  edit.*from = true;
  if (edit.selection) edit.nodes = editor.selected_nodes_if_picked();
  editor.edit(edit);
}

void show_discarded(EditorContext& editor) {
  editor.project.recoverable = discarded_work();
  if (editor.project.recoverable.empty()) editor.messages.say("The trash is empty.");
}

// The copies are picked; in the Blender keymap, a drag moves them at once.
void duplicate(EditorContext& editor) {
  editor.edits(for_each_active<Duplicate>(editor), [&editor] {
    if (editor.settings.blender_keys) grab<ToolKind::move>(editor);
  });
}

bool selects_triangles(ToolKind tool) {
  return tool == ToolKind::rectangle || tool == ToolKind::lasso || tool == ToolKind::polygon ||
         tool == ToolKind::brush || tool == ToolKind::flood || tool == ToolKind::volume || tool == ToolKind::erase;
}

void remove_and_fill(EditorContext& editor) { editor.edit_scope(DeleteAndFill{}); }

void remove(EditorContext& editor) {
  if (has_selection(editor) && !editor.scope(true).empty())
    editor.edit_scope(DeleteSelected{});
  else if (selects_triangles(editor.tools.kind) || editor.active.empty())
    editor.messages.say("Nothing is selected " + editor.scope_words() +
                        ". With the Pick or Move tool, Delete removes the picked nodes.");
  else
    each_active<Remove>(editor);
}

void show_all(EditorContext& editor) {
  std::vector<Edit> list;
  for (const PlacedNode& placed : placed_nodes(editor.scene()))
    if (!placed.node->visible) {
      Show show;
      show.node = NodeRef{placed.node->id};
      list.emplace_back(show);
    }
  editor.edits(list);
}

void separate(EditorContext& editor) {
  std::vector<Edit> list;
  for (const NodeId node : editor.nodes_in_scope(true)) {
    Separate edit;
    edit.node = NodeRef{node};
    list.emplace_back(edit);
  }
  editor.edits(list);
}

bool has_several(const EditorContext& editor) { return editor.active.size() > 1; }
void align(EditorContext& editor) { editor.dialogs.form = Align::op; }
void refit(EditorContext& editor) { editor.dialogs.form = Refit::op; }

void group(EditorContext& editor) {
  Group edit;
  for (const NodeId id : editor.active_tops()) edit.nodes.push_back(NodeRef{id});
  editor.edit(edit);
}

void save(EditorContext& editor) {
  if (editor.project.path.empty())
    editor.dialogs.path = FileDialogPurpose::save_project;
  else
    editor.project.save(editor.project.path);
}

void brush_by(EditorContext& editor, double factor) {
  editor.settings.brush_radius = std::clamp(editor.settings.brush_radius * factor, 1.0, 500.0);
}

template <int axis, int sign>
void look_along(EditorContext& editor) {
  Vec3 direction(0, 0, 0);
  direction[axis] = sign;
  editor.view.camera = along_axis(editor.view.camera, direction);
}

void toggle_projection(EditorContext& editor) { editor.view.camera = toggled_projection(editor.view.camera); }

void toggle_cut(EditorContext& editor) {
  // The cutting plane starts at the camera's target.
  editor.view.cut = editor.view.cut > 0 ? 0 : (editor.view.camera.eye - editor.view.camera.target).norm();
}

template <Guides::Inspect inspect>
void look_at(EditorContext& editor) {
  editor.view.inspect = inspect;
}
template <Guides::Inspect inspect>
bool is_inspecting(const EditorContext& editor) {
  return editor.view.inspect == inspect;
}

void undo(EditorContext& editor) { editor.undo(); }
void redo(EditorContext& editor) { editor.redo(); }

template <BottomTab tab>
void toggle_tab(EditorContext& editor) {
  editor.settings.bottom_open = !(editor.settings.bottom_open && editor.settings.bottom_tab == tab);
  editor.settings.bottom_tab = tab;
}
template <BottomTab tab>
bool shows_tab(const EditorContext& editor) {
  return editor.settings.bottom_open && editor.settings.bottom_tab == tab;
}

template <ColorTheme looks>
void use_color_theme(EditorContext& editor) {
  editor.settings.looks = looks;
}
template <ColorTheme looks>
bool has_color_theme(const EditorContext& editor) {
  return editor.settings.looks == looks;
}
void text_by(EditorContext& editor, double factor) {
  editor.settings.text_scale = std::clamp(editor.settings.text_scale * factor, 0.6, 3.0);
}

void next_channel(EditorContext& editor) {
  editor.view.channel = editor.view.inspect == Guides::Inspect::channel ? (editor.view.channel + 1) % 8 : 0;
  editor.view.inspect = Guides::Inspect::channel;
}

}  // namespace

void store_view(ToolContext& editor, const std::string& name) {
  StoreView edit;
  edit.name = name;
  edit.camera = editor.view.camera;
  edit.camera.near_plane = edit.camera.far_plane = 0;  // 0: fitted to the scene when the view is used
  editor.edits_from(StoreView::op, [edit](const Scene& scene) {
    StoreView named = edit;
    for (int number = 1; named.name.empty(); ++number)
      if (std::string free = "view " + std::to_string(number); !scene.views.contains(free)) named.name = free;
    return std::vector<Edit>{named};
  });
}

void run_command(EditorContext& editor, const Command& command) {
  const std::string title = command.title;
  if (command.needs_rest && editor.jobs.worker.changes())
    editor.messages.say(title + ": another step is still running or waiting. Try again when it has finished.");
  else if (!command.enabled(editor))
    editor.messages.say(title + ": not available now. Open a scene, pick nodes or select triangles first.");
  else
    command.run(editor);
}

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      {"File", "Open...", "Ctrl+O", "Ctrl+O", "Opens a scene, a textured mesh or a project.", always,
       ask<FileDialogPurpose::open>},
      {"File", "Save project", "Ctrl+S", "Ctrl+S", "Saves every step to a .rebake file.", has_steps, save},
      {"File", "Save project as...", "Ctrl+Shift+S", "Ctrl+Shift+S", "Saves every step to another file.", has_steps,
       ask<FileDialogPurpose::save_project>},
      {"File", "Save Rebake scene...", "", "", "Writes the current scene to a folder, without its history.", has_scene,
       ask<FileDialogPurpose::save_scene>},
      {"File", "Export...", "Ctrl+E", "Ctrl+E",
       "Writes a MobileNeRF folder, or a Rebake scene if one folder cannot hold it.", has_scene,
       ask<FileDialogPurpose::export_folder>},
      {"File", "Publish web page...", "", "",
       "Writes a page that shows the scene from this view, and opens it in the browser.", has_scene,
       ask<FileDialogPurpose::web_page>},
      {"File", "Screenshot...", "F12", "F12", "Saves this view as a picture.", has_scene,
       ask<FileDialogPurpose::screenshot>},
      {"File", "Turntable...", "", "", "Renders pictures or a video of a full orbit around the scene.", has_scene,
       ask<FileDialogPurpose::turntable>},
      {"File", "Camera path...", "", "", "Renders pictures or a video along a path through the stored views.",
       has_views, ask<FileDialogPurpose::camera_path>},
      {"File", "Save as script...", "", "", "Saves the steps as a script that can be replayed on other scenes.",
       has_scene, ask<FileDialogPurpose::save_script>},
      {"File", "Run script...", "", "", "Runs a script on this scene.", always, ask<FileDialogPurpose::run_script>},
      {"File", "Train from photographs...", "", "", "Makes a scene from photographs with known cameras.", always,
       [](EditorContext& editor) { editor.dialogs.training = true; }},
      {"File", "Discarded work...", "", "", "Lists unsaved work that was discarded in the last 30 days.", always,
       show_discarded},
      {"File", "Quit", "Ctrl+Q", "Ctrl+Q", "Closes the window. Asks first if there is unsaved work.", always,
       [](EditorContext& editor) { editor.dialogs.quitting = true; }},
      {"Edit", "Undo", "Ctrl+Z", "Ctrl+Z", "Undoes the last step.",
       [](const EditorContext& editor) { return !editor.now->done.empty(); }, undo, nullptr, true},
      {"Edit", "Redo", "Ctrl+Shift+Z Ctrl+Y", "Ctrl+Shift+Z", "Redoes the last undone step.",
       [](const EditorContext& editor) { return !editor.now->undone.empty(); }, redo, nullptr, true},
      {"Edit", "Command palette...", "Ctrl+P", "F3 Ctrl+P", "Finds any command or edit by name.", always,
       [](EditorContext& editor) { editor.dialogs.palette = true; }},
      {"Edit", "Delete", "Delete", "X Delete",
       "Deletes the selected triangles, or the picked nodes if none are selected.", has_either, remove, nullptr, false,
       true},
      {"Edit", "Delete and fill holes", "Ctrl+Delete", "Ctrl+Delete",
       "Deletes the selected triangles and closes the holes that they leave.", has_selection, remove_and_fill, nullptr,
       false, true},
      {"Edit", "Remove picked nodes", "Shift+Delete", "Shift+Delete",
       "Removes the picked nodes, even if triangles are selected.", has_active, each_active<Remove>, nullptr, false,
       true},
      {"Edit", "Duplicate", "Ctrl+D", "Shift+D", "Copies the picked nodes and picks the copies.", has_active, duplicate,
       nullptr, false, true},
      {"Edit", "Group", "Ctrl+G", "Ctrl+G", "Puts the picked nodes into a group.", has_active, group, nullptr, false,
       true},
      {"Edit", "Separate", "Ctrl+J", "P", "Moves the selected triangles into a new node.", has_selection, separate,
       nullptr, false, true},
      {"Edit", "Drop to surface", "End", "End",
       "Drops the picked nodes onto the surface below them or the ground plane.", has_active, drop, nullptr, false,
       true},
      {"Edit", "Ground at lowest point", "", "", "Levels the ground plane and moves it to the lowest visible point.",
       has_scene, set_ground<&GroundEdit::foot>, nullptr, false, true},
      {"Edit", "Ground from selection", "", "", "Fits the ground plane to the selected triangles.", has_selection,
       set_ground<&GroundEdit::selection>, nullptr, false, true},
      {"Edit", "Align and distribute...", "", "", "Aligns or distributes the picked nodes along an axis.", has_several,
       align},
      {"Edit", "Refit from photographs...", "", "",
       "Fits the colours of the picked nodes, or of the selected triangles, to photographs.", has_scene, refit},
      {"Edit", "Hide", "H", "H", "Hides the picked nodes. Hidden nodes are not exported.", has_active,
       each_active<Hide>, nullptr, false, true},
      {"Edit", "Show all", "Shift+H", "Alt+H", "Shows all hidden nodes.", has_scene, show_all, nullptr, false, true},
      {"Edit", "Adjust last step", "F9", "F9", "Shows the fields of the last step.",
       [](const EditorContext& editor) { return !editor.now->done.empty(); },
       [](EditorContext& editor) { editor.settings.adjust_open = !editor.settings.adjust_open; },
       [](const EditorContext& editor) { return editor.settings.adjust_open; }},
      {"Select", "All", "Ctrl+A", "A", "Selects all triangles of the picked nodes, or of the scene if none are picked.",
       has_scene, [](EditorContext& editor) { select(editor, true, false, false); }, nullptr, false, true},
      {"Select", "None", "Ctrl+Shift+A", "Alt+A", "Clears the selection.", has_scene,
       [](EditorContext& editor) { select(editor, false, true, false); }, nullptr, false, true},
      {"Select", "Invert", "Ctrl+I", "Ctrl+I", "Inverts the selection.", has_scene,
       [](EditorContext& editor) { select(editor, false, false, true); }, nullptr, false, true},
      {"Select", "Grow", "Ctrl+]", "Ctrl+KP_ADD", "Adds neighbouring triangles to the selection.", has_selection,
       [](EditorContext& editor) { editor.edit_scope(Grow{}); }, nullptr, false, true},
      {"Select", "Shrink", "Ctrl+[", "Ctrl+KP_SUBTRACT", "Removes the outermost triangles from the selection.",
       has_selection, [](EditorContext& editor) { editor.edit_scope(Shrink{}); }, nullptr, false, true},
      {"Select", "Connected", "Ctrl+L", "L", "Selects all triangles connected to the selection.", has_selection,
       [](EditorContext& editor) { editor.edit_scope(SelectConnected{}); }, nullptr, false, true},
      {"Select", "Visible only", "T", "Alt+Z", "Selects only visible triangles. Off: also those behind them.", always,
       [](EditorContext& editor) { editor.tools.visible_only() = !editor.tools.visible_only(); },
       [](const EditorContext& editor) { return editor.tools.visible_only(); }},
      {"Tool", "Pick nodes", "V", "W", "Click a node to pick it. Tools work on the picked nodes.", always,
       take<ToolKind::pick>},
      {"Tool", "Rectangle", "R", "B", "Selects triangles inside a rectangle.", always, take<ToolKind::rectangle>},
      {"Tool", "Lasso", "L", "Ctrl+Shift+L", "Selects triangles inside a freehand outline.", always,
       take<ToolKind::lasso>},
      {"Tool", "Polygon", "P", "Ctrl+Shift+P", "Selects triangles inside a polygon of clicked corners.", always,
       take<ToolKind::polygon>},
      {"Tool", "Brush", "B", "C", "Selects triangles by painting over them.", always, take<ToolKind::brush>},
      {"Tool", "Flood", "O", "O", "Click to select connected triangles of similar colour.", always,
       take<ToolKind::flood>},
      {"Tool", "Volume", "U", "U", "Selects triangles inside a box or sphere.", always, take<ToolKind::volume>},
      {"Tool", "Eraser", "E", "E", "Makes painted texels transparent.", always, take<ToolKind::erase>},
      {"Tool", "Move", "1", "G", "Moves the selected triangles, or the picked nodes if none are selected.", always,
       grab<ToolKind::move>},
      {"Tool", "Rotate", "2", "R", "Rotates the selected triangles, or the picked nodes if none are selected.", always,
       grab<ToolKind::rotate>},
      {"Tool", "Scale", "3", "S", "Scales the selected triangles, or the picked nodes if none are selected.", always,
       grab<ToolKind::scale>},
      {"Tool", "Cage", "C", "Shift+C", "Deforms an object by dragging the points of a cage around it.", always,
       take<ToolKind::cage>},
      {"Tool", "Bend, twist, taper", "N", "Shift+N", "Bends along a spine by dragging its end.", always,
       take<ToolKind::bend>},
      {"Tool", "Handles", "K", "K",
       "Pins and drags handle points. The shape between them deforms as rigidly as possible.", always,
       take<ToolKind::handles>},
      {"Tool", "Ground", "", "", "Sets the ground plane by three clicked points or a height.", always,
       take<ToolKind::ground>},
      {"Tool", "Measure", "", "", "Measures between two clicked points, and sets the scene's real scale.", always,
       take<ToolKind::measure>},
      {"Tool", "Register", "", "", "Moves a capture onto another one of the same place, by pairs of clicked points.",
       has_scene, take<ToolKind::register_captures>},
      {"Tool", "Bend by values...", "", "", "Bends by exact values, with a preview.", has_scene,
       [](EditorContext& editor) { editor.dialogs.form = Bend::op; }},
      {"Tool", "Twist by values...", "", "", "Twists by exact values, with a preview.", has_scene,
       [](EditorContext& editor) { editor.dialogs.form = Twist::op; }},
      {"Tool", "Taper by values...", "", "", "Tapers by exact values, with a preview.", has_scene,
       [](EditorContext& editor) { editor.dialogs.form = Taper::op; }},
      {"Tool", "Local axes", "X", "Comma", "Aligns the gizmo with the object's local axes.", always,
       [](EditorContext& editor) { editor.tools.local_axes = !editor.tools.local_axes; },
       [](const EditorContext& editor) { return editor.tools.local_axes; }},
      {"Tool", "Snap to surface", "M", "Shift+Tab",
       "When dragged by the gizmo's centre, objects snap to the surface under the pointer.", always,
       [](EditorContext& editor) { editor.tools.snap_to_surface = !editor.tools.snap_to_surface; },
       [](const EditorContext& editor) { return editor.tools.snap_to_surface; }},
      {"Tool", "Smaller brush", "[", "[", "", always, [](EditorContext& editor) { brush_by(editor, 1 / 1.25); },
       nullptr, true},
      {"Tool", "Larger brush", "]", "]", "", always, [](EditorContext& editor) { brush_by(editor, 1.25); }, nullptr,
       true},
      {"View", "Frame selection", "F", "KP_DECIMAL Home",
       "Frames the selection, else the picked nodes, else the whole scene.", has_something_to_see,
       [](EditorContext& editor) { editor.frame_view(); }},
      {"View", "Front", "KP_1", "KP_1", "", always, look_along<2, 1>},
      {"View", "Back", "Ctrl+KP_1", "Ctrl+KP_1", "", always, look_along<2, -1>},
      {"View", "Right", "KP_3", "KP_3", "", always, look_along<0, 1>},
      {"View", "Left", "Ctrl+KP_3", "Ctrl+KP_3", "", always, look_along<0, -1>},
      {"View", "Top", "KP_7", "KP_7", "", always, look_along<1, 1>},
      {"View", "Bottom", "Ctrl+KP_7", "Ctrl+KP_7", "", always, look_along<1, -1>},
      {"View", "Orthographic", "5 KP_5", "KP_5", "Toggles between orthographic and perspective projection.", always,
       toggle_projection, [](const EditorContext& editor) { return editor.view.camera.orthographic(); }},
      {"View", "Fly (W A S D Q E)", "Shift+F", "Shift+F", "Keys move the camera, dragging looks around. Esc ends it.",
       always, [](EditorContext& editor) { editor.view.flying = !editor.view.flying; },
       [](const EditorContext& editor) { return editor.view.flying; }},
      {"View", "Grid", "G", "Shift+G", "Shows a grid on the ground plane.", always,
       [](EditorContext& editor) { editor.settings.grid = !editor.settings.grid; },
       [](const EditorContext& editor) { return editor.settings.grid; }},
      {"View", "Scene background", "", "", "Shows the background colour that is exported. Off: a neutral dark one.",
       always, [](EditorContext& editor) { editor.settings.scene_background = !editor.settings.scene_background; },
       [](const EditorContext& editor) { return editor.settings.scene_background; }},
      {"View", "Show selection", "Shift+T", "Shift+T", "Tints the selected triangles.", always,
       [](EditorContext& editor) { editor.view.show_selection = !editor.view.show_selection; },
       [](const EditorContext& editor) { return editor.view.show_selection; }},
      {"View", "Compare before and after", "Y", "Y", "Shows the imported scene left of a line that can be dragged.",
       has_scene, [](EditorContext& editor) { editor.view.wipe = !editor.view.wipe; },
       [](const EditorContext& editor) { return editor.view.wipe; }},
      {"View", "Show colours", "Alt+1", "Alt+1", "Shows the final colours.", always, look_at<Guides::Inspect::none>,
       is_inspecting<Guides::Inspect::none>},
      {"View", "Show wireframe", "Alt+2", "Alt+2", "Shows the edges of all triangles.", always,
       look_at<Guides::Inspect::wireframe>, is_inspecting<Guides::Inspect::wireframe>},
      {"View", "Show opacity", "Alt+3", "Alt+3", "Shows opaque texels light and transparent ones dark.", always,
       look_at<Guides::Inspect::opacity>, is_inspecting<Guides::Inspect::opacity>},
      {"View", "Show texture sets", "Alt+4", "Alt+4", "Shows each texture set in a different colour.", always,
       look_at<Guides::Inspect::texture_sets>, is_inspecting<Guides::Inspect::texture_sets>},
      {"View", "Show next feature channel", "Alt+5", "Alt+5", "Shows one of the eight feature channels as grey.",
       always, next_channel, is_inspecting<Guides::Inspect::channel>},
      {"View", "Show overdraw", "Alt+6", "Alt+6", "Shows how many triangles overlap: brighter is more.", always,
       look_at<Guides::Inspect::overdraw>, is_inspecting<Guides::Inspect::overdraw>},
      {"View", "Near clipping", "Shift+X", "Alt+B",
       "Hides everything nearer than a plane; picks, rectangle, lasso, polygon and brush leave it out. Alt + wheel "
       "moves the plane.",
       has_scene, toggle_cut, [](const EditorContext& editor) { return editor.view.cut > 0; }},
      {"View", "Maximise viewport", "Ctrl+Space", "Ctrl+Space", "The viewport fills the window.", always,
       [](EditorContext& editor) { editor.view.alone = !editor.view.alone; },
       [](const EditorContext& editor) { return editor.view.alone; }},
      {"View", "Restart graphics", "", "", "Recreates all data on the graphics card.", always,
       [](EditorContext& editor) { editor.jobs.restarts_graphics = true; }},
      {"View", "Store view", "", "", "Stores the current camera with the scene.", has_scene,
       [](EditorContext& editor) { store_view(editor); }},
      {"Window", "History", "", "", "Lists all steps. Click one to undo or redo up to it.", always,
       toggle_tab<BottomTab::history>, shows_tab<BottomTab::history>},
      {"Window", "Views", "", "", "Lists the stored views with thumbnails.", always, toggle_tab<BottomTab::views>,
       shows_tab<BottomTab::views>},
      {"Window", "Light", "", "",
       "Settings of light that follows edits: which effects run, which are omitted, and why.", always,
       toggle_tab<BottomTab::light>, shows_tab<BottomTab::light>},
      {"Window", "Script", "", "", "Shows the steps as a script.", always, toggle_tab<BottomTab::script>,
       shows_tab<BottomTab::script>},
      {"Window", "Performance", "", "", "Shows error against frame time, and which effects run.", always,
       toggle_tab<BottomTab::cost>, shows_tab<BottomTab::cost>},
      {"Window", "Message log", "", "", "Lists all messages.", always, toggle_tab<BottomTab::log>,
       shows_tab<BottomTab::log>},
      {"Window", "Light theme", "", "", "Light window colours.", always, use_color_theme<ColorTheme::light>,
       has_color_theme<ColorTheme::light>},
      {"Window", "Dark theme", "", "", "Dark window colours.", always, use_color_theme<ColorTheme::dark>,
       has_color_theme<ColorTheme::dark>},
      {"Window", "System theme", "", "", "Light or dark, as set on the desktop.", always,
       use_color_theme<ColorTheme::system>, has_color_theme<ColorTheme::system>},
      {"Window", "Larger text", "Ctrl+KP_ADD", "", "", always, [](EditorContext& editor) { text_by(editor, 1.1); }},
      {"Window", "Smaller text", "Ctrl+KP_SUBTRACT", "", "", always,
       [](EditorContext& editor) { text_by(editor, 1 / 1.1); }},
      {"Window", "Blender keymap", "", "", "Uses Blender's keys instead of Rebake's.", always,
       [](EditorContext& editor) { editor.settings.blender_keys = !editor.settings.blender_keys; },
       [](const EditorContext& editor) { return editor.settings.blender_keys; }},
      {"Help", "Keyboard and mouse", "F1", "F1", "Lists all keys and mouse actions.", always,
       [](EditorContext& editor) { editor.dialogs.keys = !editor.dialogs.keys; }},
  };
  return table;
}

const Command& command_named(const std::string& title) {
  for (const Command& command : command_table())
    if (command.title == title) return command;
  throw std::invalid_argument("no command \"" + title + "\"");
}

std::string command_key(const std::string& title, const Settings& settings) {
  return command_named(title).key_of(settings);
}

}  // namespace rebake
