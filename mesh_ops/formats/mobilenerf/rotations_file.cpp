#include "mesh_ops/formats/mobilenerf/rotations_file.h"

#include <array>
#include <cstdint>
#include <span>

#include "mesh_ops/base/packed_rotation.h"
#include "mesh_ops/formats/mobilenerf/sidecar_file.h"

namespace rebake {

namespace {

constexpr std::uint32_t rotations_version = 1;

std::string bytes_of(const PackedRotation& turn) {
  const auto bytes = turn.bytes();
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::string write_rotations(const std::vector<TextureSet>& sets) {
  SidecarWriter file(rotations_mark, rotations_version);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const Soup& soup = sets[s].soup;
    if (soup.rotations() == nullptr) continue;
    std::string values;
    values.reserve(soup.positions().size() * PackedRotation::size);
    for (const PackedRotation& turn : *soup.rotations()) values += bytes_of(turn);
    file.add(static_cast<std::uint32_t>(s), soup.triangle_count(),
             corner_values(soup.faces(), values, PackedRotation::size, bytes_of(PackedRotation())));
  }
  return file.bytes();
}

void read_rotations(std::string_view bytes, const std::filesystem::path& name, std::vector<TextureSet>& sets) {
  read_sidecar(
      bytes, name, rotations_mark, rotations_version, "turns", sets, [](SidecarReader& reader, TextureSet& set) {
        const Soup& soup = set.soup;
        const std::size_t vertices = soup.positions().size();
        const std::string values =
            read_corner_values(reader, soup.faces(), vertices, PackedRotation::size, bytes_of(PackedRotation()));
        std::vector<PackedRotation> turns;
        turns.reserve(vertices);
        for (std::size_t v = 0; v < vertices; ++v)
          turns.emplace_back(std::span<const std::uint8_t, PackedRotation::size>(
              reinterpret_cast<const std::uint8_t*>(values.data()) + v * PackedRotation::size, PackedRotation::size));
        set.soup = Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces(),
                        soup.vertex_attributes().with(Soup::rotation, Values<PackedRotation>::of(std::move(turns))),
                        soup.face_attributes());
      });
}

}  // namespace rebake
