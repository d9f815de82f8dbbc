// A script gives the same bytes on every processor: with the C library's code without fused multiply-adds, and at every
// vector width.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "mesh_ops/base/files.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

// Deforming edits, whose formulas contain elementary functions.
constexpr const char* deforming_script = R"(
{"op": "import", "path": "{ficus}", "as": "ficus"}
{"op": "bend", "node": "ficus", "degrees": 50, "axis": [1, 0.3, 0.2], "direction": [0, 1, 0]}
{"op": "twist", "node": "ficus", "degrees": 70, "axis": [0.1, 1, 0]}
{"op": "handles", "node": "ficus", "wrap": 0.1, "iterations": 30, "frame": "bounds", "fixed": [{"box": {"min": [-1, -1, -1], "max": [2, 0.35, 2]}}], "moves": [{"box": {"min": [-1, 0.8, -1], "max": [2, 2, 2]}, "translate": [-0.1, 0.3, 0]}]}
{"op": "cage", "node": "ficus", "lattice": [2, 2, 2], "coordinates": "green", "moves": [{"box": {"min": [0, 0.9, 0], "max": [1, 1, 1]}, "translate": [0.2, 0.1, 0]}], "frame": "bounds"}
{"op": "save", "out": "{out}"}
)";

std::map<std::string, std::string> result_of(const fs::path& folder, const std::string& name,
                                             const std::string& environment) {
  const std::string command = fmt::format(
      "{} '{}' run '{}' --var 'ficus={}/samples/scenes/ficus' --var 'out={}' >'{}' 2>&1", environment, REBAKE_PROGRAM,
      (folder / "script.jsonl").string(), REBAKE_SOURCE, (folder / name).string(), (folder / (name + ".log")).string());
  EXPECT_EQ(std::system(command.c_str()), 0) << read_file(folder / (name + ".log"));
  return folder_bytes(folder / name);
}

TEST(SameBits, OnEveryProcessorAndCLibraryPath) {
  const TemporaryFolder folder;
  write_file_atomically(folder.path() / "script.jsonl", deforming_script, {});
  const auto expected = result_of(folder.path(), "plain", "");
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(result_of(folder.path(), "no-fma", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2_Usable"), expected);
  EXPECT_EQ(result_of(folder.path(), "v1", "REBAKE_VECTORS=1"), expected);
  EXPECT_EQ(result_of(folder.path(), "v3", "REBAKE_VECTORS=3"), expected);
}

}  // namespace
}  // namespace rebake::test
