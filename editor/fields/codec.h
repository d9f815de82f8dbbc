#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "editor/fields/values.h"
#include "mesh_ops/features/distill/fuse_method.h"
#include "mesh_ops/scene/photo_camera.h"

namespace rebake {

enum class CaptureKind;

/// Kinds of fields, for forms and parsers.
enum class FieldKind {
  flag,
  whole_number,
  number,
  text,
  choice,
  node,
  nodes,
  names,
  other  ///< a JSON value
};
/// Type of a field, as help, forms and Python show it.
struct FieldType {
  FieldKind kind = FieldKind::other;
  std::string words;                 ///< notation, for help texts: "[x, y, z]"
  std::string python;                ///< type annotation in Python
  std::vector<std::string> choices;  ///< allowed words, if kind is choice
};
/// The type of a field that takes one of these words.
FieldType choice_type(std::vector<std::string> choices);

/// Conversion of a field type to and from JSON, specialised per type. read() throws Error with the expected form; it
/// reads the result of write() back to the same bits. `scene` resolves node names.
template <class T>
struct Codec;

/// Declares the specialisation Codec<Type>.
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
REBAKE_CODEC(AxisDirection);
REBAKE_CODEC(PolyLine);
REBAKE_CODEC(PixelPolygon);
REBAKE_CODEC(BrushStroke);
REBAKE_CODEC(Interval);
REBAKE_CODEC(NumberRanges);
REBAKE_CODEC(PixelSize);
REBAKE_CODEC(RareFlag);
REBAKE_CODEC(FormatName);
REBAKE_CODEC(CameraFormatName);
REBAKE_CODEC(Interpolation);
REBAKE_CODEC(WorldUp);
REBAKE_CODEC(CaptureKind);
REBAKE_CODEC(FuseWidth);
REBAKE_CODEC(FuseMethod);
REBAKE_CODEC(PosingEdits);
REBAKE_CODEC(std::vector<std::string>);
REBAKE_CODEC(std::vector<int>);
REBAKE_CODEC(SelectMode);
REBAKE_CODEC(CoordinateFrame);
REBAKE_CODEC(Axes);
REBAKE_CODEC(AlphaCode);
REBAKE_CODEC(Layout);
REBAKE_CODEC(Camera);

/// The most similar word of `known` by Levenshtein distance, for suggestions; empty if none is near.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace rebake
