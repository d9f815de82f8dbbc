#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesh_ops/error.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A node named in a field: by its name, or by its number as the journal writes it.
struct NodeRef {
  NodeId id = NodeId::none;
};

/// A rotation as {"axis": [x, y, z], "degrees": d} or as a quaternion [w, x, y, z].
struct Rotation {
  Eigen::Quaterniond value = Eigen::Quaterniond::Identity();
};

/// A scale as one number or three.
struct Scale {
  Vec3 value{1, 1, 1};
};

struct BoxRegion {
  Vec3 min, max;
};
struct SphereRegion {
  Vec3 center;
  double radius = 0;
};
/// Points x with normal · (x − point) ≥ 0.
struct HalfSpaceRegion {
  Vec3 point, normal;
};

/// Corners of a polygon in pixels, x to the right and y down.
struct PixelPolygon {
  std::vector<Vec2> corners;
};
/// A round brush drawn through points, in pixels.
struct BrushStroke {
  std::vector<Vec2> points;
  double radius = 0;
};
/// Numbers from min to max.
struct Interval {
  double min = 0, max = 0;
};
/// Whole numbers from 0 on, as ranges that include both ends.
struct NumberRanges {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> ranges;
};
struct PixelSize {
  int width = 800, height = 800;
};

enum class SelectMode { set, add, remove, intersect };
enum class CoordinateFrame { world, node, bounds };

enum class Need { required, optional };

/// How a type of field is written in JSON, and what it is called in help. Reading throws Error with what was expected.
template <class T>
struct Codec;

#define REBAKE_CODEC(Type)                                             \
  template <>                                                          \
  struct Codec<Type> {                                                 \
    static const char* type();                                         \
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
REBAKE_CODEC(PixelPolygon);
REBAKE_CODEC(BrushStroke);
REBAKE_CODEC(Interval);
REBAKE_CODEC(NumberRanges);
REBAKE_CODEC(PixelSize);
REBAKE_CODEC(std::vector<std::string>);
REBAKE_CODEC(SelectMode);
REBAKE_CODEC(CoordinateFrame);
REBAKE_CODEC(Axes);
REBAKE_CODEC(Layout);
REBAKE_CODEC(Camera);
#undef REBAKE_CODEC

template <class T>
struct Codec<std::optional<T>> {
  static const char* type() { return Codec<T>::type(); }
  static std::optional<T> read(const nlohmann::json& value, const Scene& scene) { return Codec<T>::read(value, scene); }
  static nlohmann::json write(const std::optional<T>& value) {
    return value ? Codec<T>::write(*value) : nlohmann::json();
  }
};

/// Reads the fields that a struct describes from one JSON object. Node names are looked up in `scene`.
class FieldReader {
 public:
  FieldReader(const nlohmann::json& object, const Scene& scene) : object_(object), scene_(scene) {}

  template <class T>
  void operator()(const char* name, T& value, Need need, const char* /*help*/) {
    known_.emplace_back(name);
    const auto found = object_.find(name);
    if (found == object_.end()) {
      if (need == Need::required) throw FieldError(name, "is missing");
      return;
    }
    try {
      value = Codec<T>::read(*found, scene_);
    } catch (const FieldError&) {
      throw;
    } catch (const Error& error) {
      throw FieldError(name, error.what());
    }
  }
  /// Throws FieldError for a field that nothing has read, suggesting the nearest known one.
  void finish() const;

 private:
  const nlohmann::json& object_;
  const Scene& scene_;
  std::vector<std::string> known_{"op"};
};

/// Writes all fields that have a value.
class FieldWriter {
 public:
  explicit FieldWriter(nlohmann::json& object) : object_(object) {}
  template <class T>
  void operator()(const char* name, const T& value, Need /*need*/, const char* /*help*/) {
    nlohmann::json written = Codec<T>::write(value);
    if (!written.is_null()) object_[name] = std::move(written);
  }

 private:
  nlohmann::json& object_;
};

/// Lists fields for help.
struct FieldLine {
  std::string name, type, initial, help;
  bool required;
};
class FieldLister {
 public:
  explicit FieldLister(std::vector<FieldLine>& lines) : lines_(lines) {}
  template <class T>
  void operator()(const char* name, const T& value, Need need, const char* help) {
    const nlohmann::json initial = Codec<T>::write(value);
    lines_.push_back({name, Codec<T>::type(), need == Need::required || initial.is_null() ? "" : initial.dump(), help,
                      need == Need::required});
  }

 private:
  std::vector<FieldLine>& lines_;
};

/// The word of `known` that is most like `word`, for suggestions; empty when none is.
std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace rebake
