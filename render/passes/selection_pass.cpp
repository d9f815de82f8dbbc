#include <epoxy/gl.h>

#include <algorithm>

#include "mesh_ops/base/counted.h"
#include "render/passes/pass_support.h"

namespace rebake {

namespace {

// Uploads the indices of the selected faces of a set; vertices are shared with the mesh.
SelectedFaces upload(const Draw& draw, const GpuMesh& mesh, const GpuSurface& surface) {
  SelectedFaces selected;
  selected.selection = draw.selection;
  selected.source = draw.set;
  std::vector<Face> faces;
  for (std::size_t f = 0; f < draw.set.soup.triangle_count(); ++f)
    if ((*draw.selection)[draw.first_triangle + f] != 0) faces.push_back(draw.set.soup.faces()[f]);
  selected.count = faces.size() * 3;
  if (faces.empty()) return selected;
  selected.array = make_position_array(mesh, surface);
  glBindVertexArray(selected.array.name());
  selected.indices = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, faces.data(), faces.size() * sizeof(Face));
  glBindVertexArray(0);
  return selected;
}

// Strength of the tint for selections that the next command does not affect, relative to the full tint.
constexpr float dimmed_strength = 0.3F;

float strength_of(const FramePlan& plan, const Draw& draw) {
  const std::vector<NodeId>& dimmed = plan.guides.dimmed;
  return std::find(dimmed.begin(), dimmed.end(), draw.node) == dimmed.end() ? 1 : dimmed_strength;
}

void execute(const PassInput& input) {
  begin_mask(input);
  std::map<SelectionKey, SelectedFaces> kept;
  for (const Draw& draw : input.plan.draws) {
    if (draw.selection == nullptr) continue;
    const SelectionKey key{input.gpu.key(draw.set), draw.selection.get()};
    const auto held = input.state.selected.find(key);
    const SelectedFaces& faces =
        kept.emplace(key, held != input.state.selected.end()
                              ? std::move(held->second)
                              : upload(draw, input.gpu.mesh(draw.set), input.gpu.surface(draw.set)))
            .first->second;
    if (faces.count == 0) continue;
    set_mesh_uniforms(input, draw, use_mask(input, draw, strength_of(input.plan, draw)));
    glBindVertexArray(faces.array.name());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(faces.count), GL_UNSIGNED_INT, nullptr);
  }
  input.state.selected = std::move(kept);
  end_mask();
  draw_by_mask(input, "selection.frag");
}

std::optional<Decision> decide(const FrameFacts& facts) {
  const FramePlan& plan = facts.plan;
  const auto selected = static_cast<std::size_t>(
      std::count_if(plan.draws.begin(), plan.draws.end(), [](const Draw& draw) { return draw.selection != nullptr; }));
  if (!plan.guides.selection) return Decision{false, "selections are hidden"};
  if (selected == 0) return Decision{false, "nothing in view is selected"};
  return Decision{true, counted(selected, "draw has", "draws have") + " selected triangles"};
}

constexpr Use reads[] = {{Target::depth}, {Target::mask}};
constexpr Use writes[] = {{Target::mask}, {Target::picture}};

}  // namespace

const Effect effects::selection{"selection", Effect::Kind::overlay, decide, execute, reads, writes};

}  // namespace rebake
