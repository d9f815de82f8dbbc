// Memory of opening, editing and exporting a large texture set: its texels must be in memory once, not once per step.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <random>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/formats/formats.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// Peak resident memory of the program while it runs a script, in bytes.
double peak_memory(const std::filesystem::path& folder, const std::string& script) {
  write_text(folder / "s.jsonl", script);
  const std::string file = folder / "s.jsonl", log = folder / "log";
  const pid_t child = fork();
  if (child == 0) {
    ::dup2(::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), 2);
    ::execl(REBAKE_PROGRAM, REBAKE_PROGRAM, "run", file.c_str(), static_cast<char*>(nullptr));
    ::_exit(99);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0) << read_file(log);
  return static_cast<double>(usage.ru_maxrss) * 1024;
}

// A flat sheet of quads with random texels, which neither PNG nor LZ4 can compress.
std::shared_ptr<const BakedObject> noisy_sheet(int side) {
  constexpr int quads = 16;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  for (int j = 0; j < quads; ++j)
    for (int i = 0; i < quads; ++i) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1)}) {
        positions.emplace_back(i + corner.x(), j + corner.y(), 0);
        uvs.push_back((Vec2(i, j) + Vec2::Constant(0.01) + 0.98 * corner) / quads);
      }
      faces.push_back({first, first + 1, first + 3});
      faces.push_back({first, first + 3, first + 2});
    }
  auto object = std::make_shared<BakedObject>(*made_object());
  object->sets = {{Soup(std::move(positions), std::move(uvs), std::move(faces)),
                   std::make_shared<const FeatureTexture>(
                       FeatureTexture::from_rows(side, side, AlphaCode::halved, [&](int y, Texel* row) {
                         std::mt19937_64 random(static_cast<std::uint64_t>(y));
                         for (int x = 0; x < side; ++x) row[x] = std::bit_cast<Texel>(random() | 1U);
                       }))}};
  return object;
}

TEST(ExportMemory, LargeEditedSetIsInMemoryOnce) {
#ifdef REBAKE_SANITIZED
  GTEST_SKIP() << "sanitizers use additional memory";
#endif
  const TemporaryFolder folder;
  constexpr int side = 4096;
  export_scene(scene_of(noisy_sheet(side)), folder.path() / "large", {});
  export_scene(scene_of(made_object()), folder.path() / "small", {});
  const auto script = [&](const char* name) {
    return fmt::format(R"({{"op": "import", "path": "{0}/{1}"}}
{{"op": "select", "frame": "bounds", "box": {{"min": [0.2, 0.2, 0], "max": [0.5, 0.5, 1]}}}}
{{"op": "delete"}}
{{"op": "export", "out": "{0}/out"}}
)",
                       folder.path().string(), name);
  };
  constexpr double decoded = 8.0 * side * side;
  const double small = peak_memory(folder.path(), script("small"));
  EXPECT_LE(peak_memory(folder.path(), script("large")) - small, 1.5 * decoded);
  EXPECT_LT(read_any(folder.path() / "out", Axes::y_up).roots[0]->object->sets[0].texels->width(), side);
}

}  // namespace
}  // namespace rebake::test
