// Writes the large synthetic scene: rebake_synthetic FOLDER [TRIANGLES]
#include <fmt/format.h>

#include <charconv>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"
#include "mesh_ops/formats/scene_files.h"
#include "samples/synthetic/large_scene.h"

int main(int argc, char** argv) {
  using namespace rebake;
  LargeSceneOptions options;
  bool right = argc == 2 || argc == 3;
  if (argc == 3) {
    const std::string_view text = argv[2];
    const auto [end, error] = std::from_chars(text.begin(), text.end(), options.triangles);
    right = error == std::errc() && end == text.end() && options.triangles >= 2 * options.sets;
  }
  if (!right || std::string_view(argv[1]).starts_with("-")) {
    fmt::print(stderr,
               "Writes a synthetic scene as large as a real unbounded one (8 texture sets of 8 chunks), for "
               "benchmarks.\nUsage: rebake_synthetic FOLDER [TRIANGLES]\n  TRIANGLES   at least 16 (default 723000)\n");
    return 2;
  }
  try {
    AtomicFolder out(argv[1], {}, refuse_foreign_content);
    std::vector<std::string> notes;
    // Write the sets unchanged; an export would pack them again.
    constexpr bool as_made = true;
    write_baked_folder(out, {}, *large_synthetic_scene(options), Layout::chunked, notes, {}, as_made);
    out.commit();
  } catch (const Error& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return 1;
  }
}
