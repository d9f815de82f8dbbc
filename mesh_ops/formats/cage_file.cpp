#include "mesh_ops/formats/cage_file.h"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/mesh/manifold_mesh.h"

namespace rebake {

namespace {

// Files may have faces of any number of sides.
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<ManifoldTraits>;

std::string format_of(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".obj" && ending != ".off" && ending != ".ply")
    throw FileError(path, "is not in a supported cage format; use a name that ends in .obj, .off or .ply");
  return ending;
}

// Checks the counts of a header, since OpenMesh allocates memory for them unchecked.
void check_counts(const std::filesystem::path& path, const std::string& format, const std::string& bytes) {
  std::istringstream text(bytes.substr(0, 4096));
  const auto check = [&](double count, const char* what) {
    if (count > static_cast<double>(bytes.size()))
      throw FileError(path, fmt::format("its header declares {:.0f} {}, more than the file can contain", count, what));
  };
  double points = 0, faces = 0;
  if (format == ".ply") {
    for (std::string line; std::getline(text, line) && line.find("end_header") == std::string::npos;) {
      std::istringstream words(line);
      std::string element, what;
      double count = 0;
      if (words >> element >> what >> count && element == "element") check(count, what.c_str());
    }
  } else if (format == ".off") {
    std::string line;
    while (std::getline(text, line) && (line.starts_with('#') || line.empty() || line == "OFF" || line == "COFF"))
      continue;
    std::istringstream words(line);
    if (std::string kind; line.find("OFF") != std::string::npos) words >> kind;
    if (words >> points >> faces) {
      check(points, "points");
      check(faces, "faces");
    }
  }
}

// The text of a cage file for OpenMesh, which reads coordinates in single precision, and its points in double; without
// points if only OpenMesh reads them.
struct CageText {
  std::string text;
  std::vector<Vec3> points;
};

// Reads three coordinates. Throws FileError with the line.
Vec3 point_of(std::istringstream& words, const std::filesystem::path& path, std::size_t line) {
  Vec3 point;
  for (double& coordinate : point) {
    std::string word;
    words >> word;
    if (word.starts_with('+')) word.erase(0, 1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), coordinate);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(coordinate))
      throw FileError(path, fmt::format("line {}: \"{}\" is not a finite coordinate", line, word));
  }
  return point;
}

[[noreturn]] void fail_at_point(const std::filesystem::path& path, std::size_t line, const std::string& word,
                                const std::string& numbers) {
  throw FileError(path,
                  fmt::format("line {}: a face names point {}, but points have the numbers {}", line, word, numbers));
}

// Throws FileError unless the corners of a face, counted from 1 or backwards from -1, are among `points`.
void check_corners(std::istringstream& words, std::size_t points, const std::filesystem::path& path, std::size_t line) {
  for (std::string word; words >> word;) {
    const std::string number = word.substr(0, word.find('/'));
    long long corner = 0;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), corner);
    if (error != std::errc() || end != number.data() + number.size())
      throw FileError(path, fmt::format("line {}: \"{}\" is not the corner of a face", line, word));
    const auto last = static_cast<long long>(points);
    if (corner == 0 || corner < -last || corner > last)
      fail_at_point(path, line, number, fmt::format("1 to {}, or backwards from -1", points));
  }
}

// Without materials, for which OpenMesh needs other files.
CageText obj_text(const std::filesystem::path& path, const std::string& bytes) {
  CageText result;
  std::istringstream lines(bytes);
  std::vector<std::pair<std::size_t, std::string>> faces;  // and their lines
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "mtllib" || key == "usemtl") continue;
    if (key == "v") result.points.push_back(point_of(words, path, number));
    if (key == "f") faces.emplace_back(number, line);
    result.text += line + '\n';
  }
  for (const auto& [at, line] : faces) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string key;
    words >> key;
    check_corners(words, result.points.size(), path, at);
  }
  return result;
}

// Without comments and colours. Other variants than OFF and COFF are left to OpenMesh.
CageText off_text(const std::filesystem::path& path, const std::string& bytes) {
  std::istringstream lines(bytes);
  std::size_t number = 0;
  // The next line with words.
  const auto next = [&] {
    for (std::string line; std::getline(lines, line);) {
      ++number;
      line.erase(std::min(line.find('#'), line.size()));
      if (line.find_first_not_of(" \t\r") != std::string::npos) return std::istringstream(line);
    }
    throw FileError(path, "is truncated");
  };
  std::istringstream words = next();
  std::string kind;
  words >> kind;
  if (kind != "OFF" && kind != "COFF") return {bytes, {}};
  std::size_t points = 0, faces = 0;
  if (!(words >> points)) {
    words = next();
    words >> points;
  }
  if (!(words >> faces)) throw FileError(path, fmt::format("line {}: must state the number of faces", number));
  CageText result;
  result.text = fmt::format("OFF\n{} {} 0\n", points, faces);
  for (std::size_t k = 0; k < points; ++k) {
    std::istringstream line = next();
    result.points.push_back(point_of(line, path, number));
    const Vec3& p = result.points.back();
    result.text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  }
  for (std::size_t k = 0; k < faces; ++k) {
    std::istringstream line = next();
    std::size_t corners = 0;
    line >> corners;
    if (corners < 3 || corners > points) throw FileError(path, fmt::format("line {}: is not a face", number));
    result.text += std::to_string(corners);
    for (std::size_t c = 0; c < corners; ++c) {
      std::size_t vertex = 0;
      if (!(line >> vertex)) throw FileError(path, fmt::format("line {}: is not a face", number));
      if (vertex >= points) fail_at_point(path, number, std::to_string(vertex), fmt::format("0 to {}", points - 1));
      result.text += fmt::format(" {}", vertex);
    }
    result.text += '\n';
  }
  return result;
}

}  // namespace

Cage read_triangles(const std::filesystem::path& path) {
  const std::string format = format_of(path);
  const std::string bytes = read_file(path, std::uint64_t{1} << 30);
  check_counts(path, format, bytes);
  const CageText source = format == ".obj"   ? obj_text(path, bytes)
                          : format == ".off" ? off_text(path, bytes)
                                             : CageText{bytes, {}};
  std::istringstream text(source.text);
  Mesh mesh;
  OpenMesh::IO::Options options;
  // OpenMesh drops faces that make a mesh non-manifold and reports that only to its error stream.
  const OpenMeshMessages complaints;
  const bool read = OpenMesh::IO::read_mesh(mesh, text, format, options);
  if (read && !complaints.text().empty())
    throw FileError(path,
                    "has a face that cannot be added: its points must exist and differ, and the mesh must be manifold "
                    "(each edge in at most two triangles, each point in one triangle fan)");
  if (!read || mesh.n_faces() == 0) throw FileError(path, "contains no readable mesh");
  Cage cage;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    cage.vertices.emplace_back(p[0], p[1], p[2]);
  }
  if (source.points.size() == cage.vertices.size()) cage.vertices = source.points;
  for (const auto f : mesh.faces()) {
    if (mesh.valence(f) != 3) throw FileError(path, "has faces that are not triangles; triangulate it first");
    Face face{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(f)) face[k++] = static_cast<std::uint32_t>(v.idx());
    cage.faces.push_back(face);
  }
  return cage;
}

Cage read_cage(const std::filesystem::path& path) {
  try {
    return checked_cage(read_triangles(path));
  } catch (const FileError&) {
    throw;
  } catch (const Error& error) {
    throw FileError(path, error.what());
  }
}

}  // namespace rebake
