#include "mesh_ops/deform/deform_object.h"

#include "mesh_ops/base/polar.h"
#include "mesh_ops/index/index.h"

namespace rebake {

namespace {

constexpr const char* folded_attribute = "folded";

}  // namespace

TriangleSet folded_triangles(const BakedObject& object) {
  TriangleSet flags;
  for (const TextureSet& set : object.sets) {
    const auto* folded = set.soup.face_attributes().find<std::uint8_t>(folded_attribute);
    if (folded != nullptr)
      flags.insert(flags.end(), folded->begin(), folded->end());
    else
      flags.resize(flags.size() + set.soup.triangle_count(), 0);
  }
  return flags;
}

DeformedObject deformed(const BakedObject& object, const Affine& to_world, const TriangleSet& flags, double falloff,
                        const SpaceDeformation& deformation) {
  const auto corners = corners_of(object);
  const FlaggedPositions places = flagged_positions(object, *corners, to_world, flags);
  const DeformedPositions moved = deform_positions(object, *corners, to_world, flags, places, falloff, deformation);
  const Affine to_object = to_world.inverse();
  auto made = std::make_shared<BakedObject>(object);
  record_bodies(*made, object);
  std::size_t first = 0;
  for (TextureSet& set : made->sets) {
    const std::size_t total = set.soup.triangle_count();
    std::vector<std::uint32_t> place_of(set.soup.positions().size(), FlaggedPositions::none);
    std::vector<std::uint8_t> folded(total, 0);
    for (std::size_t f = 0; f < total; ++f)
      for (std::size_t k = 0; k < 3; ++k) {
        if (flags[first + f] == 0) continue;
        const std::uint32_t i = places.number_of[corners->places[(first + f) * 3 + k]];
        place_of[set.soup.faces()[f][k]] = i;
        if (moved.determinants[i] <= 0) folded[f] = 1;
      }
    const Soup changed = change_vertices(set.soup, flags, first, [&](std::uint32_t v, Vec3& position, Mat3& rotation) {
      const std::uint32_t i = place_of[v];
      if (places.world[i].allFinite() && moved.world[i] != places.world[i]) position = to_object * moved.world[i];
      if (!moved.rotations[i].isIdentity(0)) rotation = orthogonal_factor(moved.rotations[i] * rotation);
    });
    const Attributes attributes =
        changed.face_attributes().with(folded_attribute, Values<std::uint8_t>::of(std::move(folded)));
    set.soup = attributes == changed.face_attributes() ? changed : changed.with_face_attributes(attributes);
    first += total;
  }
  return {std::move(made), moved.report};
}

}  // namespace rebake
