// PackedRotation: a rotation or reflection per vertex in 20 bytes. turns.bin: the file of a scene folder that stores
// them.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/base/packed_rotation.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/rotations_json.h"
#include "mesh_ops/formats/rebake_scene/scene_folder.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

Mat3 about(const Vec3& axis, double angle) { return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix(); }

TEST(PackedRotation, PreservesRotationsAndReflections) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto check = [](const Mat3& m) {
    const PackedRotation turn(m);
    EXPECT_LE((turn.matrix() - m).cwiseAbs().maxCoeff(), 2e-15) << m;
    EXPECT_EQ(PackedRotation(turn.bytes()), turn);
  };
  for (int k = 0; k < 2000; ++k) {
    const Vec3 axis(normal(random), normal(random), normal(random));
    // Angles near 0, near 180°, and in general.
    for (const double angle :
         std::initializer_list<double>{1e-12, 1e-7, 1.0, std::numbers::pi - 1e-9, std::numbers::pi, 4.0 + 0.001 * k}) {
      check(about(axis, angle));
      check(-about(axis, angle));
    }
  }
}

TEST(PackedRotation, AxisPermutationsAreExact) {
  EXPECT_TRUE(PackedRotation().is_identity());
  EXPECT_TRUE(PackedRotation(Mat3::Identity()).is_identity());
  EXPECT_EQ(PackedRotation().matrix(), Mat3::Identity());
  int number = 0;
  const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const auto& order : orders)
    for (int signs = 0; signs < 8; ++signs) {
      Mat3 m = Mat3::Zero();
      for (int row = 0; row < 3; ++row) m(row, order[row]) = (signs >> row & 1) != 0 ? -1 : 1;
      EXPECT_EQ(PackedRotation(m).matrix(), m);
      ++number;
    }
  EXPECT_EQ(number, 48);
}

TEST(PackedRotation, AnyBytesAreOrthogonal) {
  std::mt19937 random(5);
  for (int k = 0; k < 2000; ++k) {
    std::array<std::uint8_t, PackedRotation::size> bytes{};
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(k == 0 ? 0xFF : random());
    EXPECT_TRUE(PackedRotation(bytes).matrix().isUnitary(1e-12));
  }
}

// Texture sets in which three of every seven faces are bent, one other face is rotated rigidly, and the rest is
// unchanged.
std::vector<TextureSet> bent_sets() {
  const auto object = made_object({.columns = 24, .rows = 12});
  std::vector<TextureSet> sets = object->sets;
  const Soup& soup = sets[0].soup;
  std::vector<std::uint8_t> flags(soup.triangle_count());
  for (std::size_t f = 0; f < flags.size(); ++f) flags[f] = f % 7 < 3 ? 1 : 0;
  Soup bent = change_vertices(soup, flags, 0, [](std::uint32_t vertex, Vec3& position, Mat3& turn) {
    position += Vec3(0, 0.1, 0);
    turn = about({1, 0.2, 0}, 0.01 * vertex);
  });
  flags.assign(flags.size(), 0);
  flags[4] = 1;
  sets[0].soup = move_faces(bent, flags, 0, Affine(Eigen::AngleAxisd(2, Vec3::UnitZ())), about({0, 0, 1}, 2));
  return sets;
}
std::vector<TextureSet> unturned(std::vector<TextureSet> sets) {
  for (TextureSet& set : sets)
    set.soup = Soup(set.soup.shared_positions(), set.soup.shared_uvs(), set.soup.shared_faces());
  return sets;
}
void expect_same_turns(const std::vector<TextureSet>& a, const std::vector<TextureSet>& b) {
  for (std::size_t s = 0; s < a.size(); ++s) {
    ASSERT_NE(b[s].soup.rotations(), nullptr);
    EXPECT_EQ(*a[s].soup.rotations(), *b[s].soup.rotations());
  }
}

