#include "mesh_ops/formats/mobilenerf/obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/mesh/polygon.h"

namespace rebake {

namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

struct Corner {
  std::uint32_t position;
  std::uint32_t uv;
};

class Parser {
 public:
  Parser(std::string_view text, const std::filesystem::path& name, const ObjReading& reading)
      : at_(text.data()), end_(text.data() + text.size()), name_(name), reading_(reading) {
    if (text.starts_with("\xEF\xBB\xBF")) at_ += 3;  // a byte-order mark
  }

  ObjMesh run() {
    while (at_ != end_) {
      ++line_;
      const char* stop = std::find(at_, end_, '\n');
      next_ = stop == end_ ? end_ : stop + 1;
      line_end_ = stop;
      while (line_end_ > at_ && (line_end_[-1] == '\r' || line_end_[-1] == ' ' || line_end_[-1] == '\t')) --line_end_;
      statement();
      at_ = next_;
    }
    if (uvs_.empty() && !corners_.empty() && !reading_.missing_uvs)
      fail("faces without texture coordinates (vt): features cannot be looked up");
    return finish();
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw FileError(name_, fmt::format("line {}: {}", line_, message));
  }

  void skip_blanks() {
    while (at_ != line_end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
  }

  void statement() {
    skip_blanks();
    if (at_ == line_end_ || *at_ == '#') return;
    const char* word = at_;
    while (at_ != line_end_ && *at_ != ' ' && *at_ != '\t') ++at_;
    const std::string_view key(word, static_cast<std::size_t>(at_ - word));
    if (key == "v") {
      const double x = number(), y = number(), z = number();
      positions_.emplace_back(x, y, z);
      skip_blanks();
      if (at_ != line_end_ && *at_ != '#') note(Note::colors);
    } else if (key == "vt") {
      const double u = number(), v = number();
      uvs_.emplace_back(u, v);
    } else if (key == "f") {
      face();
    } else if (key == "l" || key == "p") {
      note(Note::lines);
    } else if (reading_.materials && (key == "usemtl" || key == "mtllib")) {
      material(key == "mtllib");
    } else {
      constexpr std::array<std::string_view, 8> known{"o", "g", "s", "vn", "usemtl", "mtllib", "vp", "mg"};
      const bool is_known = std::find(known.begin(), known.end(), key) != known.end();
      if (!is_known) unknown_ = std::string(key.substr(0, 20));
      note(is_known ? Note::groups : Note::unknown);
    }
  }

  // Names may contain blanks.
  void material(bool is_library) {
    skip_blanks();
    std::string name(at_, line_end_);
    if (is_library) {
      libraries_.push_back(std::move(name));
      return;
    }
    const auto known = std::find(materials_.begin(), materials_.end(), name);
    material_ = static_cast<std::uint32_t>(known - materials_.begin());
    if (known == materials_.end()) materials_.push_back(std::move(name));
  }

  // Kinds of skipped or decided things; each is reported with its first line and its count.
  enum class Note { groups, unknown, colors, lines, concave, crossing };
  struct Noted {
    std::size_t first_line = 0, count = 0;
  };
  void note(Note kind, std::size_t line = 0) {
    Noted& noted = notes_[static_cast<std::size_t>(kind)];
    if (noted.count++ == 0) noted.first_line = line > 0 ? line : line_;
  }

  std::vector<std::string> assumptions() const {
    const std::array<std::string, 6> texts{
        reading_.materials ? "objects, groups and normals are skipped; all faces are one object"
                           : "objects, groups, materials and normals are skipped; all faces are one mesh",
        fmt::format("unknown statements such as \"{}\" are skipped", printable_word(unknown_)),
        "numbers after x y z (vertex colours or weights) are skipped",
        "lines and points are skipped",
        "concave polygons are cut by clipping ears",
        "polygons whose sides cross or that have no area are cut as a fan"};
    std::vector<std::string> found;
    for (std::size_t kind = 0; kind < texts.size(); ++kind)
      if (notes_[kind].count > 0)
        found.push_back(
            fmt::format("line {}: {} ({} in total)", notes_[kind].first_line, texts[kind], notes_[kind].count));
    return found;
  }

  double number() {
    skip_blanks();
    if (at_ == line_end_) fail("is truncated: a number is missing");
    if (*at_ == '+') ++at_;
    double value = 0;
    const auto [stop, error] = std::from_chars(at_, line_end_, value);
    if (error == std::errc::invalid_argument || (stop != line_end_ && *stop != ' ' && *stop != '\t'))
      fail(fmt::format("\"{}\" is not a number", word_at(at_)));
    // Numbers that underflow become 0.
    if (error == std::errc::result_out_of_range) value = std::strtod(std::string(at_, stop).c_str(), nullptr);
    if (!std::isfinite(value)) fail(fmt::format("\"{}\" is not a finite number", word_at(at_)));
    at_ = stop;
    return value;
  }

  std::string word_at(const char* from) const {
    const char* stop = from;
    while (stop != line_end_ && *stop != ' ' && *stop != '\t' && stop - from < 40) ++stop;
    return printable_word({from, stop});
  }

  // Control characters of binary files must not garble the terminal.
  static std::string printable_word(std::string word) {
    std::replace_if(
        word.begin(), word.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
    return word;
  }

  std::uint32_t index(std::size_t count, const char* what) {
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(at_, line_end_, value);
    if (error != std::errc() || value == 0) fail(fmt::format("\"{}\" is not a {} index", word_at(at_), what));
    const std::int64_t zero_based = value > 0 ? value - 1 : value + static_cast<std::int64_t>(count);
    if (zero_based < 0 || zero_based >= static_cast<std::int64_t>(unused))
      fail(fmt::format("{} index {} is out of range ({} so far)", what, value, count));
    at_ = stop;
    return static_cast<std::uint32_t>(zero_based);
  }

  void face() {
    const std::size_t first = corners_.size();
    for (skip_blanks(); at_ != line_end_ && *at_ != '#'; skip_blanks()) {
      Corner corner{};
      corner.position = index(positions_.size(), "vertex");
      const bool has_slash = at_ != line_end_ && *at_ == '/';
      if (has_slash) ++at_;
      if (has_slash && at_ != line_end_ && *at_ != '/')
        corner.uv = index(uvs_.size(), "vt");
      else if (reading_.missing_uvs)
        corner.uv = unused;
      else
        fail("a face has no texture coordinates (vt): write f v/vt v/vt v/vt");
      if (at_ != line_end_ && *at_ == '/') {
        ++at_;
        index(unused - 1, "normal");
      }
      if (at_ != line_end_ && *at_ != ' ' && *at_ != '\t')
        fail(fmt::format("\"{}\" does not belong in a face", word_at(at_)));
      corners_.push_back(corner);
      highest_index_ = std::max(highest_index_, corner.position);
      if (corner.uv != unused) highest_index_ = std::max(highest_index_, corner.uv);
    }
    const std::size_t count = corners_.size() - first;
    if (count < 3) fail("a face needs at least three corners");
    only_triangles_ = only_triangles_ && count == 3;
    face_lines_.push_back(line_);
    face_ends_.push_back(corners_.size());
    if (reading_.materials) material_of_.push_back(material_);
  }

  CutPolygon cut_face(const std::vector<Vec3>& corners, std::size_t line) const {
    try {
      return cut_polygon(corners);
    } catch (const Error& error) {
      throw FileError(name_, fmt::format("line {}: {}", line, error.what()));
    }
  }

  // Cuts all polygons into triangles.
  void cut_polygons() {
    std::vector<Corner> cut;
    std::vector<std::uint32_t> material_of;
    cut.reserve(corners_.size());
    std::size_t first = 0;
    std::vector<Vec3> places;
    for (std::size_t f = 0; f < face_ends_.size(); ++f) {
      // Tools repeat corners, or the first one at the end.
      std::vector<std::size_t> kept;
      for (std::size_t c = first; c < face_ends_[f]; ++c)
        if (kept.empty() || corners_[c].position != corners_[kept.back()].position) kept.push_back(c);
      while (kept.size() > 1 && corners_[kept.back()].position == corners_[kept.front()].position) kept.pop_back();
      if (kept.size() < 3) {
        kept.resize(face_ends_[f] - first);
        std::iota(kept.begin(), kept.end(), first);
      }
      places.clear();
      for (const std::size_t c : kept) places.push_back(positions_[corners_[c].position]);
      const CutPolygon polygon = cut_face(places, face_lines_[f]);
      if (polygon.shape == PolygonShape::concave) note(Note::concave, face_lines_[f]);
      if (polygon.shape == PolygonShape::crossing) note(Note::crossing, face_lines_[f]);
      for (const auto& triangle : polygon.triangles)
        for (const std::size_t corner : triangle) cut.push_back(corners_[kept[corner]]);
      if (reading_.materials) material_of.insert(material_of.end(), polygon.triangles.size(), material_of_[f]);
      first = face_ends_[f];
    }
    corners_ = std::move(cut);
    material_of_ = std::move(material_of);
  }

  [[noreturn]] void fail_range() const {
    std::size_t f = 0;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      while (c >= face_ends_[f]) ++f;
      if (corners_[c].position >= positions_.size())
        throw FileError(name_, fmt::format("line {}: vertex index {} is out of range (the file has {})", face_lines_[f],
                                           corners_[c].position + 1, positions_.size()));
      if (corners_[c].uv >= uvs_.size())
        throw FileError(name_, fmt::format("line {}: vt index {} is out of range (the file has {})", face_lines_[f],
                                           corners_[c].uv + 1, uvs_.size()));
    }
    throw FileError(name_, "has a face out of range");
  }

  // Gives corners without texture coordinates a common one.
  void fill_missing_uvs() {
    bool any = false;
    for (Corner& corner : corners_)
      if (corner.uv == unused) {
        corner.uv = static_cast<std::uint32_t>(uvs_.size());
        any = true;
      }
    if (any) highest_index_ = std::max(highest_index_, static_cast<std::uint32_t>(uvs_.size()));
    if (any) uvs_.emplace_back(0, 0);
  }

  ObjMesh finish() {
    fill_missing_uvs();
    if (!corners_.empty() && highest_index_ >= std::min(positions_.size(), uvs_.size()))
      if (std::any_of(corners_.begin(), corners_.end(),
                      [&](const Corner& c) { return c.position >= positions_.size() || c.uv >= uvs_.size(); }))
        fail_range();
    if (!only_triangles_) cut_polygons();
    ObjMesh mesh;
    mesh.assumptions = assumptions();
    mesh.needs_repair = notes_[static_cast<std::size_t>(Note::lines)].count > 0 ||
                        notes_[static_cast<std::size_t>(Note::concave)].count > 0;
    mesh.libraries = std::move(libraries_);
    if (reading_.materials) mesh.materials = std::move(materials_);
    mesh.material_of = std::move(material_of_);
    mesh.faces.resize(corners_.size() / 3);
    const bool paired =
        positions_.size() == uvs_.size() &&
        std::all_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.position == c.uv; });
    if (paired) {
      mesh.positions = std::move(positions_);
      mesh.uvs = std::move(uvs_);
      for (std::size_t c = 0; c < corners_.size(); ++c) mesh.faces[c / 3][c % 3] = corners_[c].position;
      return mesh;
    }
    std::unordered_map<std::uint64_t, std::uint32_t> known;
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      const Corner corner = corners_[c];
      const auto [it, fresh] = known.try_emplace(std::uint64_t{corner.position} << 32 | corner.uv,
                                                 static_cast<std::uint32_t>(mesh.positions.size()));
      if (fresh) {
        mesh.positions.push_back(positions_[corner.position]);
        mesh.uvs.push_back(uvs_[corner.uv]);
      }
      mesh.faces[c / 3][c % 3] = it->second;
    }
    return mesh;
  }

  const char* at_;
  const char* end_;
  const char* next_ = nullptr;
  const char* line_end_ = nullptr;
  const std::filesystem::path& name_;
  ObjReading reading_;
  std::size_t line_ = 0;
  std::vector<std::string> libraries_, materials_{""};
  std::uint32_t material_ = 0;              // index in materials_ of the faces that follow
  std::vector<std::uint32_t> material_of_;  // per face, if materials are read
  std::vector<Vec3> positions_;
  std::vector<Vec2> uvs_;
  std::vector<Corner> corners_;
  std::uint32_t highest_index_ = 0;
  std::vector<std::size_t> face_lines_;  // line of each face, for messages
  std::vector<std::size_t> face_ends_;   // end of each face in corners_, before polygons are cut
  bool only_triangles_ = true;
  std::array<Noted, 6> notes_{};  // per Note
  std::string unknown_;           // the last unknown statement
};

