#include "mesh_ops/formats/turns_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

using nlohmann::json;

json matrix_json(const Mat3& m) {
  json list = json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) list.push_back(m(r, c));
  return list;
}

// A number that fits: converting any other is undefined.
std::size_t whole_number(const json& value, const std::filesystem::path& name) {
  if (!value.is_number_unsigned()) throw FileError(name, "set and face numbers must be whole and not negative");
  return value.get<std::size_t>();
}

}  // namespace

std::string write_turns_json(const std::vector<TextureSet>& sets) {
  json root = {{"rebake_turns", 1}, {"sets", json::array()}};
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const Soup& soup = sets[s].soup;
    if (soup.rotations() == nullptr) continue;
    json runs = json::array();
    // Faces, not vertices: writing chunks renumbers vertices, but never faces.
    std::size_t first = 0;
    const auto same = [&](std::size_t a, std::size_t b) {
      for (std::size_t k = 0; k < 3; ++k)
        if ((*soup.rotations())[soup.faces()[a][k]] != (*soup.rotations())[soup.faces()[b][k]]) return false;
      return true;
    };
    for (std::size_t f = 1; f <= soup.faces().size(); ++f) {
      if (f < soup.faces().size() && same(first, f)) continue;
      const Face& face = soup.faces()[first];
      const Mat3 &a = (*soup.rotations())[face[0]], &b = (*soup.rotations())[face[1]],
                 &c = (*soup.rotations())[face[2]];
      if (!(a.isIdentity(0) && b.isIdentity(0) && c.isIdentity(0))) {
        json turns = json::array({matrix_json(a)});
        if (a != b || a != c) turns = json::array({matrix_json(a), matrix_json(b), matrix_json(c)});
        runs.push_back({first, f - first, turns});
      }
      first = f;
    }
    root["sets"].push_back({{"set", s}, {"runs", runs}});
  }
  return root.dump();
}

void read_turns_json(std::string_view text, const std::filesystem::path& name, std::vector<TextureSet>& sets) {
  try {
    const json root = json::parse(text);
    if (root.at("rebake_turns") != 1) throw FileError(name, "was written by a newer version of Rebake");
    for (const json& entry : root.at("sets")) {
      const auto s = whole_number(entry.at("set"), name);
      if (s >= sets.size()) throw FileError(name, fmt::format("names set {}, but the folder has {}", s, sets.size()));
      const Soup& soup = sets[s].soup;
      std::vector<Mat3> rotations(soup.positions().size(), Mat3::Identity());
      for (const json& run : entry.at("runs")) {
        const auto first = whole_number(run.at(0), name), count = whole_number(run.at(1), name);
        if (first > soup.faces().size() || count > soup.faces().size() - first)
          throw FileError(name, fmt::format("set {}: faces {} to {} are not there", s, first, first + count));
        const json& matrices = run.at(2);
        for (std::size_t f = first; f < first + count; ++f)
          for (std::size_t k = 0; k < 3; ++k) {
            const json& values = matrices.at(matrices.size() == 3 ? k : 0);
            Mat3& turn = rotations[soup.faces()[f][k]];
            for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = values.at(static_cast<std::size_t>(i)).get<double>();
            if (!turn.isUnitary(1e-6))
              throw FileError(name, fmt::format("set {}: the turn of face {} is not orthogonal", s, f));
          }
      }
      sets[s].soup = Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces(),
                          soup.vertex_attributes().with(Soup::rotation, Values<Mat3>::of(std::move(rotations))));
    }
  } catch (const json::exception& error) {
    throw FileError(name, std::string("is not a valid turns file: ") + error.what());
  }
}

}  // namespace rebake
