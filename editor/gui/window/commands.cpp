#include "editor/gui/window/commands.h"

#include <GLFW/glfw3.h>

#include <map>
#include <sstream>

#include "editor/edits/deform/bend.h"
#include "editor/edits/deform/taper.h"
#include "editor/edits/deform/twist.h"
#include "editor/edits/nodes/duplicate.h"
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
bool has_active(const Desk& desk) { return !desk.active.empty(); }
bool has_selection(const Desk& desk) { return desk.selected_triangles() > 0; }
bool has_either(const Desk& desk) { return has_active(desk) || has_selection(desk); }

template <ToolKind kind>
void take(Desk& desk) {
  desk.tools.kind = kind;
}
// Blender's keys begin a drag, and come back to the tool that was in hand.
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
  desk.edit(edit);
}

template <class T>
void each_active(Desk& desk) {
  std::vector<Edit> list;
  for (const NodeId id : desk.active_tops()) {
    T edit;
    edit.node = NodeRef{id};
    list.emplace_back(edit);
  }
  desk.edits(list);
}

// The copies are picked then: they are what is moved next, in Blender's keymap at once.
void duplicate(Desk& desk) {
  std::set<NodeId> before;
  for (const PlacedNode& placed : placed_nodes(desk.scene())) before.insert(placed.node->id);
  std::vector<Edit> list;
  for (const NodeId id : desk.active_tops()) {
    Duplicate edit;
    edit.node = NodeRef{id};
    list.emplace_back(edit);
  }
  desk.edits(list, [&desk, before] {
    desk.active.clear();
    for (const PlacedNode& placed : placed_nodes(desk.scene()))
      if (!before.contains(placed.node->id)) desk.active.insert(placed.node->id);
    if (desk.settings.blender_keys) grab<ToolKind::move>(desk);
  });
}

bool selects_triangles(ToolKind tool) {
  return tool == ToolKind::rectangle || tool == ToolKind::lasso || tool == ToolKind::polygon ||
         tool == ToolKind::brush || tool == ToolKind::flood || tool == ToolKind::erase;
}

void remove(Desk& desk) {
  if (has_selection(desk))
    desk.edit(DeleteSelected{});
  else if (selects_triangles(desk.tools.kind))
    desk.messages.log.push_back({"delete: nothing is selected (with Pick or Move in hand, picked nodes are removed)"});
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
    if (placed.visible && !placed.locked && placed.node->selection && count(*placed.node->selection) > 0) {
      Separate edit;
      edit.node = NodeRef{placed.node->id};
      list.emplace_back(edit);
    }
  desk.edits(list);
}

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

template <Guides::Inspect inspect>
void look_at(Desk& desk) {
  desk.view.inspect = inspect;
}

void next_channel(Desk& desk) {
  desk.view.channel = desk.view.inspect == Guides::Inspect::channel ? (desk.view.channel + 1) % 8 : 0;
  desk.view.inspect = Guides::Inspect::channel;
  desk.messages.log.push_back(
      {"feature channel " + std::to_string(desk.view.channel) + (desk.view.channel == 0 ? ": opacity" : "")});
}

void store_view(Desk& desk) {
  StoreView edit;
  edit.camera = desk.view.camera;
  edit.camera.near_plane = edit.camera.far_plane = 0;  // to fit what the scene becomes
  for (int number = 1;; ++number) {
    edit.name = "view " + std::to_string(number);
    if (!desk.scene().views.contains(edit.name)) break;
  }
  desk.edit(edit);
}

}  // namespace

