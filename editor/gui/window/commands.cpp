#include "editor/gui/window/commands.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <map>
#include <sstream>
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
#include "editor/edits/shape/delete_selected.h"
#include "editor/edits/shape/separate.h"
#include "editor/edits/support.h"
#include "editor/gui/view/navigation.h"

namespace rebake {

namespace {

bool always(const Desk&) { return true; }
bool has_scene(const Desk& desk) { return !desk.scene().roots.empty(); }
bool has_views(const Desk& desk) { return desk.scene().views.size() > 1; }
bool has_active(const Desk& desk) { return !desk.active.empty(); }
bool has_selection(const Desk& desk) { return desk.selected_triangles() > 0; }
bool has_either(const Desk& desk) { return has_active(desk) || has_selection(desk); }

template <ToolKind kind>
void take(Desk& desk) {
  desk.tools.kind = kind;
}
// In the Blender keymap, the key of a tool also begins a drag, after which the previous tool returns.
template <ToolKind kind>
void grab(Desk& desk) {
  if (desk.settings.blender_keys && has_either(desk)) {
    desk.tools.before = desk.tools.kind;
    desk.tools.drag_begins = kind;
  }
  desk.tools.kind = kind;
}
template <PathQuestion question>
void ask(Desk& desk) {
  desk.asking.path = question;
}

void select(Desk& desk, bool all, bool none, bool invert) {
  Select edit;
  edit.all = all;
  edit.none = none;
  edit.invert = invert;
  desk.edit_scope(edit);
}

// One edit per picked node.
template <class T>
std::vector<Edit> for_each_active(const Desk& desk) {
  std::vector<Edit> list;
  for (const NodeId id : desk.active_tops()) {
    T edit;
    edit.node = NodeRef{id};
    list.emplace_back(edit);
  }
  return list;
}

template <class T>
void each_active(Desk& desk) {
  desk.edits(for_each_active<T>(desk));
}

void drop(Desk& desk) { desk.edits_that_change(for_each_active<Drop>(desk)); }

// Sets the ground plane to the scene's lowest point, or fits it to the selection.
template <bool GroundEdit::*from>
void set_ground(Desk& desk) {
  GroundEdit edit;
  edit.*from = true;
  desk.edit(edit);
}

void show_discarded(Desk& desk) {
  desk.project.recoverable = discarded_work();
  if (desk.project.recoverable.empty()) desk.messages.say("The trash is empty.");
}

// The copies are picked; in the Blender keymap, a drag moves them at once.
void duplicate(Desk& desk) {
  desk.edits(for_each_active<Duplicate>(desk), [&desk] {
    if (desk.settings.blender_keys) grab<ToolKind::move>(desk);
  });
}

bool selects_triangles(ToolKind tool) {
  return tool == ToolKind::rectangle || tool == ToolKind::lasso || tool == ToolKind::polygon ||
         tool == ToolKind::brush || tool == ToolKind::flood || tool == ToolKind::volume || tool == ToolKind::erase;
}

void remove(Desk& desk) {
  if (has_selection(desk) && !desk.scope(true).empty())
    desk.edit_scope(DeleteSelected{});
  else if (selects_triangles(desk.tools.kind) || desk.active.empty())
    desk.messages.say("Nothing is selected " + desk.scope_words() +
                      ". With Pick or Move in hand, Delete removes the picked nodes.");
  else
    each_active<Remove>(desk);
}

void show_all(Desk& desk) {
  std::vector<Edit> list;
  for (const PlacedNode& placed : placed_nodes(desk.scene()))
    if (!placed.node->visible) {
      Show show;
      show.node = NodeRef{placed.node->id};
      list.emplace_back(show);
    }
  desk.edits(list);
}

void separate(Desk& desk) {
  std::vector<Edit> list;
  for (const PlacedNode& placed : placed_nodes(desk.scene()))
    if (placed.visible && !placed.locked && placed.node->selection && count(*placed.node->selection) > 0 &&
        (desk.active.empty() || desk.active.contains(placed.node->id))) {
      Separate edit;
      edit.node = NodeRef{placed.node->id};
      list.emplace_back(edit);
    }
  desk.edits(list);
}

bool has_several(const Desk& desk) { return desk.active.size() > 1; }
void align(Desk& desk) { desk.asking.form = Align::op; }

void group(Desk& desk) {
  Group edit;
  for (const NodeId id : desk.active_tops()) edit.nodes.push_back(NodeRef{id});
  desk.edit(edit);
}

void save(Desk& desk) {
  if (desk.project.path.empty())
    desk.asking.path = PathQuestion::save_project;
  else
    desk.project.save(desk.project.path);
}

void brush_by(Desk& desk, double factor) {
  desk.settings.brush_radius = std::clamp(desk.settings.brush_radius * factor, 1.0, 500.0);
}

template <int axis, int sign>
void look_along(Desk& desk) {
  Vec3 direction(0, 0, 0);
  direction[axis] = sign;
  desk.view.camera = along_axis(desk.view.camera, direction);
}

void project_otherwise(Desk& desk) { desk.view.camera = projected_otherwise(desk.view.camera); }

void toggle_cut(Desk& desk) {
  // The cutting plane starts at the camera's target.
  desk.view.cut = desk.view.cut > 0 ? 0 : (desk.view.camera.eye - desk.view.camera.target).norm();
}

template <Guides::Inspect inspect>
void look_at(Desk& desk) {
  desk.view.inspect = inspect;
}
template <Guides::Inspect inspect>
bool looks_at(const Desk& desk) {
  return desk.view.inspect == inspect;
}

void undo(Desk& desk) { desk.undo(); }
void redo(Desk& desk) { desk.redo(); }

template <BottomTab tab>
void toggle_tab(Desk& desk) {
  desk.settings.bottom_open = !(desk.settings.bottom_open && desk.settings.bottom_tab == tab);
  desk.settings.bottom_tab = tab;
}
template <BottomTab tab>
bool shows_tab(const Desk& desk) {
  return desk.settings.bottom_open && desk.settings.bottom_tab == tab;
}

template <Looks looks>
void use_looks(Desk& desk) {
  desk.settings.looks = looks;
}
template <Looks looks>
bool has_looks(const Desk& desk) {
  return desk.settings.looks == looks;
}
void text_by(Desk& desk, double factor) {
  desk.settings.text_scale = std::clamp(desk.settings.text_scale * factor, 0.6, 3.0);
}

void next_channel(Desk& desk) {
  desk.view.channel = desk.view.inspect == Guides::Inspect::channel ? (desk.view.channel + 1) % 8 : 0;
  desk.view.inspect = Guides::Inspect::channel;
}

}  // namespace

void store_view(Desk& desk, const std::string& name) {
  StoreView edit;
  edit.name = name;
  edit.camera = desk.view.camera;
  edit.camera.near_plane = edit.camera.far_plane = 0;  // 0: fitted to the scene when the view is used
  for (int number = 1; edit.name.empty(); ++number)
    if (std::string free = "view " + std::to_string(number); !desk.scene().views.contains(free)) edit.name = free;
  desk.edit(edit);
}

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      {"File", "Open...", "Ctrl+O", "Ctrl+O", "Opens a baked scene, a scene folder or a project.", always,
       ask<PathQuestion::open>},
      {"File", "Save project", "Ctrl+S", "Ctrl+S", "Keeps every step in a .rebake file.", has_scene, save},
      {"File", "Save project as...", "Ctrl+Shift+S", "Ctrl+Shift+S", "Keeps every step in another file.", has_scene,
       ask<PathQuestion::save_project>},
      {"File", "Save scene folder...", "", "", "Writes all nodes as they are now, without the steps.", has_scene,
       ask<PathQuestion::save_scene>},
      {"File", "Export...", "Ctrl+E", "Ctrl+E", "Writes a folder that MobileNeRF viewers open.", has_scene,
       ask<PathQuestion::export_folder>},
      {"File", "Screenshot...", "F12", "F12", "Writes this view as a picture.", has_scene,
       ask<PathQuestion::screenshot>},
      {"File", "Turntable...", "", "", "Writes pictures or a video from all around.", has_scene,
       ask<PathQuestion::turntable>},
      {"File", "Camera path...", "", "", "Writes pictures or a video on a way through the stored views.", has_views,
       ask<PathQuestion::camera_path>},
      {"File", "Save as script...", "", "", "Writes the steps as lines that other scenes can replay.", has_scene,
       ask<PathQuestion::save_script>},
      {"File", "Run script...", "", "", "Carries out the lines of a script.", always, ask<PathQuestion::run_script>},
      {"File", "Discarded work...", "", "", "Lists unsaved work that was discarded in the last 30 days.", always,
       show_discarded},
      {"File", "Quit", "Ctrl+Q", "Ctrl+Q", "Closes the window; unsaved work is asked about.", always,
       [](Desk& desk) { desk.asking.quitting = true; }},
      {"Edit", "Undo", "Ctrl+Z", "Ctrl+Z", "Takes the last step back.",
       [](const Desk& desk) { return !desk.now->done.empty(); }, undo, nullptr, true},
      {"Edit", "Redo", "Ctrl+Shift+Z Ctrl+Y", "Ctrl+Shift+Z", "Does the last undone step again.",
       [](const Desk& desk) { return !desk.now->undone.empty(); }, redo, nullptr, true},
      {"Edit", "All commands...", "Ctrl+P", "F3 Ctrl+P", "Finds any command or edit by its name.", always,
       [](Desk& desk) { desk.asking.palette = true; }},
      {"Edit", "Delete", "Delete", "X Delete", "Deletes the selected triangles, else removes the picked nodes.",
       has_either, remove},
      {"Edit", "Remove picked nodes", "Shift+Delete", "Shift+Delete", "Removes whole nodes, whatever is selected.",
       has_active, each_active<Remove>},
      {"Edit", "Duplicate", "Ctrl+D", "Shift+D", "Copies the picked nodes; the copies are picked then.", has_active,
       duplicate},
      {"Edit", "Group", "Ctrl+G", "Ctrl+G", "Puts the picked nodes into a group.", has_active, group},
      {"Edit", "Separate", "Ctrl+J", "P", "Makes a node of its own of the selected triangles.", has_selection,
       separate},
      {"Edit", "Drop to surface", "End", "End", "Lets the picked nodes fall onto a surface or the ground plane.",
       has_active, drop},
      {"Edit", "Ground at scene's foot", "", "", "Levels the ground plane at the lowest visible point.", has_scene,
       set_ground<&GroundEdit::foot>},
      {"Edit", "Ground from selection", "", "", "Fits the ground plane to the selected triangles.", has_selection,
       set_ground<&GroundEdit::selection>},
      {"Edit", "Align and spread...", "", "", "Puts the picked nodes beside each other along an axis.", has_several,
       align},
      {"Edit", "Hide", "H", "H", "Hides the picked nodes; nothing is exported of them.", has_active, each_active<Hide>},
      {"Edit", "Show all", "Shift+H", "Alt+H", "Shows every hidden node.", has_scene, show_all},
      {"Edit", "Adjust last step", "F9", "F9", "Opens the fields of what was done last.",
       [](const Desk& desk) { return !desk.now->done.empty(); },
       [](Desk& desk) { desk.settings.adjust_open = !desk.settings.adjust_open; },
       [](const Desk& desk) { return desk.settings.adjust_open; }},
      {"Select", "All", "Ctrl+A", "A", "Selects every triangle, of the picked nodes where there are some.", has_scene,
       [](Desk& desk) { select(desk, true, false, false); }},
      {"Select", "None", "Ctrl+Shift+A", "Alt+A", "Selects nothing.", has_scene,
       [](Desk& desk) { select(desk, false, true, false); }},
      {"Select", "Invert", "Ctrl+I", "Ctrl+I", "Selects what is not selected.", has_scene,
       [](Desk& desk) { select(desk, false, false, true); }},
      {"Select", "Grow", "Ctrl+]", "Ctrl+KP_ADD", "Selects the neighbours too.", has_selection,
       [](Desk& desk) { desk.edit_scope(Grow{}); }},
      {"Select", "Shrink", "Ctrl+[", "Ctrl+KP_SUBTRACT", "Leaves the border out.", has_selection,
       [](Desk& desk) { desk.edit_scope(Shrink{}); }},
      {"Select", "Connected", "Ctrl+L", "L", "Selects all that hangs together with the selection.", has_selection,
       [](Desk& desk) { desk.edit_scope(SelectConnected{}); }},
      {"Select", "Visible only", "T", "Alt+Z", "Takes what is seen; off, what lies behind it too.", always,
       [](Desk& desk) { desk.tools.visible_only() = !desk.tools.visible_only(); },
       [](const Desk& desk) { return desk.tools.visible_only(); }},
      {"Tool", "Pick nodes", "V", "W", "Click a node to pick it; tools work on what is picked.", always,
       take<ToolKind::pick>},
      {"Tool", "Rectangle", "R", "B", "Selects triangles in a rectangle of the picture.", always,
       take<ToolKind::rectangle>},
      {"Tool", "Lasso", "L", "Ctrl+Shift+L", "Selects triangles inside a line drawn by hand.", always,
       take<ToolKind::lasso>},
      {"Tool", "Polygon", "P", "Ctrl+Shift+P", "Selects triangles between clicked corners.", always,
       take<ToolKind::polygon>},
      {"Tool", "Brush", "B", "C", "Selects triangles by painting over them.", always, take<ToolKind::brush>},
      {"Tool", "Flood", "O", "O", "Click to select what touches and has the same colour.", always,
       take<ToolKind::flood>},
      {"Tool", "Volume", "U", "U", "Selects what lies in a box or a ball.", always, take<ToolKind::volume>},
      {"Tool", "Eraser", "E", "E", "Makes what is painted over transparent.", always, take<ToolKind::erase>},
      {"Tool", "Move", "1", "G", "Moves the selected triangles, else the picked nodes.", always, grab<ToolKind::move>},
      {"Tool", "Turn", "2", "R", "Turns the selected triangles, else the picked nodes.", always, grab<ToolKind::turn>},
      {"Tool", "Scale", "3", "S", "Scales the selected triangles, else the picked nodes.", always,
       grab<ToolKind::scale>},
      {"Tool", "Cage", "C", "Shift+C", "Bends what lies in a cage by dragging its points.", always,
       take<ToolKind::cage>},
      {"Tool", "Bend, twist, taper", "N", "Shift+N", "Bends along a spine by dragging its end.", always,
       take<ToolKind::bend>},
      {"Tool", "Handles", "K", "K", "Holds and pulls points; what lies between stays as rigid as it can.", always,
       take<ToolKind::handles>},
      {"Tool", "Ground", "", "", "Sets the plane that things stand on: three clicked points, or a height.", always,
       take<ToolKind::ground>},
      {"Tool", "Bend by numbers...", "", "", "All fields of a bend, with a preview.", has_scene,
       [](Desk& desk) { desk.asking.form = Bend::op; }},
      {"Tool", "Twist by numbers...", "", "", "All fields of a twist, with a preview.", has_scene,
       [](Desk& desk) { desk.asking.form = Twist::op; }},
      {"Tool", "Taper by numbers...", "", "", "All fields of a taper, with a preview.", has_scene,
       [](Desk& desk) { desk.asking.form = Taper::op; }},
      {"Tool", "Local axes", "X", "Comma", "Handles along the object's own axes.", always,
       [](Desk& desk) { desk.tools.local_axes = !desk.tools.local_axes; },
       [](const Desk& desk) { return desk.tools.local_axes; }},
      {"Tool", "Snap to surface", "M", "Shift+Tab", "What is moved by its middle stands on what is under the pointer.",
       always, [](Desk& desk) { desk.tools.snaps = !desk.tools.snaps; },
       [](const Desk& desk) { return desk.tools.snaps; }},
      {"Tool", "Smaller brush", "[", "[", "", always, [](Desk& desk) { brush_by(desk, 1 / 1.25); }, nullptr, true},
      {"Tool", "Larger brush", "]", "]", "", always, [](Desk& desk) { brush_by(desk, 1.25); }, nullptr, true},
      {"View", "Frame selection", "F", "KP_DECIMAL Home", "Looks at the selection, the picked nodes, or all.",
       has_scene, [](Desk& desk) { desk.frame_view(); }},
      {"View", "Front", "KP_1", "KP_1", "", always, look_along<2, 1>},
      {"View", "Back", "Ctrl+KP_1", "Ctrl+KP_1", "", always, look_along<2, -1>},
      {"View", "Right", "KP_3", "KP_3", "", always, look_along<0, 1>},
      {"View", "Left", "Ctrl+KP_3", "Ctrl+KP_3", "", always, look_along<0, -1>},
      {"View", "Top", "KP_7", "KP_7", "", always, look_along<1, 1>},
      {"View", "Bottom", "Ctrl+KP_7", "Ctrl+KP_7", "", always, look_along<1, -1>},
      {"View", "Orthographic", "5 KP_5", "KP_5", "Far things as large as near ones.", always, project_otherwise,
       [](const Desk& desk) { return desk.view.camera.orthographic(); }},
      {"View", "Fly (W A S D Q E)", "Shift+F", "Shift+F", "Keys move, the pointer looks around; Esc ends it.", always,
       [](Desk& desk) { desk.view.flying = !desk.view.flying; }, [](const Desk& desk) { return desk.view.flying; }},
      {"View", "Grid", "G", "Shift+G", "Lines on the ground plane.", always,
       [](Desk& desk) { desk.settings.grid = !desk.settings.grid; },
       [](const Desk& desk) { return desk.settings.grid; }},
      {"View", "Scene's background", "", "", "The colour that is exported; off, a quiet dark one.", always,
       [](Desk& desk) { desk.settings.scene_background = !desk.settings.scene_background; },
       [](const Desk& desk) { return desk.settings.scene_background; }},
      {"View", "Show selection", "Shift+T", "Shift+T", "Tints the selected triangles.", always,
       [](Desk& desk) { desk.view.show_selection = !desk.view.show_selection; },
       [](const Desk& desk) { return desk.view.show_selection; }},
      {"View", "Before and after", "Y", "Y", "Compares with what was imported, on both sides of a line.", has_scene,
       [](Desk& desk) { desk.view.wipe = !desk.view.wipe; }, [](const Desk& desk) { return desk.view.wipe; }},
      {"View", "Show colours", "Alt+1", "Alt+1", "What people see.", always, look_at<Guides::Inspect::none>,
       looks_at<Guides::Inspect::none>},
      {"View", "Show wireframe", "Alt+2", "Alt+2", "Every triangle's edges.", always,
       look_at<Guides::Inspect::wireframe>, looks_at<Guides::Inspect::wireframe>},
      {"View", "Show opacity", "Alt+3", "Alt+3", "Opaque texels light, transparent ones dark.", always,
       look_at<Guides::Inspect::opacity>, looks_at<Guides::Inspect::opacity>},
      {"View", "Show texture sets", "Alt+4", "Alt+4", "A colour for each texture set.", always,
       look_at<Guides::Inspect::texture_sets>, looks_at<Guides::Inspect::texture_sets>},
      {"View", "Show next feature channel", "Alt+5", "Alt+5", "One of the eight features as grey.", always,
       next_channel, looks_at<Guides::Inspect::channel>},
      {"View", "Show overdraw", "Alt+6", "Alt+6", "Brighter where more triangles lie behind each other.", always,
       look_at<Guides::Inspect::overdraw>, looks_at<Guides::Inspect::overdraw>},
      {"View", "Cut into the scene", "Shift+X", "Alt+B",
       "Leaves out what is near; what is cut off is not selected. Alt + wheel moves the cut.", has_scene, toggle_cut,
       [](const Desk& desk) { return desk.view.cut > 0; }},
      {"View", "Only the picture", "Ctrl+Space", "Ctrl+Space", "The picture takes the whole window.", always,
       [](Desk& desk) { desk.view.alone = !desk.view.alone; }, [](const Desk& desk) { return desk.view.alone; }},
      {"View", "Restart graphics", "", "", "Makes all that lives on the graphics card anew.", always,
       [](Desk& desk) { desk.jobs.restarts_graphics = true; }},
      {"View", "Store view", "", "", "Keeps this view with the scene.", has_scene,
       [](Desk& desk) { store_view(desk); }},
      {"Window", "History", "", "", "All steps; a click goes there.", always, toggle_tab<BottomTab::history>,
       shows_tab<BottomTab::history>},
      {"Window", "Views", "", "", "Stored views with pictures.", always, toggle_tab<BottomTab::views>,
       shows_tab<BottomTab::views>},
      {"Window", "Light", "", "", "Shadows that follow edits: what runs, what is left out, and why.", always,
       toggle_tab<BottomTab::light>, shows_tab<BottomTab::light>},
      {"Window", "Script", "", "", "The steps as lines of a script.", always, toggle_tab<BottomTab::script>,
       shows_tab<BottomTab::script>},
      {"Window", "Cost", "", "", "What accuracy costs in time, and which effects run.", always,
       toggle_tab<BottomTab::cost>, shows_tab<BottomTab::cost>},
      {"Window", "Messages", "", "", "All that was said.", always, toggle_tab<BottomTab::log>,
       shows_tab<BottomTab::log>},
      {"Window", "Light colours", "", "", "A light window.", always, use_looks<Looks::light>, has_looks<Looks::light>},
      {"Window", "Dark colours", "", "", "A dark window.", always, use_looks<Looks::dark>, has_looks<Looks::dark>},
      {"Window", "Colours of the desktop", "", "", "Light or dark, as the desktop is.", always,
       use_looks<Looks::system>, has_looks<Looks::system>},
      {"Window", "Larger text", "Ctrl+KP_ADD", "", "", always, [](Desk& desk) { text_by(desk, 1.1); }},
      {"Window", "Smaller text", "Ctrl+KP_SUBTRACT", "", "", always, [](Desk& desk) { text_by(desk, 1 / 1.1); }},
      {"Window", "Keys of Blender", "", "", "Blender's keys in place of Rebake's.", always,
       [](Desk& desk) { desk.settings.blender_keys = !desk.settings.blender_keys; },
       [](const Desk& desk) { return desk.settings.blender_keys; }},
      {"Help", "Keys and pointer", "F1", "F1", "A sheet of all keys.", always,
       [](Desk& desk) { desk.asking.keys = !desk.asking.keys; }},
  };
  return table;
}

