#include "editor/cli/field_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace rebake {

namespace {

std::string option_name(std::string field) {
  std::replace(field.begin(), field.end(), '_', '-');
  return "--" + field;
}

// Placeholder of the option's value with its default: "N [800]".
std::string hint_of(const FieldInfo& field) {
  std::string words = "JSON";
  if (field.type.kind == FieldKind::choice) words = fmt::format("{}", fmt::join(field.type.choices, "|"));
  if (field.type.kind == FieldKind::whole_number) words = "N";
  if (field.type.kind == FieldKind::number) words = "NUMBER";
  if (field.type.kind == FieldKind::text) words = "TEXT";
  if (field.type.kind == FieldKind::nodes) words = "NODE...";
  if (field.type.kind == FieldKind::names) words = "NAME...";
  if (field.type.kind == FieldKind::other) words = field.type.words;
  const nlohmann::json initial = field.initial.empty() ? nlohmann::json() : nlohmann::json::parse(field.initial);
  if (initial.is_null() || initial == "") return words;
  return fmt::format("{} [{}]", words, initial.is_string() ? initial.get<std::string>() : initial.dump());
}

// A number as people write it ("+5", ".5", "016"), or the text; the field's own error describes values that it does not
// take.
nlohmann::json number_or_text(const std::string& text) {
  const char *first = text.data() + (text.starts_with('+') ? 1 : 0), *const last = text.data() + text.size();
  std::int64_t whole = 0;
  if (const auto read = std::from_chars(first, last, whole); read.ec == std::errc() && read.ptr == last) return whole;
  double number = 0;
  if (const auto read = std::from_chars(first, last, number); read.ec == std::errc() && read.ptr == last) return number;
  return text;
}

// An object or list as JSON; otherwise as number_or_text().
nlohmann::json json_or_text(const std::string& text) {
  nlohmann::json value = nlohmann::json::parse(text, nullptr, false);
  return value.is_structured() ? value : number_or_text(text);
}

}  // namespace

void FieldOptions::add_to(SubcommandDescription& command, const std::vector<FieldInfo>& fields,
                          const std::set<std::string>& left_out) {
  for (const FieldInfo& field : fields) {
    if (left_out.contains(field.name)) continue;
    Value& value = values_[field.name];
    value.kind = field.type.kind;
    const std::string name = option_name(field.name);
    if (value.kind == FieldKind::flag) {
      command.flag(name, value.set, field.help);
    } else if (value.kind == FieldKind::nodes || value.kind == FieldKind::names) {
      command.option(name, value.list, field.help, hint_of(field));
    } else {
      auto option = command.option(name, value.text, field.help, hint_of(field));
      option.not_empty();
      if (value.kind == FieldKind::choice) option.one_of(field.type.choices);
    }
  }
}

nlohmann::json FieldOptions::object() const {
  nlohmann::json object = nlohmann::json::object();
  for (const auto& [name, value] : values_) {
    if (value.set) object[name] = true;
    if (!value.list.empty()) object[name] = value.list;
    if (value.text.empty()) continue;
    const bool is_text = value.kind == FieldKind::text || value.kind == FieldKind::choice;
    object[name] = is_text ? nlohmann::json(value.text) : json_or_text(value.text);
  }
  return object;
}

}  // namespace rebake
