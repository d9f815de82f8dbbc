#pragma once

namespace rebake::icons {

// UTF-8 code points of the Material Design Icons font (Debian: fonts-materialdesignicons-webfont 1.6), by icon name.
constexpr const char* cursor_default = "\xEF\x86\xB4";
constexpr const char* selection = "\xEF\x92\x89";
constexpr const char* vector_selection = "\xEF\x95\xA2";
constexpr const char* vector_polygon = "\xEF\x95\xA0";
constexpr const char* brush = "\xEF\x83\xA3";
constexpr const char* format_color_fill = "\xEF\x89\xA6";
constexpr const char* eraser = "\xEF\x87\xBE";
constexpr const char* cursor_move = "\xEF\x86\xB6";
constexpr const char* rotate_3d = "\xEF\x91\xA4";
constexpr const char* arrow_expand_all = "\xEF\x81\x8C";
constexpr const char* cube_unfolded = "\xEF\x86\xA9";
constexpr const char* vector_curve = "\xEF\x95\x99";
constexpr const char* pin = "\xEF\x90\x83";
constexpr const char* eye = "\xEF\x88\x88";
constexpr const char* eye_off = "\xEF\x88\x89";
constexpr const char* lock = "\xEF\x8C\xBE";
constexpr const char* lock_open_outline = "\xEF\x8D\x80";
constexpr const char* folder_outline = "\xEF\x89\x96";
constexpr const char* folder = "\xEF\x89\x8B";
constexpr const char* cube_outline = "\xEF\x86\xA7";
constexpr const char* undo = "\xEF\x95\x8C";
constexpr const char* redo = "\xEF\x91\x8E";
constexpr const char* magnify = "\xEF\x8D\x89";
constexpr const char* content_copy = "\xEF\x86\x8F";
constexpr const char* trash = "\xEF\x87\x80";
constexpr const char* group = "\xEF\x8B\x83";
constexpr const char* minus = "\xEF\x8D\xB4";
constexpr const char* plus = "\xEF\x90\x95";
constexpr const char* close = "\xEF\x85\x96";
constexpr const char* check = "\xEF\x84\xAC";
constexpr const char* alert = "\xEF\x80\xA6";
constexpr const char* alert_circle = "\xEF\x80\xA8";
constexpr const char* information_outline = "\xEF\x8B\xBD";
constexpr const char* chevron_down = "\xEF\x85\x80";
constexpr const char* chevron_right = "\xEF\x85\x82";
constexpr const char* chevron_left = "\xEF\x85\x81";
constexpr const char* chevron_up = "\xEF\x85\x83";
constexpr const char* dots_vertical = "\xEF\x87\x99";
constexpr const char* dots_horizontal = "\xEF\x87\x98";
constexpr const char* history = "\xEF\x8B\x9A";
constexpr const char* weather_sunny = "\xEF\x96\x99";
constexpr const char* script = "\xEF\x91\xB8";
constexpr const char* chart_line = "\xEF\x84\xAA";
constexpr const char* message_text = "\xEF\x8D\xA9";
constexpr const char* theme_light_dark = "\xEF\x94\x8E";
constexpr const char* help_circle_outline = "\xEF\x98\xA5";
constexpr const char* keyboard = "\xEF\x8C\x8C";
constexpr const char* layers = "\xEF\x8C\xA8";
constexpr const char* grid = "\xEF\x8B\x81";
constexpr const char* camera = "\xEF\x84\x80";
constexpr const char* compare = "\xEF\x86\x8A";
constexpr const char* flip_to_front = "\xEF\x89\x88";
constexpr const char* home = "\xEF\x8B\x9C";
constexpr const char* file_outline = "\xEF\x88\xA4";
constexpr const char* file = "\xEF\x88\x94";
constexpr const char* arrow_up = "\xEF\x81\x9D";
constexpr const char* magnet = "\xEF\x8D\x87";
constexpr const char* checkbox_blank_circle_outline = "\xEF\x84\xB0";
constexpr const char* vector_union = "\xEF\x95\xA4";
constexpr const char* call_merge = "\xEF\x83\xB8";
constexpr const char* export_icon = "\xEF\x88\x87";
constexpr const char* content_save = "\xEF\x86\x93";
constexpr const char* target = "\xEF\x93\xBE";
constexpr const char* layers_off = "\xEF\x8C\xA9";
constexpr const char* image = "\xEF\x8B\xA9";
constexpr const char* image_multiple = "\xEF\x8B\xB9";
constexpr const char* package_variant = "\xEF\x8F\x96";
constexpr const char* ruler = "\xEF\x91\xAD";
constexpr const char* vector_point = "\xEF\x95\x9F";
constexpr const char* filmstrip = "\xEF\x88\xB0";

}  // namespace rebake::icons