std::optional<KeyPress> parse_key(const std::string& text) {
  static const std::map<std::string, int> named = {{"Delete", GLFW_KEY_DELETE}, {"Escape", GLFW_KEY_ESCAPE},
                                                   {"Enter", GLFW_KEY_ENTER},   {"Home", GLFW_KEY_HOME},
                                                   {"Comma", GLFW_KEY_COMMA},   {"KP_DECIMAL", GLFW_KEY_KP_DECIMAL},
                                                   {"KP_ADD", GLFW_KEY_KP_ADD}, {"KP_SUBTRACT", GLFW_KEY_KP_SUBTRACT},
                                                   {"Tab", GLFW_KEY_TAB},       {"End", GLFW_KEY_END},
                                                   {"Space", GLFW_KEY_SPACE}};
  KeyPress press;
  std::string rest = text;
  for (bool more = true; more;) {
    more = false;
    for (const auto& [name, flag] : {std::pair("Ctrl+", &KeyPress::control), std::pair("Shift+", &KeyPress::shift),
                                     std::pair("Alt+", &KeyPress::alt)})
      if (rest.starts_with(name) && !(press.*flag)) {
        press.*flag = true;
        rest = rest.substr(std::string(name).size());
        more = true;
      }
  }
  if (const auto found = named.find(rest); found != named.end()) {
    press.key = found->second;
  } else if (rest.size() == 1 && ((rest[0] >= 'A' && rest[0] <= 'Z') || (rest[0] >= '0' && rest[0] <= '9') ||
                                  rest[0] == '[' || rest[0] == ']')) {
    press.key = static_cast<unsigned char>(rest[0]);  // GLFW's key codes of these characters are ASCII
  } else if (rest.size() == 4 && rest.starts_with("KP_") && rest[3] >= '0' && rest[3] <= '9') {
    press.key = GLFW_KEY_KP_0 + (rest[3] - '0');
  } else if (rest.size() >= 2 && rest.size() <= 3 && rest[0] == 'F' &&
             rest.find_first_not_of("0123456789", 1) == std::string::npos) {
    const int number = std::stoi(rest.substr(1));
    if (number < 1 || number > 12) return std::nullopt;
    press.key = GLFW_KEY_F1 + number - 1;
  } else {
    return std::nullopt;
  }
  return press;
}

const Command& command_named(const std::string& title) {
  for (const Command& command : command_table())
    if (command.title == title) return command;
  throw std::invalid_argument("no command \"" + title + "\"");
}

std::string command_key(const std::string& title, const Desk& desk) { return command_named(title).key_of(desk); }

const Command* command_for(const KeyPress& press, const Desk& desk) {
  for (const Command& command : command_table()) {
    std::istringstream keys(command.keys_of(desk));
    for (std::string key; keys >> key;)
      if (parse_key(key) == press) return &command;
  }
  return nullptr;
}

}  // namespace rebake