void append(std::string& out, double value) {
  char buffer[400];
  auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, 6);
  double back = 0;
  std::from_chars(buffer, end, back);
  if (back != value) end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
  out.append(buffer, end);
}

void append(std::string& out, std::uint32_t value) {
  char buffer[16];
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

}  // namespace

namespace {

// The text with continued lines joined. Empty lines keep the line numbers of what follows.
std::string with_joined_lines(std::string_view text) {
  std::string joined;
  std::size_t missing = 0;
  bool comment = false, begins = true;  // the line is a comment; nothing but blanks has come in it
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (begins && text[at] != ' ' && text[at] != '\t') comment = text[at] == '#', begins = false;
    if (text[at] == '\n') begins = true;
    if (comment) {
      joined += text[at];
      if (text[at] == '\n') comment = false;
      continue;
    }
    const bool carriage = text.substr(at, 3) == "\\\r\n";
    if (carriage || text.substr(at, 2) == "\\\n") {
      joined += ' ';
      at += carriage ? 2 : 1;
      ++missing;
    } else {
      joined += text[at];
      if (text[at] == '\n') joined.append(std::exchange(missing, 0), '\n');
    }
  }
  return joined;
}

}  // namespace

ObjMesh read_obj(std::string_view text, const std::filesystem::path& name, const ObjReading& reading) {
  if (text.find("\\\n") == std::string_view::npos && text.find("\\\r\n") == std::string_view::npos)
    return Parser(text, name, reading).run();
  return Parser(with_joined_lines(text), name, reading).run();
}

