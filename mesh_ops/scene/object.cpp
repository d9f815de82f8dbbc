#include "mesh_ops/scene/object.h"

#include <algorithm>
#include <set>

namespace rebake {

std::size_t BakedObject::triangle_count() const {
  std::size_t total = 0;
  for (const TextureSet& set : sets) total += set.soup.triangle_count();
  return total;
}

std::size_t BakedObject::vertex_count() const {
  std::size_t total = 0;
  for (const TextureSet& set : sets) total += set.soup.positions().size();
  return total;
}

std::uint64_t BakedObject::opaque_texel_count() const {
  std::set<const FeatureTexture*> seen;
  std::uint64_t total = 0;
  for (const TextureSet& set : sets)
    if (seen.insert(set.texels.get()).second) total += set.texels->opaque_count();
  return total;
}

Box BakedObject::bounds() const {
  Box box;
  for (const TextureSet& set : sets) box.extend(set.soup.bounds());
  return box;
}

bool BakedObject::any_rotations() const {
  return std::any_of(sets.begin(), sets.end(), [](const TextureSet& set) { return set.soup.rotations() != nullptr; });
}

std::uint64_t BakedObject::memory() const {
  SharedTotals totals;
  totals.add(*this);
  return totals.memory();
}

void SharedTotals::add(const BakedObject& object) {
  const auto count = [&](const void* data, std::uint64_t bytes) {
    if (seen_.insert(data).second) memory_ += bytes;
  };
  for (const TextureSet& set : object.sets) {
    const Soup& soup = set.soup;
    count(soup.shared_positions().get(), soup.positions().size() * sizeof(Vec3));
    count(soup.shared_uvs().get(), soup.uvs().size() * sizeof(Vec2));
    count(soup.shared_faces().get(), soup.faces().size() * sizeof(Face));
    for (const Attributes* attributes : {&soup.vertex_attributes(), &soup.face_attributes()})
      for (const auto& [name, attribute] : *attributes) count(attribute.get(), attribute->memory());
    const FeatureTexture& texels = *set.texels;
    if (!seen_.insert(&texels).second) continue;
    for (int row = 0; row < texels.tile_rows(); ++row)
      for (int column = 0; column < texels.tile_columns(); ++column) {
        const TexelTile& tile = *texels.tile(column, row);
        count(&tile, tile.memory());
        // Edited textures share the tiles that stay, at their places. One texture may also have equal tiles.
        if (tiles_.insert({&tile, column, row}).second) opaque_texels_ += tile.opaque_count();
      }
  }
}

std::vector<BakedBody> bodies_of(const BakedObject& object) {
  if (!object.bodies.empty()) return object.bodies;
  return {{std::make_shared<const BakedObject>(object), Affine::Identity()}};
}

void record_bodies(BakedObject& made, const BakedObject& of) {
  if (made.bodies.empty()) made.bodies = bodies_of(of);
}

bool same_body(const BakedBody& a, const BakedBody& b) {
  const auto same_set = [](const TextureSet& x, const TextureSet& y) {
    return x.texels == y.texels && x.soup.shared_positions() == y.soup.shared_positions() &&
           x.soup.shared_uvs() == y.soup.shared_uvs() && x.soup.shared_faces() == y.soup.shared_faces();
  };
  return a.to_object.matrix() == b.to_object.matrix() &&
         (a.object == b.object || std::equal(a.object->sets.begin(), a.object->sets.end(), b.object->sets.begin(),
                                             b.object->sets.end(), same_set));
}

// Whether the object is unchanged since it was read from the origin's files.
static bool as_read(const BakedObject& object) {
  return object.origin && object.bodies.empty() && object.decoder == object.origin->decoder &&
         std::equal(object.sets.begin(), object.sets.end(), object.origin->sets.begin(), object.origin->sets.end(),
                    [](const TextureSet& set, const Origin::Set& read) {
                      return set.texels == read.texels.lock() && set.soup.shared_positions() == read.positions.lock() &&
                             set.soup.shared_uvs() == read.uvs.lock() && set.soup.shared_faces() == read.faces.lock() &&
                             set.soup.vertex_attributes() == Attributes() && set.soup.face_attributes() == Attributes();
                    });
}

bool same_source(const BakedObject& a, const BakedObject& b) {
  return as_read(a) && as_read(b) && a.axes == b.axes && a.layout == b.layout && a.origin->folder == b.origin->folder &&
         a.origin->mlp == b.origin->mlp &&
         std::equal(a.origin->sets.begin(), a.origin->sets.end(), b.origin->sets.begin(), b.origin->sets.end(),
                    [](const Origin::Set& x, const Origin::Set& y) {
                      return x.geometry == y.geometry && x.feat0 == y.feat0 && x.feat1 == y.feat1;
                    });
}

std::size_t count(const TriangleSet& triangles) {
  return static_cast<std::size_t>(std::count_if(triangles.begin(), triangles.end(), [](auto f) { return f != 0; }));
}

}  // namespace rebake
