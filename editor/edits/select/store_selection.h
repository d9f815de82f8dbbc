#pragma once

#include "editor/edits/select/selecting.h"

namespace rebake {

/// Stores the present selection of all nodes under a name, for Select::saved. Replaces a stored selection of that name.
struct StoreSelection {
  static constexpr const char* op = "store_selection";
  static constexpr const char* done = "Stored the selection";
  std::string name;
};
template <>
const EditType& edit_type<StoreSelection>();

Scene apply(const Scene& scene, const StoreSelection& edit);

}  // namespace rebake
