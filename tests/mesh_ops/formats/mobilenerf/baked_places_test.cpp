// baked.bin, a file of a scene folder: displacement of each vertex since its light was baked, and body of each face.
#include <gtest/gtest.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// Two texture sets. In the first, two of every five faces have moved, each vertex by a different offset, and the last
// third of the faces belongs to body 300. The second is unchanged.
std::vector<TextureSet> moved_sets() {
  std::vector<TextureSet> sets = made_object({.columns = 24, .rows = 12})->sets;
  sets.push_back(made_object({.columns = 8, .rows = 4})->sets[0]);  // unchanged: must get no attributes
  const std::size_t faces = sets[0].soup.triangle_count();
  std::vector<std::uint8_t> flags(faces);
  for (std::size_t f = 0; f < faces; ++f) flags[f] = f % 5 < 2 ? 1 : 0;
  const Soup moved = change_vertices(sets[0].soup, flags, 0, [](std::uint32_t vertex, Vec3& position, Mat3&) {
    position += Vec3(0.1, 1e-3 * vertex, -1.0 / 3);
  });
  std::vector<std::uint16_t> bodies(faces, 0);
  for (std::size_t f = faces * 2 / 3; f < faces; ++f) bodies[f] = 300;
  sets[0].soup = moved.with_face_attributes(
      moved.face_attributes().with(BakedObject::body, Values<std::uint16_t>::of(std::move(bodies))));
  return sets;
}

std::vector<TextureSet> bare(std::vector<TextureSet> sets) {
  for (TextureSet& set : sets)
    set.soup = Soup(set.soup.shared_positions(), set.soup.shared_uvs(), set.soup.shared_faces());
  return sets;
}

constexpr std::size_t number_of_bodies = 301;

TEST(BakedPlaces, RoundTripIsBitExact) {
  const std::vector<TextureSet> sets = moved_sets();
  ASSERT_TRUE(any_baked_positions(sets));
  EXPECT_FALSE(any_baked_positions(bare(sets)));
  std::vector<TextureSet> back = bare(sets);
  read_baked_positions(write_baked_positions(sets), "baked.bin", number_of_bodies, back);
  const auto displaced = [](const TextureSet& set) {
    return *set.soup.vertex_attributes().find<Eigen::Vector3f>(Soup::displacement);
  };
  const auto body = [](const TextureSet& set) {
    return *set.soup.face_attributes().find<std::uint16_t>(BakedObject::body);
  };
  EXPECT_EQ(displaced(back[0]), displaced(sets[0]));
  EXPECT_EQ(body(back[0]), body(sets[0]));
  for (std::size_t s = 1; s < sets.size(); ++s)
    EXPECT_EQ(back[s].soup.vertex_attributes().begin(), back[s].soup.vertex_attributes().end());
}

TEST(BakedPlaces, RejectsTruncatedChangedOrForeignFiles) {
  const std::vector<TextureSet> sets = moved_sets();
  const std::string bytes = write_baked_positions(sets);
  const auto refused = [&](const std::string& changed, std::size_t body_count = number_of_bodies) {
    std::vector<TextureSet> back = bare(sets);
    try {
      read_baked_positions(changed, "some/baked.bin", body_count, back);
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("some/baked.bin"), std::string::npos);
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(bytes));
  EXPECT_TRUE(refused(bytes, number_of_bodies - 1)) << "refers to a body that does not exist";
  for (std::size_t length = 0; length < bytes.size(); length += 29) EXPECT_TRUE(refused(bytes.substr(0, length)));
  for (std::size_t at = 0; at < bytes.size(); at += 31) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    EXPECT_TRUE(refused(changed)) << at;
  }
  // A NaN displacement with a correct checksum.
  std::string counted = bytes.substr(20);
  const auto first_value = std::size_t{4 + 4 + 4 + 4 + 4};
  counted.replace(first_value, 4, std::string("\0\0\xC0\x7F", 4));
  std::string changed = bytes.substr(0, 12);
  const std::uint64_t hash = content_hash(counted);
  for (int k = 0; k < 8; ++k) changed += static_cast<char>(hash >> (8 * k) & 0xFF);
  EXPECT_TRUE(refused(changed + counted));
}

}  // namespace
}  // namespace rebake::test
