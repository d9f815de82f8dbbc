#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/values.h"
#include "mesh_ops/features/fuse_way.h"

namespace rebake {

/// What a field holds, for whoever reads, shows or asks for one.
enum class FieldKind {
  flag,
  whole_number,
  number,
  text,
  choice,
  node,
  nodes,
  other  ///< written as JSON
};
struct FieldType {
  FieldKind kind = FieldKind::other;
  std::string words;                 ///< how it is written, for people
  std::string python;                ///< its type in Python
  std::vector<std::string> choices;  ///< of a choice: all that it can be
};
/// A choice of words.
FieldType choice_type(std::vector<std::string> choices);

/// How a type of field is written in JSON, and what it is. Reading throws Error with what was expected. What write()
/// gives is read back to the same bits.
template <class T>
struct Codec;

#define REBAKE_CODEC(Type)                                             \
  template <>                                                          \
  struct Codec<Type> {                                                 \
    static FieldType type();                                           \
    static Type read(const nlohmann::json& value, const Scene& scene); \
    static nlohmann::json write(const Type& value);                    \
  }
REBAKE_CODEC(bool);
REBAKE_CODEC(int);
REBAKE_CODEC(double);
REBAKE_CODEC(std::string);
REBAKE_CODEC(Vec3);
REBAKE_CODEC(NodeRef);
REBAKE_CODEC(std::vector<NodeRef>);
REBAKE_CODEC(Rotation);
REBAKE_CODEC(Scale);
REBAKE_CODEC(BoxRegion);
REBAKE_CODEC(SphereRegion);
REBAKE_CODEC(HalfSpaceRegion);
REBAKE_CODEC(PolyLine);
REBAKE_CODEC(PixelPolygon);
REBAKE_CODEC(BrushStroke);
REBAKE_CODEC(Interval);
REBAKE_CODEC(NumberRanges);
REBAKE_CODEC(PixelSize);
REBAKE_CODEC(FuseWidth);
REBAKE_CODEC(FuseWay);
REBAKE_CODEC(std::vector<std::string>);
REBAKE_CODEC(std::vector<int>);
REBAKE_CODEC(SelectMode);
REBAKE_CODEC(CoordinateFrame);
REBAKE_CODEC(Axes);
REBAKE_CODEC(Layout);
REBAKE_CODEC(Camera);

/// The word of `known` that is most like `word`, for suggestions; empty when none is.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace rebake
