#include "mesh_ops/formats/meshes/ply_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <sstream>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

constexpr std::size_t longest_list = 1U << 16;

struct Type {
  std::string_view name, other_name;
  std::size_t size;
  bool floating, is_signed;
};
constexpr Type types[] = {{"char", "int8", 1, false, true},    {"uchar", "uint8", 1, false, false},
                          {"short", "int16", 2, false, true},  {"ushort", "uint16", 2, false, false},
                          {"int", "int32", 4, false, true},    {"uint", "uint32", 4, false, false},
                          {"float", "float32", 4, true, true}, {"double", "float64", 8, true, true}};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count = nullptr;  // of a list; null for single numbers
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::filesystem::path& name) : bytes_(bytes), name_(name) {}

  PlyFile run() {
    read_header();
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;  // takes no bytes, whatever its count
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        for (std::size_t k = 0; k < element.count; ++k)
          for (const Property& property : element.properties) values_of(property);
    }
    for (const auto& polygon : file_.polygons)
      for (const std::uint32_t vertex : polygon)
        if (vertex >= file_.positions.size()) fail(fmt::format("vertex {} is out of range", vertex));
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw FileError(name_, what); }

  std::string_view line() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) fail("is truncated: \"end_header\" is missing");
    std::string_view text = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (text.ends_with('\r')) text.remove_suffix(1);
    return text;
  }

  void read_header() {
    if (line() != "ply") fail("is not a PLY file");
    for (std::string_view text = line(); text != "end_header"; text = line()) {
      std::istringstream words{std::string(text)};
      std::string key, word;
      words >> key;
      if (key == "format") {
        words >> word;
        if (word != "ascii" && word != "binary_little_endian" && word != "binary_big_endian")
          fail(fmt::format("has the unknown format \"{}\"", word));
        is_text_ = word == "ascii";
        swaps_ = (word == "binary_big_endian") == (std::endian::native == std::endian::little);
      } else if (key == "comment") {
        words >> word;
        std::string image;
        if (word == "TextureFile" && std::getline(words >> std::ws, image)) file_.images.push_back(image);
      } else if (key == "element") {
        Element element;
        if (!(words >> element.name >> element.count)) fail("has an element without a count");
        elements_.push_back(element);
      } else if (key == "property") {
        if (elements_.empty()) fail("has a property before the first element");
        elements_.back().properties.push_back(property_of(words));
      }
    }
  }

  Property property_of(std::istringstream& words) const {
    Property property;
    std::string word;
    words >> word;
    if (word == "list") {
      words >> word;
      property.count = type_named(word);
      words >> word;
    }
    property.type = type_named(word);
    if (!(words >> property.name) || (property.count != nullptr && property.count->floating))
      fail("has a property without a name, or a list whose length is no whole number");
    return property;
  }

  const Type* type_named(const std::string& name) const {
    for (const Type& type : types)
      if (name == type.name || name == type.other_name) return &type;
    fail(fmt::format("has the unknown type \"{}\"", name));
  }

  double number(const Type& type) {
    if (is_text_) return text_number();
    if (type.size > bytes_.size() - at_) fail("is truncated");
    char raw[8];
    std::memcpy(raw, bytes_.data() + at_, type.size);
    at_ += type.size;
    if (swaps_) std::reverse(raw, raw + type.size);
    if (type.floating) {
      double value = 0;
      float single = 0;
      std::memcpy(type.size == 8 ? static_cast<void*>(&value) : &single, raw, type.size);
      return type.size == 8 ? value : static_cast<double>(single);
    }
    std::uint64_t bits = 0;
    std::memcpy(&bits, raw, type.size);
    const int shift = 64 - 8 * static_cast<int>(type.size);
    return type.is_signed ? static_cast<double>(static_cast<std::int64_t>(bits << shift) >> shift)
                          : static_cast<double>(bits);
  }

  double text_number() {
    at_ = std::min(bytes_.find_first_not_of(" \t\r\n", at_), bytes_.size());
    double value = 0;
    const char* first = bytes_.data() + at_;
    const auto [stop, error] = std::from_chars(first, bytes_.data() + bytes_.size(), value);
    if (at_ == bytes_.size()) fail("is truncated");
    if (error != std::errc()) fail(fmt::format("has a number that cannot be read, at byte {}", at_));
    at_ += static_cast<std::size_t>(stop - first);
    return value;
  }

  // The numbers of a property of the next element, in a buffer that the next call overwrites.
  const std::vector<double>& values_of(const Property& property) {
    values_.clear();
    double count = 1;
    if (property.count != nullptr) count = number(*property.count);
    if (!(count >= 0 && count <= longest_list))
      fail(fmt::format("\"{}\" has a list of {} numbers", property.name, count));
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      values_.push_back(number(*property.type));
      if (!std::isfinite(values_.back())) fail(fmt::format("\"{}\" has a number that is not finite", property.name));
    }
    return values_;
  }

  static std::optional<std::size_t> index_of(const Element& element, std::initializer_list<std::string_view> names) {
    for (std::size_t k = 0; k < element.properties.size(); ++k)
      if (std::find(names.begin(), names.end(), element.properties[k].name) != names.end() &&
          element.properties[k].count == nullptr)
        return k;
    return std::nullopt;
  }

  void read_vertices(const Element& element) {
    const auto x = index_of(element, {"x"}), y = index_of(element, {"y"}), z = index_of(element, {"z"}),
               u = index_of(element, {"s", "u", "texture_u"}), v = index_of(element, {"t", "v", "texture_v"}),
               red = index_of(element, {"red", "r"}), green = index_of(element, {"green", "g"}),
               blue = index_of(element, {"blue", "b"});
    if (!x || !y || !z) fail("has vertices without x, y and z");
    std::vector<double> row(element.properties.size());
    for (std::size_t k = 0; k < element.count; ++k) {
      for (std::size_t p = 0; p < row.size(); ++p) {
        const std::vector<double>& values = values_of(element.properties[p]);
        row[p] = values.empty() ? 0 : values.front();
      }
      file_.positions.emplace_back(row[*x], row[*y], row[*z]);
      if (u && v) file_.uvs.emplace_back(row[*u], row[*v]);
      if (!red || !green || !blue) continue;
      std::array<double, 3> color{row[*red], row[*green], row[*blue]};
      for (double& c : color) c = std::clamp(element.properties[*red].type->floating ? c : c / 255, 0.0, 1.0);
      file_.colors.push_back(color);
    }
  }

  void read_faces(const Element& element) {
    for (std::size_t k = 0; k < element.count; ++k) {
      std::vector<std::uint32_t> polygon;
      std::vector<double> uvs;
      std::uint32_t image = 0;
      for (const Property& property : element.properties) {
        const std::vector<double>& values = values_of(property);
        if (property.name == "vertex_indices" || property.name == "vertex_index")
          for (const double value : values) polygon.push_back(vertex_number(value));
        else if (property.name == "texcoord")
          uvs = values;
        else if (property.name == "texnumber" && !values.empty())
          image = static_cast<std::uint32_t>(std::clamp(values.front(), 0.0, 1e6));
      }
      if (polygon.size() < 3) fail(fmt::format("face {} has {} corners", k, polygon.size()));
      if (!uvs.empty() && uvs.size() != 2 * polygon.size())
        fail(fmt::format("face {} has {} texture coordinates for {} corners", k, uvs.size() / 2, polygon.size()));
      if (image > 0 && image >= file_.images.size())
        fail(fmt::format("face {} uses image {}, which is not named", k, image));
      file_.polygons.push_back(std::move(polygon));
      file_.polygon_uvs.push_back(std::move(uvs));
      file_.image_of.push_back(image);
    }
  }

  std::uint32_t vertex_number(double value) const {
    if (!(value >= 0 && value < 4e9 && value == std::floor(value)))
      fail("has a vertex number that is not a whole number");
    return static_cast<std::uint32_t>(value);
  }

  std::string_view bytes_;
  const std::filesystem::path& name_;
  std::size_t at_ = 0;
  bool is_text_ = true, swaps_ = false;
  std::vector<Element> elements_;
  std::vector<double> values_;
  PlyFile file_;
};

}  // namespace

PlyFile read_ply(std::string_view bytes, const std::filesystem::path& name) { return Reader(bytes, name).run(); }

}  // namespace rebake