std::string write_obj(const std::vector<Vec3>& positions, const std::vector<Vec2>& uvs, const std::vector<Face>& faces,
                      std::size_t first_face, std::size_t last_face) {
  // Numbers the used vertices in their old order.
  std::vector<std::uint32_t> number(positions.size(), unused);
  for (std::size_t f = first_face; f < last_face; ++f)
    for (const std::uint32_t vertex : faces[f]) number[vertex] = 0;
  std::vector<std::uint32_t> old;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == unused) continue;
    number[v] = static_cast<std::uint32_t>(old.size());
    old.push_back(v);
  }

  std::string out;
  out.reserve(old.size() * 60 + (last_face - first_face) * 30);
  std::uint32_t written = 0;
  const auto write_vertices = [&](std::uint32_t end) {
    for (std::uint32_t v = written; v < end; ++v) {
      const Vec3& p = positions[old[v]];
      out += 'v';
      for (int axis = 0; axis < 3; ++axis) {
        out += ' ';
        append(out, p[axis]);
      }
      out += '\n';
    }
    for (std::uint32_t v = written; v < end; ++v) {
      out += "vt ";
      append(out, uvs[old[v]].x());
      out += ' ';
      append(out, uvs[old[v]].y());
      out += '\n';
    }
    written = end;
  };
  // The published exporter writes a quad's vertices just before its one or two faces. Faces in that order are written
  // the same way, so an unchanged quad keeps its bytes.
  for (std::size_t f = first_face; f < last_face;) {
    std::uint32_t end = 0;
    std::size_t last = f;
    for (; last < last_face; ++last) {
      std::uint32_t low = unused, high = 0;
      for (const std::uint32_t vertex : faces[last]) {
        low = std::min(low, number[vertex]);
        high = std::max(high, number[vertex]);
      }
      if (last != f && low >= end) break;
      end = std::max(end, high + 1);
    }
    if (end > written) write_vertices(end);
    for (; f < last; ++f) {
      out += 'f';
      for (const std::uint32_t vertex : faces[f]) {
        out += ' ';
        append(out, number[vertex] + 1);
        out += '/';
        append(out, number[vertex] + 1);
      }
      out += '\n';
    }
  }
  return out;
}

}  // namespace rebake
