// Runs the readers on the fuzzing corpus: no crash, no hang, no exception except rebake::Error.
#include <gtest/gtest.h>

#include <filesystem>

#include "mesh_ops/base/files.h"
#include "tests/fuzz/targets.h"

namespace rebake::test {
namespace {

TEST(FuzzCorpus, EveryInputIsReadOrRejected) {
  std::size_t inputs = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(REBAKE_SOURCE) / "tests/fuzz/corpus")) {
    if (!entry.is_regular_file()) continue;
    const std::string bytes = read_file(entry.path());
    EXPECT_NO_THROW(fuzz::read_obj_bytes(bytes)) << entry.path();
    EXPECT_NO_THROW(fuzz::read_json_bytes(bytes)) << entry.path();
    EXPECT_NO_THROW(fuzz::read_camera_bytes(bytes)) << entry.path();
    EXPECT_NO_THROW(fuzz::read_mesh_bytes(bytes)) << entry.path();
    EXPECT_NO_THROW(fuzz::read_script_bytes(bytes)) << entry.path();
    EXPECT_NO_THROW(fuzz::read_volume_bytes(bytes)) << entry.path();
    ++inputs;
  }
  EXPECT_GE(inputs, 3U);
}

}  // namespace
}  // namespace rebake::test