const std::vector<Command>& command_table() {
  static const std::vector<Command> table = {
      {"File", "Open...", "Ctrl+O", "Ctrl+O", always, ask<PathQuestion::open>},
      {"File", "Save project", "Ctrl+S", "Ctrl+S", has_scene, save},
      {"File", "Save project as...", "Ctrl+Shift+S", "Ctrl+Shift+S", has_scene, ask<PathQuestion::save_project>},
      {"File", "Save scene folder...", "", "", has_scene, ask<PathQuestion::save_scene>},
      {"File", "Export...", "Ctrl+E", "Ctrl+E", has_scene, ask<PathQuestion::export_folder>},
      {"File", "Screenshot...", "F12", "F12", has_scene, ask<PathQuestion::screenshot>},
      {"File", "Turntable...", "", "", has_scene, ask<PathQuestion::turntable>},
      {"File", "Save as script...", "", "", has_scene, ask<PathQuestion::save_script>},
      {"File", "Run script...", "", "", always, ask<PathQuestion::run_script>},
      {"File", "Quit", "Ctrl+Q", "Ctrl+Q", always, [](Desk& desk) { desk.asking.quitting = true; }},
      {"Edit", "Undo", "Ctrl+Z", "Ctrl+Z", [](const Desk& desk) { return !desk.now->done.empty(); },
       [](Desk& desk) { desk.undo(); }, true},
      {"Edit", "Redo", "Ctrl+Shift+Z Ctrl+Y", "Ctrl+Shift+Z",
       [](const Desk& desk) { return !desk.now->undone.empty(); }, [](Desk& desk) { desk.redo(); }, true},
      {"Edit", "All commands...", "Ctrl+P", "F3 Ctrl+P", always, [](Desk& desk) { desk.asking.palette = true; }},
      {"Edit", "Delete", "Delete", "X Delete", has_either, remove},
      {"Edit", "Duplicate", "Ctrl+D", "Shift+D", has_active, duplicate},
      {"Edit", "Group", "Ctrl+G", "Ctrl+G", has_active, group},
      {"Edit", "Separate", "Ctrl+J", "P", has_selection, separate},
      {"Edit", "Hide", "H", "H", has_active, each_active<Hide>},
      {"Edit", "Show all", "Shift+H", "Alt+H", has_scene, show_all},
      {"Select", "All", "Ctrl+A", "A", has_scene, [](Desk& desk) { select(desk, true, false, false); }},
      {"Select", "None", "Ctrl+Shift+A", "Alt+A", has_scene, [](Desk& desk) { select(desk, false, true, false); }},
      {"Select", "Invert", "Ctrl+I", "Ctrl+I", has_scene, [](Desk& desk) { select(desk, false, false, true); }},
      {"Select", "Grow", "Ctrl+]", "Ctrl+KP_ADD", has_selection, [](Desk& desk) { desk.edit(Grow{}); }},
      {"Select", "Shrink", "Ctrl+[", "Ctrl+KP_SUBTRACT", has_selection, [](Desk& desk) { desk.edit(Shrink{}); }},
      {"Select", "Connected", "Ctrl+L", "L", has_selection, [](Desk& desk) { desk.edit(SelectConnected{}); }},
      {"Select", "Visible only", "T", "Alt+Z", always,
       [](Desk& desk) { desk.tools.visible_only = !desk.tools.visible_only; }},
      {"Tool", "Pick nodes", "V", "W", always, take<ToolKind::pick>},
      {"Tool", "Rectangle", "R", "B", always, take<ToolKind::rectangle>},
      {"Tool", "Lasso", "L", "Ctrl+Shift+L", always, take<ToolKind::lasso>},
      {"Tool", "Polygon", "P", "Ctrl+Shift+P", always, take<ToolKind::polygon>},
      {"Tool", "Brush", "B", "C", always, take<ToolKind::brush>},
      {"Tool", "Flood", "O", "O", always, take<ToolKind::flood>},
      {"Tool", "Eraser", "E", "E", always, take<ToolKind::erase>},
      {"Tool", "Move", "1", "G", always, grab<ToolKind::move>},
      {"Tool", "Turn", "2", "R", always, grab<ToolKind::turn>},
      {"Tool", "Scale", "3", "S", always, grab<ToolKind::scale>},
      {"Tool", "Cage", "C", "Shift+C", always, take<ToolKind::cage>},
      {"Tool", "Bend, twist, taper", "N", "Shift+N", always, take<ToolKind::bend>},
      {"Tool", "Bend by numbers...", "", "", has_scene, [](Desk& desk) { desk.asking.form = Bend::op; }},
      {"Tool", "Twist by numbers...", "", "", has_scene, [](Desk& desk) { desk.asking.form = Twist::op; }},
      {"Tool", "Taper by numbers...", "", "", has_scene, [](Desk& desk) { desk.asking.form = Taper::op; }},
      {"Tool", "Local axes", "X", "Comma", always, [](Desk& desk) { desk.tools.local_axes = !desk.tools.local_axes; }},
      {"Tool", "Smaller brush", "[", "[", always, [](Desk& desk) { brush_by(desk, 1 / 1.25); }, true},
      {"Tool", "Larger brush", "]", "]", always, [](Desk& desk) { brush_by(desk, 1.25); }, true},
      {"View", "Frame selection", "F", "KP_DECIMAL Home", has_scene, [](Desk& desk) { desk.frame_view(); }},
      {"View", "Front", "KP_1", "KP_1", always, look_along<2, 1>},
      {"View", "Back", "Ctrl+KP_1", "Ctrl+KP_1", always, look_along<2, -1>},
      {"View", "Right", "KP_3", "KP_3", always, look_along<0, 1>},
      {"View", "Left", "Ctrl+KP_3", "Ctrl+KP_3", always, look_along<0, -1>},
      {"View", "Top", "KP_7", "KP_7", always, look_along<1, 1>},
      {"View", "Bottom", "Ctrl+KP_7", "Ctrl+KP_7", always, look_along<1, -1>},
      {"View", "Orthographic or perspective", "5 KP_5", "KP_5", always, project_otherwise},
      {"View", "Fly (W A S D Q E)", "Shift+F", "Shift+F", always,
       [](Desk& desk) { desk.view.flying = !desk.view.flying; }},
      {"View", "Grid", "G", "Shift+G", always, [](Desk& desk) { desk.settings.grid = !desk.settings.grid; }},
      {"View", "Show selection", "Shift+T", "Shift+T", always,
       [](Desk& desk) { desk.view.show_selection = !desk.view.show_selection; }},
      {"View", "Before and after", "Y", "Y", has_scene, [](Desk& desk) { desk.view.wipe = !desk.view.wipe; }},
      {"View", "Show colours", "Alt+1", "Alt+1", always, look_at<Guides::Inspect::none>},
      {"View", "Show wireframe", "Alt+2", "Alt+2", always, look_at<Guides::Inspect::wireframe>},
      {"View", "Show opacity", "Alt+3", "Alt+3", always, look_at<Guides::Inspect::opacity>},
      {"View", "Show texture sets", "Alt+4", "Alt+4", always, look_at<Guides::Inspect::texture_sets>},
      {"View", "Show next feature channel", "Alt+5", "Alt+5", always, next_channel},
      {"View", "Show overdraw", "Alt+6", "Alt+6", always, look_at<Guides::Inspect::overdraw>},
      {"View", "Restart graphics", "", "", always, [](Desk& desk) { desk.jobs.restarts_graphics = true; }},
      {"View", "Store view", "", "", has_scene, store_view},
      {"View", "Dark or light", "", "", always, [](Desk& desk) { desk.settings.dark = !desk.settings.dark; }},
      {"View", "Keys of Blender", "", "", always,
       [](Desk& desk) { desk.settings.blender_keys = !desk.settings.blender_keys; }},
  };
  return table;
}

std::optional<KeyPress> parse_key(const std::string& text) {
  static const std::map<std::string, int> named = {{"Delete", GLFW_KEY_DELETE}, {"Escape", GLFW_KEY_ESCAPE},
                                                   {"Enter", GLFW_KEY_ENTER},   {"Home", GLFW_KEY_HOME},
                                                   {"Comma", GLFW_KEY_COMMA},   {"KP_DECIMAL", GLFW_KEY_KP_DECIMAL},
                                                   {"KP_ADD", GLFW_KEY_KP_ADD}, {"KP_SUBTRACT", GLFW_KEY_KP_SUBTRACT},
                                                   {"Tab", GLFW_KEY_TAB}};
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
    press.key = static_cast<unsigned char>(rest[0]);  // GLFW's numbers of these are ASCII
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

const Command* command_for(const KeyPress& press, const Desk& desk) {
  for (const Command& command : command_table()) {
    std::istringstream keys(command.keys_of(desk));
    for (std::string key; keys >> key;)
      if (parse_key(key) == press) return &command;
  }
  return nullptr;
}

}  // namespace rebake
