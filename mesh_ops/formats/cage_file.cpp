#include "mesh_ops/formats/cage_file.h"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cctype>
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
    while (std::getline(text, line) && (line.find("OFF") != std::string::npos || line.starts_with('#') || line.empty()))
      continue;
    std::istringstream words(line);
    if (words >> points >> faces) {
      check(points, "points");
      check(faces, "faces");
    }
  }
}

}  // namespace

Cage read_cage(const std::filesystem::path& path) {
  const std::string format = format_of(path);
  const std::string bytes = read_file(path, std::uint64_t{1} << 30);
  check_counts(path, format, bytes);
  std::istringstream text(bytes);
  Mesh mesh;
  OpenMesh::IO::Options options;
  // OpenMesh drops faces that make a mesh non-manifold and reports that only to its error stream.
  const OpenMeshMessages complaints;
  const bool read = OpenMesh::IO::read_mesh(mesh, text, format, options);
  if (!read || mesh.n_faces() == 0) throw FileError(path, "contains no readable mesh");
  if (!complaints.text().empty())
    throw FileError(
        path, "is non-manifold: each edge of a cage must belong to two triangles, and each point to one triangle fan");
  Cage cage;
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    cage.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : mesh.faces()) {
    if (mesh.valence(f) != 3) throw FileError(path, "has faces that are not triangles; triangulate it first");
    Face face{};
    std::size_t k = 0;
    for (const auto v : mesh.fv_range(f)) face[k++] = static_cast<std::uint32_t>(v.idx());
    cage.faces.push_back(face);
  }
  try {
    return checked_cage(std::move(cage));
  } catch (const Error& error) {
    throw FileError(path, error.what());
  }
}

}  // namespace rebake