TEST(TurnsFile, RoundTripIsBitExact) {
  const std::vector<TextureSet> sets = bent_sets();
  const std::string bytes = write_rotations(sets);
  std::vector<TextureSet> back = unturned(sets);
  read_rotations(bytes, "turns.bin", back);
  expect_same_turns(sets, back);
}

// Unwelded quads, as MobileNeRF bakes them, with a different rotation at each position.
TEST(TurnsFile, TakesAtMostTenBytesPerBentVertex) {
  std::vector<Vec3> positions;
  std::vector<Face> faces;
  constexpr int side = 40;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (int corner = 0; corner < 4; ++corner) positions.emplace_back(x + corner % 2, y + corner / 2, 0);
      faces.push_back({first, first + 1, first + 2});
      faces.push_back({first + 2, first + 1, first + 3});
    }
  std::vector<TextureSet> sets = made_object()->sets;
  sets.resize(1);
  const std::vector<Vec2> uvs(positions.size(), Vec2(0, 0));
  sets[0].soup = change_vertices(Soup(positions, uvs, faces), std::vector<std::uint8_t>(faces.size(), 1), 0,
                                 [](std::uint32_t, Vec3& position, Mat3& turn) {
                                   turn = about({1, position.x(), 2}, 0.1 + 0.01 * position.y());
                                   position.z() += 1;
                                 });
  const std::string bytes = write_rotations(sets);
  EXPECT_LE(bytes.size(), 20 * positions.size() / 2);
  std::vector<TextureSet> back = unturned(sets);
  read_rotations(bytes, "turns.bin", back);
  expect_same_turns(sets, back);
}

TEST(TurnsFile, ReadsTheOlderTextFormat) {
  const std::vector<TextureSet> sets = bent_sets();
  nlohmann::json runs = nlohmann::json::array();
  const Soup& soup = sets[0].soup;
  for (std::size_t f = 0; f < soup.triangle_count(); ++f) {
    nlohmann::json turns = nlohmann::json::array();
    for (const std::uint32_t vertex : soup.faces()[f]) {
      const Mat3 m = (*soup.rotations())[vertex].matrix();
      turns.push_back({m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)});
    }
    runs.push_back({f, 1, turns});
  }
  const nlohmann::json text = {{"rebake_turns", 1}, {"sets", {{{"set", 0}, {"runs", runs}}}}};
  std::vector<TextureSet> back = unturned(sets);
  read_rotations_json(text.dump(), "turns.json", back);
  for (std::size_t v = 0; v < soup.positions().size(); ++v)
    EXPECT_LE(((*back[0].soup.rotations())[v].matrix() - (*soup.rotations())[v].matrix()).norm(), 4e-15);
  // Also in a scene folder, until it is saved again.
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 24, .rows = 12}));
  object->sets = sets;
  const TemporaryFolder folder;
  const auto path = folder.path() / "scene";
  format_named("rebake").write(scene_of(object), path, {}, {});
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
    if (entry.path().filename() == "turns.bin") {
      std::filesystem::remove(entry.path());
      write_text(entry.path().parent_path() / "turns.json", text.dump());
      break;
    }
  const Scene scene = read_scene_folder(path, {});
  EXPECT_TRUE(scene.roots[0]->object->any_rotations());
}

