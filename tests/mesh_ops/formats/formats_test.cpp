// The table of formats.
#include "mesh_ops/formats/formats.h"

#include <gtest/gtest.h>

#include "mesh_ops/base/error.h"
#include "tests/support/made_scenes.h"
#include "tests/support/nerf2mesh_example.h"

namespace rebake::test {
namespace {

TEST(Formats, RoundTrip) {
  const TemporaryFolder folder;
  write_nerf2mesh_example(folder.path() / "foreign");
  const Scene ball = scene_of(made_object(), "ball"), foreign = read_any(folder.path() / "foreign", Axes::y_up);
  for (const Format& format : formats()) {
    if (format.read == nullptr || format.write == nullptr) continue;
    const Scene& scene = std::string(format.name) == "nerf2mesh" ? foreign : ball;
    const auto out = folder.path() / (std::string(format.name) + (format.is_folder ? "" : format.marker));
    format.write(scene, out, {}, {});
    EXPECT_TRUE(format.recognises(out)) << format.name;
    EXPECT_EQ(format.read(out, Axes::y_up, {}).roots[0]->object->triangle_count(),
              scene.roots[0]->object->triangle_count())
        << format.name;
    EXPECT_EQ(&format_named(format.name), &format);
  }
  EXPECT_THROW(format_named("ply"), FieldError);
  EXPECT_THROW(format_named("rebake").write(ball, folder.path() / "x", {Layout::split, {}}, {}), FieldError);
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
