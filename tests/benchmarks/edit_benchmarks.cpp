// Selections and edits on the real mic (argument 1), on nine of it with 741,789 triangles (argument 9), and on a
// synthetic unbounded scene of 723,000 triangles (argument 0). Without REBAKE_TEST_DATA a generated sphere replaces the
// mic.
#include <benchmark/benchmark.h>

#include "editor/document/document.h"
#include "mesh_ops/formats/export.h"
#include "mesh_ops/index/index.h"
#include "samples/synthetic/large_scene.h"
#include "tests/support/edits.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

const Scene& scene_at(std::int64_t tiles) {
  if (tiles == 0) {
    static const Scene synthetic = scene_of(large_synthetic_scene(), "synthetic");
    return synthetic;
  }
  static const auto one = [] {
    const auto mic = mic_object();
    return mic ? mic : made_object({.columns = 256, .rows = 160});
  }();
  static const Scene small = scene_of(one), large = scene_of(tiled(*one));
  return tiles == 1 ? small : large;
}

const BakedObject& object_of(const Scene& scene) { return *scene.roots[0]->object; }

Camera camera_of(const Scene& scene) { return framing(world_bounds(scene), 1, false); }

// A copy with its own arrays, for which no index is cached.
BakedObject uncached_copy(const BakedObject& object) {
  BakedObject fresh = object;
  fresh.decoder = std::make_shared<const Decoder>(*object.decoder);
  for (TextureSet& set : fresh.sets) {
    set.soup = Soup(set.soup.positions(), set.soup.uvs(), set.soup.faces());
    set.texels = std::make_shared<const FeatureTexture>(*set.texels);
  }
  return fresh;
}

void index(benchmark::State& state) {
  for (auto _ : state) {
    state.PauseTiming();
    const BakedObject fresh = uncached_copy(object_of(scene_at(state.range(0))));
    state.ResumeTiming();
    prepare_index(fresh);
  }
}
void index_part(benchmark::State& state, void (*part)(const BakedObject&)) {
  for (auto _ : state) {
    state.PauseTiming();
    const BakedObject fresh = uncached_copy(object_of(scene_at(state.range(0))));
    state.ResumeTiming();
    part(fresh);
  }
}
void traits(const BakedObject& object) { traits_of(object); }
void components(const BakedObject& object) { components_of(object); }
void rays(const BakedObject& object) { rays_of(object); }

// One edit, repeated on the same scene with a cached index.
void edit(benchmark::State& state, Edit (*make)(const Scene&), bool half_selected) {
  Scene scene = scene_at(state.range(0));
  prepare_index(object_of(scene));
  if (half_selected) {
    Select half;
    half.half_space = HalfSpaceRegion{Vec3(0.5, 0.5, 0.5), Vec3(1, 0.1, 0)};
    half.frame = CoordinateFrame::bounds;
    scene = rebake::apply(scene, half);
  }
  const Edit made = make(scene);
  for (auto _ : state) benchmark::DoNotOptimize(rebake::apply(scene, made));
}

Edit select_box(const Scene&) {
  Select edit;
  edit.box = BoxRegion{Vec3(0, 0.5, 0), Vec3(1, 1, 1)};
  edit.frame = CoordinateFrame::bounds;
  return edit;
}
Edit select_invert(const Scene&) {
  Select edit;
  edit.invert = true;
  return edit;
}
Edit brush_visible(const Scene& scene) {
  SelectPicture edit;
  edit.picture.camera = camera_of(scene);
  edit.picture.brush = BrushStroke{{Vec2(300, 400), Vec2(500, 450)}, 30};
  return edit;
}
Edit polygon_through(const Scene& scene) {
  SelectPicture edit;
  edit.picture.camera = camera_of(scene);
  edit.picture.polygon = PixelPolygon{{Vec2(100, 100), Vec2(700, 200), Vec2(400, 700)}};
  edit.through = true;
  return edit;
}
Edit whole_picture_visible(const Scene& scene) {
  SelectPicture edit;
  edit.picture.camera = camera_of(scene);
  edit.picture.polygon = PixelPolygon{{Vec2(0, 0), Vec2(800, 0), Vec2(800, 800), Vec2(0, 800)}};
  return edit;
}
Edit connected(const Scene&) {
  SelectConnected edit;
  edit.point = Vec3(0, 0, 0);
  return edit;
}
Edit like_color(const Scene&) {
  SelectLike edit;
  edit.point = Vec3(0, 0, 0);
  edit.color = 0.1;
  edit.size = 4;
  return edit;
}
Edit floaters(const Scene&) { return SelectFloaters{}; }
Edit grow(const Scene&) { return Grow{}; }
Edit fill(const Scene&) { return Fill{}; }
Edit delete_half(const Scene&) { return DeleteSelected{}; }
Edit erase_sphere(const Scene&) {
  Erase edit;
  edit.sphere = SphereRegion{Vec3(0.5, 0.5, 0.5), 0.1};
  edit.frame = CoordinateFrame::bounds;
  return edit;
}

