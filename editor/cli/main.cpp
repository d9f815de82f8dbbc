#include <cstdio>
#include <chrono>
#include <random>
#include "mesh_ops/formats/baked_folder.h"
#include "render/picture.h"
using namespace rebake;
int main(int argc, char** argv) {
  auto t0 = std::chrono::steady_clock::now();
  auto object = read_baked_folder(argv[1], Axes::y_up);
  auto t1 = std::chrono::steady_clock::now();
  std::printf("load %.3f s, %zu triangles\n", std::chrono::duration<double>(t1 - t0).count(), object->triangle_count());
  Node node; node.name = "a"; node.object = object;
  Scene scene = with_added({}, node, NodeId::none, 99);
  View view; view.camera.near_plane=.2; view.camera.far_plane=6;
  const int samples = argc > 2 ? atoi(argv[2]) : 4; view.samples = samples;
  RenderOptions o; if (argc>3) o.weights = RenderOptions::Weights::buffer;
  Renderer r;
  std::printf("%s\n", r.device().c_str());
  std::fputs(describe(plan(scene, view,o)).c_str(), stdout);
  write_png(r.render(scene, view,o), "/tmp/out.png");
  for (int i = 0; i < 12; ++i) { auto t = r.time_frame(scene, view, o, i % 2); std::printf("%.2f ms", t.frame_ms); for (auto& [k, v] : t.pass_ms) std::printf("  %s %.2f", k.c_str(), v); std::puts(""); }
}
