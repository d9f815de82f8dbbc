// The table of formats.
#include "mesh_ops/formats/formats.h"

#include <gtest/gtest.h>

#include "mesh_ops/base/error.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

TEST(Formats, RoundTrip) {
  const Scene scene = scene_of(made_object(), "ball");
  const TemporaryFolder folder;
  for (const Format& format : formats()) {
    if (format.read == nullptr || format.write == nullptr) continue;
    const auto out = folder.path() / (std::string(format.name) + (format.is_folder ? "" : format.marker));
    format.write(scene, out, {}, {});
    EXPECT_TRUE(format.recognises(out)) << format.name;
    EXPECT_EQ(format.read(out, Axes::y_up, {}).roots[0]->object->triangle_count(), 256U) << format.name;
    EXPECT_EQ(&format_named(format.name), &format);
  }
  EXPECT_THROW(format_named("glb"), FieldError);
  EXPECT_THROW(format_named("rebake").write(scene, folder.path() / "x", {Layout::split, {}}, {}), FieldError);
}

TEST(Formats, MainFilesStandForTheirFolder) {
  const TemporaryFolder folder;
  const Scene scene = scene_of(made_object(), "ball");
  format_named("mobilenerf").write(scene, folder.path() / "plain", {}, {});
  format_named("rebake").write(scene, folder.path() / "scene", {}, {});
  EXPECT_EQ(read_any(folder.path() / "plain/mlp.json", Axes::y_up).roots[0]->name, "plain");
  EXPECT_EQ(read_any(folder.path() / "scene/scene.json", Axes::y_up).roots[0]->name, "ball");
  EXPECT_THROW(read_any(folder.path() / "plain/shape0.obj", Axes::y_up), FileError);
}

}  // namespace
}  // namespace rebake::test
