#include "editor/actions/action.h"

// Table of all actions, in help order.
#define REBAKE_ACTIONS(X)     \
  X(RenderAction)             \
  X(FilmAction)               \
  X(ComparePhotographsAction) \
  X(TrainAction)              \
  X(TrainLightAction)         \
  X(UseLightModelAction)      \
  X(ForgetLightModelAction)   \
  X(ExportAction) X(PublishAction) X(SaveAction) X(SaveProjectAction) X(ExportViewsAction) X(UndoAction) X(RedoAction)

namespace rebake {

#define REBAKE_DECLARE(Type) \
  struct Type;               \
  template <>                \
  const ActionType& action_type<Type>();
REBAKE_ACTIONS(REBAKE_DECLARE)
#undef REBAKE_DECLARE

std::span<const ActionType* const> action_types() {
#define REBAKE_ENTRY(Type) &action_type<Type>(),
  static const ActionType* const table[] = {REBAKE_ACTIONS(REBAKE_ENTRY)};
#undef REBAKE_ENTRY
  return table;
}

}  // namespace rebake
