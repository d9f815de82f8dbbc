#pragma once

#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "editor/cli/subcommand.h"
#include "editor/fields/field_info.h"

namespace rebake {

/// Options of a subcommand for the fields of an action: "page_size" becomes --page-size. Help, choices and defaults
/// are those of the fields.
class FieldOptions {
 public:
  /// Adds an option for each field that is not in `left_out`. This object must outlive the subcommand's parsing.
  void add_to(SubcommandDescription& command, const std::vector<FieldInfo>& fields,
              const std::set<std::string>& left_out);
  /// The fields that were given, as an action's JSON object without `op`.
  nlohmann::json object() const;

 private:
  struct Value {
    FieldKind kind = FieldKind::other;
    std::string text;               ///< as given; empty: not given
    std::vector<std::string> list;  ///< as given, for FieldKind::nodes and names
    bool set = false;               ///< for FieldKind::flag
  };
  std::map<std::string, Value> values_;
};

}  // namespace rebake