// A selection right after an edit, with the index cached from before the edit.
void after(benchmark::State& state, Edit (*change)(const Scene&, std::int64_t), Edit (*make)(const Scene&)) {
  const Scene& scene = scene_at(state.range(0));
  prepare_index(object_of(scene));
  std::int64_t number = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Scene changed = rebake::apply(scene, change(scene, ++number)).scene;
    const Edit made = make(changed);
    state.ResumeTiming();
    benchmark::DoNotOptimize(rebake::apply(changed, made));
  }
}
// A different bend each time, of a part of three tiles.
Edit bent(const Scene&, std::int64_t number) {
  Bend edit;
  edit.degrees = 5 + 0.01 * static_cast<double>(number);
  edit.target.node = NodeRef{NodeId{1}};
  edit.target.box = BoxRegion{Vec3(0, 0, 0), Vec3(0.1, 1, 1)};
  edit.target.frame = CoordinateFrame::bounds;
  return edit;
}
Edit stroke(const Scene& scene, std::int64_t number) {
  const Soup& soup = object_of(scene).sets[0].soup;
  const Face& face = soup.faces()[static_cast<std::size_t>(number) * 100];
  Erase edit;
  edit.sphere = SphereRegion{(soup.positions()[face[0]] + soup.positions()[face[1]] + soup.positions()[face[2]]) / 3,
                             0.005 * soup.bounds().diagonal().norm()};
  return edit;
}

// Undo and redo of deleting half of the triangles.
void undo_and_redo(benchmark::State& state) {
  Document document(scene_at(state.range(0)));
  Select half;
  half.half_space = HalfSpaceRegion{Vec3(0.5, 0.5, 0.5), Vec3(1, 0.1, 0)};
  half.frame = CoordinateFrame::bounds;
  document.edit(half);
  document.edit(DeleteSelected{});
  for (auto _ : state) {
    document.undo();
    document.redo();
  }
}
// Release of a drag that bends half of the triangles. Second argument: whether the preview's result is used.
void release(benchmark::State& state) {
  Scene scene = scene_at(state.range(0));
  Select half;
  half.half_space = HalfSpaceRegion{Vec3(0.5, 0.5, 0.5), Vec3(1, 0.1, 0)};
  half.frame = CoordinateFrame::bounds;
  scene = rebake::apply(scene, half);
  Bend bend;
  bend.target.node = NodeRef{scene.roots[0]->id};
  bend.target.selection = true;
  bend.degrees = 30;
  const std::vector<Edit> edits{bend};
  const AppliedEdits made = apply_edits(scene, edits);
  for (auto _ : state) {
    state.PauseTiming();
    Document document(scene);
    state.ResumeTiming();
    document.edits(edits, {}, state.range(1) != 0 ? &made : nullptr);
  }
}
BENCHMARK(release)->ArgsProduct({{1, 9}, {0, 1}})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(undo_and_redo)->Arg(1)->Arg(9)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();

// One edit, with its journal line synced to disk.
void journal_append(benchmark::State& state) {
  const TemporaryFolder folder;
  Document document;
  document.keep_journal(folder.path() / "journal");
  for (auto _ : state) document.edit(Background{});
}
BENCHMARK(journal_append)->Unit(benchmark::kMillisecond)->UseRealTime();

// Export after deleting half of the triangles, with texels packed again.
void export_after_delete(benchmark::State& state) {
  const TemporaryFolder folder;
  Select half;
  half.half_space = HalfSpaceRegion{Vec3(0.5, 0.5, 0.5), Vec3(1, 0.1, 0)};
  half.frame = CoordinateFrame::bounds;
  const Scene scene = rebake::apply(rebake::apply(scene_at(state.range(0)), half), DeleteSelected{}).scene;
  for (auto _ : state) export_scene(scene, folder.path() / "out", {});
}
BENCHMARK(export_after_delete)->Arg(1)->Arg(9)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();

#define REBAKE_BENCHMARK(...) \
  BENCHMARK_CAPTURE(__VA_ARGS__)->Arg(1)->Arg(9)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime()
BENCHMARK(index)->Arg(1)->Arg(9)->Arg(0)->Unit(benchmark::kMillisecond)->UseRealTime();
REBAKE_BENCHMARK(index_part, traits, traits);
REBAKE_BENCHMARK(index_part, components, components);
REBAKE_BENCHMARK(index_part, rays, rays);
REBAKE_BENCHMARK(edit, select_box, select_box, false);
REBAKE_BENCHMARK(edit, select_invert, select_invert, true);
REBAKE_BENCHMARK(edit, brush_visible, brush_visible, false);
REBAKE_BENCHMARK(edit, polygon_through, polygon_through, false);
REBAKE_BENCHMARK(edit, whole_picture_visible, whole_picture_visible, false);
REBAKE_BENCHMARK(edit, connected, connected, false);
REBAKE_BENCHMARK(edit, like_color, like_color, false);
REBAKE_BENCHMARK(edit, floaters, floaters, false);
REBAKE_BENCHMARK(edit, grow, grow, true);
REBAKE_BENCHMARK(edit, fill, fill, true);
REBAKE_BENCHMARK(edit, delete_half, delete_half, true);
REBAKE_BENCHMARK(edit, erase_sphere, erase_sphere, false);
REBAKE_BENCHMARK(after, bend_then_connected, bent, connected);
REBAKE_BENCHMARK(after, bend_then_brush_visible, bent, brush_visible);
REBAKE_BENCHMARK(after, bend_then_like_color, bent, like_color);
REBAKE_BENCHMARK(after, stroke_then_connected, stroke, connected);
REBAKE_BENCHMARK(after, stroke_then_brush_visible, stroke, brush_visible);
REBAKE_BENCHMARK(after, stroke_then_like_color, stroke, like_color);
#undef REBAKE_BENCHMARK

}  // namespace
}  // namespace rebake::test
