#include "mesh_ops/formats/mobilenerf/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace rebake {

namespace {

// End of the string that begins with the quote at `at`: the byte after its closing quote, or the text's end.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  for (++at; at < text.size(); ++at) {
    if (text[at] == '\\')
      ++at;
    else if (text[at] == '"')
      return at + 1;
  }
  return text.size();
}

std::size_t skip_space(std::string_view text, std::size_t at) {
  const std::size_t found = text.find_first_not_of(" \t\r\n", at);
  return found == std::string_view::npos ? text.size() : found;
}

// End of the value that begins at `at`; for a number or word, the next delimiter.
std::size_t end_of_value(std::string_view text, std::size_t at) {
  std::size_t depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '"') {
      at = end_of_string(text, at);
      if (depth == 0) return at;
      continue;
    }
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') {
      if (depth == 0) return at;
      if (--depth == 0) return at + 1;
    } else if (depth == 0 && (c == ',' || c == ' ' || c == '\n' || c == '\r' || c == '\t')) {
      return at;
    }
    ++at;
  }
  return at;
}

}  // namespace

TrimmedJson without_trailing_commas(std::string_view text) {
  TrimmedJson trimmed{std::string(text), 0, 0};
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '"') {
      at = end_of_string(text, at) - 1;
      continue;
    }
    if (text[at] != ',') continue;
    const std::size_t next = skip_space(text, at + 1);
    if (next == text.size() || (text[next] != ']' && text[next] != '}')) continue;
    trimmed.text[at] = ' ';
    if (trimmed.commas++ == 0)
      trimmed.first_line =
          1 + static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  }
  return trimmed;
}

std::map<std::string, std::string> json_members(std::string_view text) {
  std::map<std::string, std::string> members;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  std::size_t at = skip_space(text, text.starts_with(byte_order_mark) ? byte_order_mark.size() : 0);
  if (at == text.size() || text[at] != '{') return members;
  ++at;
  for (;;) {
    at = skip_space(text, at);
    if (at >= text.size() || text[at] != '"') return members;
    const std::size_t key_end = end_of_string(text, at);
    const std::string key(text.substr(at + 1, key_end - at - 2));
    at = skip_space(text, key_end) + 1;  // the byte after the colon
    at = skip_space(text, at);
    const std::size_t end = end_of_value(text, at);
    members[key] = text.substr(at, end - at);
    at = skip_space(text, end);
    if (at >= text.size() || text[at] != ',') return members;
    ++at;
  }
}

std::string json_path(std::string_view text, std::size_t byte) {
  struct Level {
    bool is_object;
    std::string key;
    std::size_t index;
  };
  std::vector<Level> levels;
  bool is_key = false;
  for (std::size_t at = 0; at < std::min(byte, text.size());) {
    const char c = text[at];
    if (c == '"') {
      const std::size_t end = end_of_string(text, at);
      if (is_key && !levels.empty()) levels.back().key = text.substr(at, end - at);
      at = end;
      continue;
    }
    if (c == '{' || c == '[') {
      levels.push_back({c == '{', "", 0});
      is_key = c == '{';
    } else if ((c == '}' || c == ']') && !levels.empty()) {
      levels.pop_back();
    } else if (c == ',' && !levels.empty()) {
      ++levels.back().index;
      is_key = levels.back().is_object;
    } else if (c == ':') {
      is_key = false;
    }
    ++at;
  }
  std::string place;
  for (const Level& level : levels)
    place += level.is_object ? (place.empty() ? level.key : "." + level.key) : fmt::format("[{}]", level.index);
  return place;
}

}  // namespace rebake
