#include "editor/fields/visitors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mesh_ops/base/elementary.h"
#include "mesh_ops/formats/cameras/camera_formats.h"
#include "mesh_ops/formats/cameras/camera_json.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/reconstruction/grid_space.h"

namespace rebake {

using nlohmann::json;

namespace {

double number(const json& value) {
  if (!value.is_number()) throw Error("must be a number");
  const double result = value.get<double>();
  if (!std::isfinite(result)) throw Error("must be finite");
  return result;
}

Vec3 vector(const json& value) {
  if (!value.is_array() || value.size() != 3) throw Error("must be a list of three numbers");
  return {number(value[0]), number(value[1]), number(value[2])};
}

json list(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

std::vector<Vec2> points(const json& value, std::size_t least) {
  if (!value.is_array() || value.size() < least)
    throw Error(fmt::format("must be a list of at least {} points [x, y]", least));
  std::vector<Vec2> result;
  for (const json& point : value) {
    if (!point.is_array() || point.size() != 2) throw Error("a point must be a list of two numbers");
    result.emplace_back(number(point[0]), number(point[1]));
  }
  return result;
}

json list(const std::vector<Vec2>& points) {
  json out = json::array();
  for (const Vec2& p : points) out.push_back({p.x(), p.y()});
  return out;
}

const json& part(const json& value, const char* key, std::initializer_list<const char*> all) {
  const std::string shape = fmt::format("must be an object with {}", fmt::join(all, " and "));
  if (!value.is_object() || value.size() != all.size()) throw Error(shape);
  const auto found = value.find(key);
  if (found == value.end()) throw Error(shape);
  return *found;
}

// The words of an enumeration: one table serves reading, writing and help.
template <class E>
using Words = std::vector<std::pair<const char*, E>>;

template <class E>
FieldType type_of(const Words<E>& words) {
  std::vector<std::string> choices;
  for (const auto& [text, meaning] : words) choices.emplace_back(text);
  return choice_type(choices);
}

template <class E>
E read_word(const json& value, const Words<E>& words) {
  std::string all;
  for (const auto& [text, meaning] : words) {
    if (value == text) return meaning;
    all += (all.empty() ? "" : ", ") + std::string(text);
  }
  throw Error("must be one of " + all);
}

template <class E>
json write_word(E value, const Words<E>& words) {
  return std::ranges::find(words, value, [](const auto& word) { return word.second; })->first;
}

const Words<FuseMethod>& fuse_method_words() {
  static const Words<FuseMethod> words{{"keep", FuseMethod::keep},
                                       {"train", FuseMethod::train},
                                       {"new", FuseMethod::scratch},
                                       {"side_by_side", FuseMethod::side_by_side}};
  return words;
}

const Words<SelectMode>& select_mode_words() {
  static const Words<SelectMode> words{{"set", SelectMode::set},
                                       {"add", SelectMode::add},
                                       {"remove", SelectMode::remove},
                                       {"intersect", SelectMode::intersect}};
  return words;
}

const Words<CoordinateFrame>& frame_words() {
  static const Words<CoordinateFrame> words{
      {"world", CoordinateFrame::world}, {"node", CoordinateFrame::node}, {"bounds", CoordinateFrame::bounds}};
  return words;
}

const Words<Interpolation>& interpolation_words() {
  static const Words<Interpolation> words{
      {"smooth", Interpolation::smooth}, {"linear", Interpolation::linear}, {"step", Interpolation::step}};
  return words;
}

const Words<CaptureKind>& capture_kind_words() {
  static const Words<CaptureKind> words{
      {"object", CaptureKind::object}, {"forward", CaptureKind::forward}, {"unbounded", CaptureKind::unbounded}};
  return words;
}
const Words<WorldUp>& world_up_words() {
  static const Words<WorldUp> words{{"y_up", WorldUp::y}, {"z_up", WorldUp::z}};
  return words;
}

const Words<AlphaCode>& alpha_code_words() {
  static const Words<AlphaCode> words{{"halved", AlphaCode::halved}, {"plain", AlphaCode::plain}};
  return words;
}

const Words<Axes>& axes_words() {
  static const Words<Axes> words{{"360", Axes::y_up}, {"forward", Axes::forward}};
  return words;
}

const Words<Layout>& layout_words() {
  static const Words<Layout> words{
      {"split", Layout::split}, {"chunked", Layout::chunked}, {"unsplit", Layout::unsplit}};
  return words;
}

}  // namespace

FieldType Codec<bool>::type() { return {FieldKind::flag, "true or false", "bool", {}}; }
bool Codec<bool>::read(const json& value, const Scene&) {
  if (!value.is_boolean()) throw Error("must be true or false");
  return value.get<bool>();
}
json Codec<bool>::write(const bool& value) { return value; }

FieldType Codec<int>::type() { return {FieldKind::whole_number, "whole number", "int", {}}; }
int Codec<int>::read(const json& value, const Scene&) {
  if (!value.is_number_integer() || value.get<std::int64_t>() < -2147483647 || value.get<std::int64_t>() > 2147483647)
    throw Error("must be a whole number");
  return value.get<int>();
}
json Codec<int>::write(const int& value) { return value; }

FieldType Codec<double>::type() { return {FieldKind::number, "number", "float", {}}; }
double Codec<double>::read(const json& value, const Scene&) { return number(value); }
json Codec<double>::write(const double& value) { return value; }

FieldType Codec<std::string>::type() { return {FieldKind::text, "text", "str", {}}; }
std::string Codec<std::string>::read(const json& value, const Scene&) {
  if (!value.is_string()) throw Error("must be text");
  return value.get<std::string>();
}
json Codec<std::string>::write(const std::string& value) { return value; }

FieldType Codec<Vec3>::type() { return {FieldKind::other, "[x, y, z]", "Vector", {}}; }
Vec3 Codec<Vec3>::read(const json& value, const Scene&) { return vector(value); }
json Codec<Vec3>::write(const Vec3& value) { return list(value); }

FieldType Codec<NodeRef>::type() { return {FieldKind::node, "node", "Node", {}}; }
NodeRef Codec<NodeRef>::read(const json& value, const Scene& scene) {
  if (value.is_string()) {
    const auto& name = value.get_ref<const std::string&>();
    if (const NodePtr node = find(scene, name)) return {node->id};
    std::vector<std::string> names;
    for (const PlacedNode& placed : placed_nodes(scene)) names.push_back(placed.node->name);
    const std::string near = nearest_word(name, names);
    throw Error(fmt::format("there is no node \"{}\"{}", name,
                            names.empty()   ? " (the scene is empty)"
                            : !near.empty() ? fmt::format("; did you mean \"{}\"?", near)
                                            : fmt::format("; the nodes are {}", fmt::join(names, ", "))));
  }
  if (value.is_number_unsigned()) {
    const NodeId id{value.get<std::uint64_t>()};
    if (find(scene, id) == nullptr) throw Error(fmt::format("there is no node with id {}", value.get<std::uint64_t>()));
    return {id};
  }
  throw Error("must be the name of a node");
}
json Codec<NodeRef>::write(const NodeRef& value) {
  return value.id == NodeId::none ? json() : json(static_cast<std::uint64_t>(value.id));
}

FieldType Codec<std::vector<NodeRef>>::type() { return {FieldKind::nodes, "list of nodes", "Sequence[Node]", {}}; }
std::vector<NodeRef> Codec<std::vector<NodeRef>>::read(const json& value, const Scene& scene) {
  if (!value.is_array() || value.empty()) throw Error("must be a list of node names");
  std::vector<NodeRef> nodes;
  for (const json& entry : value) nodes.push_back(Codec<NodeRef>::read(entry, scene));
  return nodes;
}
json Codec<std::vector<NodeRef>>::write(const std::vector<NodeRef>& value) {
  json out;
  for (const NodeRef& node : value) out.push_back(Codec<NodeRef>::write(node));
  return out;
}

FieldType Codec<Rotation>::type() {
  return {FieldKind::other, "{\"axis\": [x, y, z], \"degrees\": d} or quaternion [w, x, y, z]", "Rotation", {}};
}
Rotation Codec<Rotation>::read(const json& value, const Scene&) {
  if (value.is_array()) {
    if (value.size() != 4) throw Error("a quaternion has four numbers: w, x, y, z");
    const Eigen::Quaterniond q(number(value[0]), number(value[1]), number(value[2]), number(value[3]));
    return Rotation(q);
  }
  const Vec3 axis = vector(part(value, "axis", {"axis", "degrees"}));
  const double degrees = number(part(value, "degrees", {"axis", "degrees"}));
  if (axis.isZero(0)) throw Error("the axis has no direction");
  const auto half = elementary::sine_cosine(std::remainder(degrees, 360.0) * std::numbers::pi / 360);
  const Vec3 across = half.sine * axis.stableNormalized();
  return Rotation(Eigen::Quaterniond(half.cosine, across.x(), across.y(), across.z()));
}
json Codec<Rotation>::write(const Rotation& value) {
  const Eigen::Quaterniond& q = value.quaternion();
  return {q.w(), q.x(), q.y(), q.z()};
}

FieldType Codec<Scale>::type() { return {FieldKind::other, "number or [x, y, z]", "float | Vector", {}}; }
Scale Codec<Scale>::read(const json& value, const Scene&) {
  const Vec3 scale = value.is_number() ? Vec3::Constant(number(value)) : vector(value);
  if ((scale.array() == 0).any()) throw Error("a scale factor must not be 0");
  return {scale};
}
json Codec<Scale>::write(const Scale& value) { return list(value.value); }

FieldType Codec<BoxRegion>::type() { return {FieldKind::other, "{\"min\": [x, y, z], \"max\": [x, y, z]}", "Box", {}}; }
BoxRegion Codec<BoxRegion>::read(const json& value, const Scene&) {
  return {vector(part(value, "min", {"min", "max"})), vector(part(value, "max", {"min", "max"}))};
}
json Codec<BoxRegion>::write(const BoxRegion& value) { return {{"min", list(value.min)}, {"max", list(value.max)}}; }

FieldType Codec<SphereRegion>::type() {
  return {FieldKind::other, "{\"center\": [x, y, z], \"radius\": r}", "Sphere", {}};
}
SphereRegion Codec<SphereRegion>::read(const json& value, const Scene&) {
  const SphereRegion sphere{vector(part(value, "center", {"center", "radius"})),
                            number(part(value, "radius", {"center", "radius"}))};
  if (sphere.radius < 0) throw Error("the radius is negative");
  return sphere;
}
json Codec<SphereRegion>::write(const SphereRegion& value) {
  return {{"center", list(value.center)}, {"radius", value.radius}};
}

FieldType Codec<HalfSpaceRegion>::type() {
  return {FieldKind::other, "{\"point\": [x, y, z], \"normal\": [x, y, z]}", "HalfSpace", {}};
}
HalfSpaceRegion Codec<HalfSpaceRegion>::read(const json& value, const Scene&) {
  const HalfSpaceRegion half{vector(part(value, "point", {"point", "normal"})),
                             vector(part(value, "normal", {"point", "normal"}))};
  if (half.normal.isZero(0)) throw Error("the normal has no direction");
  return half;
}
json Codec<HalfSpaceRegion>::write(const HalfSpaceRegion& value) {
  return {{"point", list(value.point)}, {"normal", list(value.normal)}};
}

FieldType Codec<PolyLine>::type() { return {FieldKind::other, "[[x, y, z], …]", "Sequence[Sequence[float]]", {}}; }
PolyLine Codec<PolyLine>::read(const json& value, const Scene& scene) {
  constexpr std::size_t most = 1000;
  if (!value.is_array() || value.size() > most) throw Error("must be a list of at most 1000 points");
  PolyLine line;
  for (const json& point : value) line.points.push_back(Codec<Vec3>::read(point, scene));
  return line;
}
json Codec<PolyLine>::write(const PolyLine& value) {
  json points = json::array();
  for (const Vec3& point : value.points) points.push_back(Codec<Vec3>::write(point));
  return points;
}

FieldType Codec<AxisDirection>::type() {
  return {FieldKind::other, "[x, y, z] or \"auto\"", "Vector | Literal[\"auto\"]", {}};
}
AxisDirection Codec<AxisDirection>::read(const json& value, const Scene&) {
  AxisDirection axis;
  axis.automatic = value == "auto";
  if (value.is_string() && !axis.automatic) throw Error("must be [x, y, z] or \"auto\"");
  if (!axis.automatic) axis.direction = vector(value);
  return axis;
}
json Codec<AxisDirection>::write(const AxisDirection& value) {
  return value.automatic ? json("auto") : list(value.direction);
}

FieldType Codec<PixelPolygon>::type() {
  return {FieldKind::other, "[[x, y], …] in pixels", "Sequence[Sequence[float]]", {}};
}
PixelPolygon Codec<PixelPolygon>::read(const json& value, const Scene&) { return {points(value, 3)}; }
json Codec<PixelPolygon>::write(const PixelPolygon& value) { return list(value.corners); }

FieldType Codec<BrushStroke>::type() {
  return {FieldKind::other, "{\"points\": [[x, y], …], \"radius\": pixels}", "Brush", {}};
}
BrushStroke Codec<BrushStroke>::read(const json& value, const Scene&) {
  const BrushStroke stroke{points(part(value, "points", {"points", "radius"}), 1),
                           number(part(value, "radius", {"points", "radius"}))};
  if (!(stroke.radius > 0)) throw Error("the radius must be positive");
  return stroke;
}
json Codec<BrushStroke>::write(const BrushStroke& value) {
  return {{"points", list(value.points)}, {"radius", value.radius}};
}

FieldType Codec<Interval>::type() { return {FieldKind::other, "[min, max]", "Sequence[float]", {}}; }
Interval Codec<Interval>::read(const json& value, const Scene&) {
  if (!value.is_array() || value.size() != 2) throw Error("must be a list of two numbers: minimum and maximum");
  const Interval interval{number(value[0]), number(value[1])};
  if (interval.min > interval.max) throw Error("the first number must not be above the second");
  return interval;
}
json Codec<Interval>::write(const Interval& value) { return json::array({value.min, value.max}); }

FieldType Codec<NumberRanges>::type() {
  return {FieldKind::other, "list of whole numbers and ranges [first, last]", "Sequence[int | Sequence[int]]", {}};
}
NumberRanges Codec<NumberRanges>::read(const json& value, const Scene&) {
  constexpr const char* expected = "must be a list of non-negative whole numbers or ranges [first, last]";
  if (!value.is_array()) throw Error(expected);
  NumberRanges result;
  for (const json& entry : value) {
    const bool range = entry.is_array() && entry.size() == 2;
    const json& first = range ? entry[0] : entry;
    const json& last = range ? entry[1] : entry;
    if (!first.is_number_unsigned() || !last.is_number_unsigned() || first > last) throw Error(expected);
    result.ranges.emplace_back(first.get<std::uint64_t>(), last.get<std::uint64_t>());
  }
  return result;
}
json Codec<NumberRanges>::write(const NumberRanges& value) {
  json list = json::array();
  for (const auto& [first, last] : value.ranges)
    list.push_back(first == last ? json(first) : json::array({first, last}));
  return list;
}

FieldType Codec<PixelSize>::type() { return {FieldKind::other, "[width, height] in pixels", "Sequence[int]", {}}; }
PixelSize Codec<PixelSize>::read(const json& value, const Scene& scene) {
  if (!value.is_array() || value.size() != 2) throw Error("must be a list of two whole numbers: width and height");
  const PixelSize size{Codec<int>::read(value[0], scene), Codec<int>::read(value[1], scene)};
  if (std::min(size.width, size.height) < 1 || std::max(size.width, size.height) > 16384)
    throw Error("must lie between 1 and 16384 pixels");
  return size;
}
json Codec<PixelSize>::write(const PixelSize& value) { return json::array({value.width, value.height}); }

FieldType Codec<RareFlag>::type() { return Codec<bool>::type(); }
RareFlag Codec<RareFlag>::read(const json& value, const Scene& scene) { return {Codec<bool>::read(value, scene)}; }
json Codec<RareFlag>::write(const RareFlag& value) { return value.set ? json(true) : json(); }

FieldType Codec<FormatName>::type() { return choice_type(written_formats()); }
FormatName Codec<FormatName>::read(const json& value, const Scene& scene) {
  return {format_named(Codec<std::string>::read(value, scene)).name};
}
json Codec<FormatName>::write(const FormatName& value) { return value.name; }

FieldType Codec<CameraFormatName>::type() {
  std::vector<std::string> words = camera_format_names();
  words.insert(words.begin(), "auto");
  return choice_type(std::move(words));
}
CameraFormatName Codec<CameraFormatName>::read(const json& value, const Scene& scene) {
  if (value == "auto") return {};
  return {camera_format_named(Codec<std::string>::read(value, scene)).name};
}
json Codec<CameraFormatName>::write(const CameraFormatName& value) { return value.name.empty() ? "auto" : value.name; }

FieldType Codec<Interpolation>::type() { return type_of(interpolation_words()); }
Interpolation Codec<Interpolation>::read(const json& value, const Scene&) {
  return read_word(value, interpolation_words());
}
json Codec<Interpolation>::write(const Interpolation& value) { return write_word(value, interpolation_words()); }

FieldType Codec<CaptureKind>::type() { return type_of(capture_kind_words()); }
CaptureKind Codec<CaptureKind>::read(const json& value, const Scene&) { return read_word(value, capture_kind_words()); }
json Codec<CaptureKind>::write(const CaptureKind& value) { return write_word(value, capture_kind_words()); }
FieldType Codec<WorldUp>::type() { return type_of(world_up_words()); }
WorldUp Codec<WorldUp>::read(const json& value, const Scene&) { return read_word(value, world_up_words()); }
json Codec<WorldUp>::write(const WorldUp& value) { return write_word(value, world_up_words()); }

FieldType Codec<FuseWidth>::type() {
  return {FieldKind::other, "auto or a whole number from 4 to 256", "int | Literal[\"auto\"]", {}};
}
FuseWidth Codec<FuseWidth>::read(const json& value, const Scene& scene) {
  if (value == "auto") return {};
  if (!value.is_number_integer()) throw Error("must be auto or a whole number from 4 to 256");
  return {Codec<int>::read(value, scene)};
}
json Codec<FuseWidth>::write(const FuseWidth& value) { return value.neurons ? json(*value.neurons) : json(); }

FieldType Codec<FuseMethod>::type() { return type_of(fuse_method_words()); }
FuseMethod Codec<FuseMethod>::read(const json& value, const Scene&) { return read_word(value, fuse_method_words()); }
json Codec<FuseMethod>::write(const FuseMethod& value) { return write_word(value, fuse_method_words()); }

FieldType Codec<PosingEdits>::type() { return {FieldKind::other, "[{\"op\": …}, …]", "Sequence[dict[str, Any]]", {}}; }
PosingEdits Codec<PosingEdits>::read(const json& value, const Scene&) {
  const char* const expected =
      "must be a list of edits, such as [{\"op\": \"bend\", \"degrees\": 60, \"axis\": [0, 1, 0]}]";
  if (!value.is_array() || value.empty()) throw Error(expected);
  PosingEdits edits;
  for (const json& line : value) {
    if (!line.is_object()) throw Error(expected);
    edits.lines.push_back(line.dump());
  }
  return edits;
}
json Codec<PosingEdits>::write(const PosingEdits& value) {
  json list = json::array();
  for (const std::string& line : value.lines) list.push_back(json::parse(line));
  return list;
}

FieldType Codec<std::vector<std::string>>::type() { return {FieldKind::names, "list of names", "Sequence[str]", {}}; }
std::vector<std::string> Codec<std::vector<std::string>>::read(const json& value, const Scene& scene) {
  if (!value.is_array()) throw Error("must be a list of names");
  if (value.empty()) throw Error("must contain at least one name");
  std::vector<std::string> names;
  for (const json& name : value) names.push_back(Codec<std::string>::read(name, scene));
  return names;
}
json Codec<std::vector<std::string>>::write(const std::vector<std::string>& value) {
  return value.empty() ? json() : json(value);
}

FieldType Codec<SelectMode>::type() { return type_of(select_mode_words()); }
SelectMode Codec<SelectMode>::read(const json& value, const Scene&) { return read_word(value, select_mode_words()); }
json Codec<SelectMode>::write(const SelectMode& value) { return write_word(value, select_mode_words()); }

FieldType Codec<CoordinateFrame>::type() { return type_of(frame_words()); }
CoordinateFrame Codec<CoordinateFrame>::read(const json& value, const Scene&) {
  return read_word(value, frame_words());
}
json Codec<CoordinateFrame>::write(const CoordinateFrame& value) { return write_word(value, frame_words()); }

FieldType Codec<Axes>::type() { return type_of(axes_words()); }
Axes Codec<Axes>::read(const json& value, const Scene&) {
  if (value == 360) return Axes::y_up;
  return read_word(value, axes_words());
}
json Codec<Axes>::write(const Axes& value) { return write_word(value, axes_words()); }

FieldType Codec<AlphaCode>::type() { return type_of(alpha_code_words()); }
AlphaCode Codec<AlphaCode>::read(const json& value, const Scene&) { return read_word(value, alpha_code_words()); }
json Codec<AlphaCode>::write(const AlphaCode& value) { return write_word(value, alpha_code_words()); }

FieldType Codec<Layout>::type() { return type_of(layout_words()); }
Layout Codec<Layout>::read(const json& value, const Scene&) { return read_word(value, layout_words()); }
json Codec<Layout>::write(const Layout& value) { return write_word(value, layout_words()); }

FieldType Codec<Camera>::type() {
  return {FieldKind::other,
          "{\"eye\", \"target\", \"up\": [x, y, z], \"fov\": degrees, \"ortho_height\", \"near\", \"far\"}",
          "Camera",
          {}};
}
Camera Codec<Camera>::read(const json& value, const Scene&) { return read_camera_json(value); }
json Codec<Camera>::write(const Camera& value) { return camera_json(value); }

FieldType Codec<std::vector<int>>::type() { return {FieldKind::other, "list of whole numbers", "Sequence[int]", {}}; }
std::vector<int> Codec<std::vector<int>>::read(const json& value, const Scene& scene) {
  if (!value.is_array()) throw Error("must be a list of whole numbers");
  std::vector<int> numbers;
  for (const json& number : value) numbers.push_back(Codec<int>::read(number, scene));
  return numbers;
}
json Codec<std::vector<int>>::write(const std::vector<int>& value) { return value.empty() ? json() : json(value); }

Rotation::Rotation(const Eigen::Quaterniond& turn) : quaternion_(turn) {
  if (!turn.coeffs().allFinite()) throw Error("a rotation must be finite");
  // A normalised quaternion has length 1 within this rounding error. It is not normalised again, to keep its bits.
  constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  if (std::abs(turn.squaredNorm() - 1) <= rounding) return;
  // Scales by a power of two first, since squares of 1e200 overflow and those of 1e-200 underflow.
  const double largest = turn.coeffs().cwiseAbs().maxCoeff();
  if (!(largest > 0)) throw Error("a quaternion of length 0 is not a rotation");
  int exponent = 0;
  std::frexp(largest, &exponent);
  for (double& part : quaternion_.coeffs()) part = std::ldexp(part, -exponent);
  quaternion_.normalize();
}

FieldType choice_type(std::vector<std::string> choices) {
  std::string words, python;
  for (std::size_t k = 0; k < choices.size(); ++k) {
    words += (k == 0 ? "" : k + 1 == choices.size() ? " or " : ", ") + choices[k];
    python += fmt::format("{}\"{}\"", k == 0 ? "" : ", ", choices[k]);
  }
  return {FieldKind::choice, words, "Literal[" + python + "]", std::move(choices)};
}

}  // namespace rebake
