#include "editor/studies/dprt/animated_object.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "editor/studies/dprt/traced_frames.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/light/learned/disk_chart.h"
#include "tests/support/made_scenes.h"

namespace rebake {
namespace {

AnimatedObject object_of(const std::string& name, int frames) {
  return name == "head" ? animated_head(frames) : name == "fish" ? animated_fish(frames) : animated_cloth(frames);
}

class AnimatedObjects : public testing::TestWithParam<const char*> {};

TEST_P(AnimatedObjects, HaveOneBoundaryAndMoveSmoothly) {
  // 500 frames of a period that is known by its first ones: the cloth is simulated from the start.
  constexpr int frames = 500, looked_at = 12;
  const AnimatedObject object = object_of(GetParam(), GetParam() == std::string("cloth") ? looked_at : frames);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  for (const Face& face : object.rest.faces)
    for (std::size_t k = 0; k < 3; ++k) ++sides[std::minmax(face[k], face[(k + 1) % 3])];
  std::map<std::uint32_t, std::vector<std::uint32_t>> border;
  for (const auto& [edge, count] : sides) {
    ASSERT_LE(count, 2);
    if (count == 2) continue;
    border[edge.first].push_back(edge.second);
    border[edge.second].push_back(edge.first);
  }
  ASSERT_FALSE(border.empty());
  std::uint32_t at = border.begin()->first, last = at;
  std::size_t walked = 0;
  do {
    ASSERT_EQ(border[at].size(), 2U);
    const std::uint32_t next = border[at][0] == last ? border[at][1] : border[at][0];
    last = at;
    at = next;
    ++walked;
  } while (at != border.begin()->first && walked <= border.size());
  EXPECT_EQ(walked, border.size()) << "one loop";

  const double size = bounds(object.rest).diagonal().norm();
  double fastest = 0, farthest = 0;
  for (std::size_t k = 1; k < looked_at; ++k)
    for (std::size_t v = 0; v < object.rest.vertices.size(); ++v) {
      fastest = std::max(fastest, (object.frames[k][v] - object.frames[k - 1][v]).norm());
      farthest = std::max(farthest, (object.frames[k][v] - object.rest.vertices[v]).norm());
    }
  EXPECT_LT(fastest, 0.04 * size);
  EXPECT_GT(farthest, 0.02 * size);
}

TEST_P(AnimatedObjects, AreLaidOutWithoutFolds) {
  const AnimatedObject object = object_of(GetParam(), 1);
  const DiskChart chart = disk_chart(object.rest);
  EXPECT_EQ(chart.source.size(), object.rest.vertices.size()) << "nothing is cut";
  double least = 1;
  for (const Face& face : chart.faces) {
    const Vec2 e = chart.uvs[face[1]] - chart.uvs[face[0]], f = chart.uvs[face[2]] - chart.uvs[face[0]];
    least = std::min(least, e.x() * f.y() - e.y() * f.x());
  }
  // The corners of the fish have no area: two of their edges are on one side of the square.
  EXPECT_GE(least, GetParam() == std::string("fish") ? 0 : 1e-9);
  EXPECT_FALSE(chart.mean_value);
  EXPECT_LT(GeometryImage(chart, 64).undersampled(object.rest), 0.5);
}

INSTANTIATE_TEST_SUITE_P(Object, AnimatedObjects, testing::Values("head", "fish", "cloth"));

TEST(AnimatedFiles, AreReadInOrderAndMustHaveTheSameTriangles) {
  const test::TemporaryFolder folder;
  for (int k = 0; k < 20; ++k)
    write_file_atomically(folder.path() / ("f" + std::to_string(100 + k) + ".obj"),
                          "v 0 0 " + std::to_string(k) + "\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n", {});
  const AnimatedObject object = animated_files((folder.path() / "f*.obj").string());
  ASSERT_EQ(object.frames.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k) EXPECT_EQ(object.frames[k][0].z(), static_cast<double>(k));
  write_file_atomically(folder.path() / "f200.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 4\nf 2 3 4\n", {});
  EXPECT_THROW(animated_files((folder.path() / "f*.obj").string()), FileError);
  EXPECT_THROW(animated_files((folder.path() / "g*.obj").string()), Error);
}

TEST(TracedFrames, GoOnFromTheirCache) {
  const test::TemporaryFolder folder;
  const AnimatedObject object = animated_cloth(7);
  constexpr int side = 32, rays = 16;
  const TracedFrames at_once = traced_frames(object, side, rays, {}, {});
  const auto start = folder.path() / "traces";
  int reports = 0;
  const Progress stops([&](std::string_view what, double) {
    if (what.starts_with("tracing 7 frames") && ++reports == 3) throw Cancelled();
  });
  EXPECT_THROW(traced_frames(object, side, rays, start, stops), Cancelled);
  const std::filesystem::path cache = std::filesystem::directory_iterator(folder.path())->path();
  // A kill may leave a part of a frame.
  std::filesystem::resize_file(cache, std::filesystem::file_size(cache) - 100);
  EXPECT_EQ(traced_frames(object, side, rays, start, {}).transfer, at_once.transfer);
  EXPECT_EQ(traced_frames(object, side, rays, start, {}).transfer, at_once.transfer) << "from the cache alone";
  // Held-out frames have more rays.
  EXPECT_EQ(at_once.transfer[5], traced_planes(at_once.rest, at_once.frames[5], truth_rays_per_ray * rays));
  EXPECT_EQ(at_once.transfer[6], traced_planes(at_once.rest, at_once.frames[6], rays));
  // Traces of another layout of the same vertices are not taken.
  AnimatedObject other = object;
  for (Face& face : other.rest.faces) std::rotate(face.begin(), face.begin() + 1, face.end());
  for (Vec3& p : other.rest.vertices) p.x() *= 2;
  EXPECT_EQ(traced_frames(other, side, rays, start, {}).transfer, traced_frames(other, side, rays, {}, {}).transfer);
}

TEST(TracedFrames, NeverWriteThroughLinks) {
  constexpr int side = 16, rays = 4;
  AnimatedObject object = animated_head(500);
  object.frames.resize(2);
  const test::TemporaryFolder folder;
  const std::filesystem::path source = folder.path() / "source.obj";
  traced_frames(object, side, rays, folder.path() / "head", {});
  const std::filesystem::path cache = *std::filesystem::directory_iterator(folder.path());
  for (const bool hard : {false, true}) {
    std::filesystem::remove(cache);
    test::write_text(source, "mine");
    hard ? std::filesystem::create_hard_link(source, cache) : std::filesystem::create_symlink(source, cache);
    traced_frames(object, side, rays, folder.path() / "head", {});
    EXPECT_EQ(read_file(source), "mine");
    EXPECT_GT(std::filesystem::file_size(cache), 100U);
  }
  // A copy by hard link is read, and the other name keeps it.
  std::filesystem::create_hard_link(cache, folder.path() / "copy");
  const std::string copied = read_file(cache);
  const Progress traces([](std::string_view what, double) { EXPECT_FALSE(what.starts_with("tracing")) << what; });
  traced_frames(object, side, rays, folder.path() / "head", traces);
  EXPECT_EQ(read_file(folder.path() / "copy"), copied);
  EXPECT_EQ(std::filesystem::hard_link_count(cache), 1U);
}

}  // namespace
}  // namespace rebake
