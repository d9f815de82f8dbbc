#include "mesh_ops/formats/mobilenerf/rotations_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/packed_rotation.h"

namespace rebake {

namespace {

using nlohmann::json;

// Reads an index. Converting a negative or fractional number would be undefined.
std::size_t whole_number(const json& value, const std::filesystem::path& name) {
  if (!value.is_number_unsigned()) throw FileError(name, "set and face numbers must be non-negative integers");
  return value.get<std::size_t>();
}

}  // namespace

void read_rotations_json(std::string_view text, const std::filesystem::path& name, std::vector<TextureSet>& sets) {
  try {
    const json root = json::parse(text);
    if (root.at("rebake_turns") != 1) throw FileError(name, "was written by a newer version of Rebake");
    for (const json& entry : root.at("sets")) {
      const auto s = whole_number(entry.at("set"), name);
      if (s >= sets.size())
        throw FileError(name, fmt::format("refers to set {}, but the folder has {}", s, counted(sets.size(), "set")));
      const Soup& soup = sets[s].soup;
      std::vector<PackedRotation> rotations(soup.positions().size());
      for (const json& run : entry.at("runs")) {
        const auto first = whole_number(run.at(0), name), count = whole_number(run.at(1), name);
        if (first > soup.faces().size() || count > soup.faces().size() - first)
          throw FileError(name, fmt::format("set {}: faces {} to {} do not exist", s, first, first + count));
        const json& matrices = run.at(2);
        for (std::size_t f = first; f < first + count; ++f)
          for (std::size_t k = 0; k < 3; ++k) {
            const json& values = matrices.at(matrices.size() == 3 ? k : 0);
            Mat3 turn;
            for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = values.at(static_cast<std::size_t>(i)).get<double>();
            if (!turn.isUnitary(1e-6))
              throw FileError(name, fmt::format("set {}: the rotation of face {} is not orthogonal", s, f));
            rotations[soup.faces()[f][k]] = PackedRotation(turn);
          }
      }
      sets[s].soup =
          Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces(),
               soup.vertex_attributes().with(Soup::rotation, Values<PackedRotation>::of(std::move(rotations))));
    }
  } catch (const json::exception& error) {
    throw FileError(name, std::string("is not a valid turns file: ") + error.what());
  }
}

}  // namespace rebake