// Inconsistent contents with a correct checksum.
TEST(TurnsFile, RejectsInconsistentContents) {
  std::vector<TextureSet> sets = made_object({.columns = 4, .rows = 2})->sets;
  sets.resize(1);
  const auto faces = static_cast<std::uint32_t>(sets[0].soup.triangle_count());
  ASSERT_LT(faces, 64U);
  const auto number = [](std::uint64_t value, int bytes) {
    std::string out;
    for (int k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 0xFF);
    return out;
  };
  const auto quarter = PackedRotation(about({0, 0, 1}, 1)).bytes();
  const std::string turn(quarter.begin(), quarter.end());
  const auto set = [&](std::uint32_t which, std::uint32_t of, std::uint32_t turns, const std::string& table,
                       const std::string& runs) {
    return number(which, 4) + number(of, 4) + number(turns, 4) + number(runs.size(), 4) + table + runs;
  };
  const auto read = [&](std::uint32_t count, const std::string& body, std::uint32_t version = 1) {
    const std::string counted = number(count, 4) + body;
    std::vector<TextureSet> back = sets;
    read_rotations("rebaketn" + number(version, 4) + number(content_hash(counted), 8) + counted, "turns.bin", back);
  };
  // One rotated face, the rest unrotated.
  const std::string one = std::string("\3\0\1\1", 4) + static_cast<char>(2 * (faces - 1));
  EXPECT_NO_THROW(read(1, set(0, faces, 1, turn, one)));
  const std::pair<const char*, std::function<void()>> wrong[] = {
      {"is damaged: its version is 0", [&] { read(1, set(0, faces, 1, turn, one), 0); }},
      {"version 2", [&] { read(1, set(0, faces, 1, turn, one), 2); }},
      {"a set that is not there", [&] { read(1, set(7, faces, 1, turn, one)); }},
      {"a set twice", [&] { read(2, set(0, faces, 1, turn, one) + set(0, faces, 1, turn, one)); }},
      {"other faces", [&] { read(1, set(0, faces + 1, 1, turn, one)); }},
      {"more turns than follow", [&] { read(1, set(0, faces, 4000000000U, turn, one)); }},
      {"turns that nothing has", [&] { read(1, set(0, faces, 2, turn + turn, one)); }},
      {"a turn before the first", [&] { read(1, set(0, faces, 1, turn, std::string("\3\0\2\1", 4) + one.substr(4))); }},
      {"a turn behind the last", [&] { read(1, set(0, faces, 1, turn, std::string("\3\0\0\1", 4) + one.substr(4))); }},
      {"a run of no faces", [&] { read(1, set(0, faces, 0, "", std::string(1, '\0'))); }},
      {"a run that is too long",
       [&] { read(1, set(0, faces, 0, "", std::string(1, static_cast<char>(2 * faces + 2)))); }},
      {"a number without an end", [&] { read(1, set(0, faces, 0, "", std::string(12, '\x80'))); }},
      {"faces that stop early", [&] { read(1, set(0, faces, 0, "", "\2")); }},
      {"more than the faces",
       [&] { read(1, set(0, faces, 0, "", std::string(1, static_cast<char>(2 * faces)) + "\2")); }},
      {"more than the sets", [&] { read(1, set(0, faces, 1, turn, one) + "x"); }},
  };
  for (const auto& [name, attempt] : wrong) EXPECT_THROW(attempt(), FileError) << name;
}

TEST(TurnsFile, RejectsTruncatedChangedOrForeignFiles) {
  const std::vector<TextureSet> sets = bent_sets();
  const std::string bytes = write_rotations(sets);
  const auto refused = [&](const std::string& changed) {
    std::vector<TextureSet> back = unturned(sets);
    try {
      read_rotations(changed, "some/turns.bin", back);
    } catch (const FileError& error) {
      EXPECT_NE(std::string(error.what()).find("some/turns.bin"), std::string::npos);
      return true;
    }
    return false;
  };
  for (std::size_t length = 0; length < bytes.size(); length += 17) EXPECT_TRUE(refused(bytes.substr(0, length)));
  for (std::size_t at = 0; at < bytes.size(); at += 13) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ 0x10);
    EXPECT_TRUE(refused(changed)) << at;
  }
  EXPECT_TRUE(refused(bytes + "x"));
  std::vector<TextureSet> other = made_object({.columns = 4, .rows = 2})->sets;
  EXPECT_THROW(read_rotations(bytes, "turns.bin", other), FileError);
  std::vector<TextureSet> none;
  EXPECT_THROW(read_rotations(bytes, "turns.bin", none), FileError);
}

}  // namespace
}  // namespace rebake::test
