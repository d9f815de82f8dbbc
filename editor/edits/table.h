#pragma once

#include <string_view>
#include <variant>

#include "editor/edits/background.h"
#include "editor/edits/bend.h"
#include "editor/edits/cage.h"
#include "editor/edits/delete_selected.h"
#include "editor/edits/duplicate.h"
#include "editor/edits/erase.h"
#include "editor/edits/fill.h"
#include "editor/edits/group.h"
#include "editor/edits/grow.h"
#include "editor/edits/handles.h"
#include "editor/edits/hide.h"
#include "editor/edits/import.h"
#include "editor/edits/lock.h"
#include "editor/edits/merge.h"
#include "editor/edits/remove.h"
#include "editor/edits/rename.h"
#include "editor/edits/reorder.h"
#include "editor/edits/select.h"
#include "editor/edits/select_connected.h"
#include "editor/edits/select_floaters.h"
#include "editor/edits/select_folded.h"
#include "editor/edits/select_like.h"
#include "editor/edits/select_picture.h"
#include "editor/edits/select_triangles.h"
#include "editor/edits/select_unneeded.h"
#include "editor/edits/separate.h"
#include "editor/edits/show.h"
#include "editor/edits/shrink.h"
#include "editor/edits/store_selection.h"
#include "editor/edits/stretch.h"
#include "editor/edits/taper.h"
#include "editor/edits/transform.h"
#include "editor/edits/twist.h"
#include "editor/edits/unlock.h"
#include "editor/edits/view.h"
#include "mesh_ops/progress.h"

namespace rebake {

/// The one table of edits: everything that changes a scene.
using Edit =
    std::variant<Import, Remove, Rename, Duplicate, Group, Reorder, Show, Hide, Lock, Unlock, StoreView, Background,
                 Transform, Select, SelectPicture, SelectConnected, SelectLike, SelectFloaters, SelectUnneeded,
                 SelectTriangles, SelectFolded, Grow, Shrink, Fill, StoreSelection, DeleteSelected, Separate, Merge,
                 Erase, CageDeform, HandlesDeform, Bend, Twist, Taper, Stretch>;

/// Whether an edit does nothing but change the selection.
template <class T>
constexpr bool changes_selection() {
  return std::string_view(T::op).starts_with("select") || std::is_same_v<T, Grow> || std::is_same_v<T, Shrink> ||
         std::is_same_v<T, Fill>;
}

/// Pure and deterministic: the scene after the edit. Throws Error and leaves nothing changed. Edits that can take long
/// take a Progress themselves, and throw Cancelled when it says so.
Scene apply(const Scene& scene, const Edit& edit, const Progress& progress = {});

/// Reads an edit from its JSON object. Names of nodes are looked up in `scene`. Throws FieldError.
Edit read_edit(const nlohmann::json& object, const Scene& scene);

/// One JSON object, node numbers in place of names.
nlohmann::json to_json(const Edit& edit);

}  // namespace rebake
