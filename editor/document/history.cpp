#include "editor/document/history.h"

#include <algorithm>
#include <unordered_set>

namespace rebake {

namespace {

constexpr std::size_t checkpoint_distance = 32;

// Calls visit(address, bytes) for each shared allocation of a scene (nodes, arrays, tiles), for some more than once.
template <class Visit>
void for_each_part(const Scene& scene, Visit visit) {
  std::unordered_set<const void*> textures;
  std::vector<NodePtr> open(scene.roots.begin(), scene.roots.end());
  const auto visit_soup = [&](const Soup& soup) {
    visit(soup.shared_positions().get(), soup.positions().size() * sizeof(Vec3));
    visit(soup.shared_uvs().get(), soup.uvs().size() * sizeof(Vec2));
    visit(soup.shared_faces().get(), soup.faces().size() * sizeof(Face));
    for (const Attributes* attributes : {&soup.vertex_attributes(), &soup.face_attributes()})
      for (const auto& [name, attribute] : *attributes) visit(attribute.get(), attribute->memory());
  };
  while (!open.empty()) {
    const NodePtr node = open.back();
    open.pop_back();
    open.insert(open.end(), node->children.begin(), node->children.end());
    visit(node.get(), sizeof(Node) + node->name.size());
    if (node->selection) visit(node->selection.get(), node->selection->size());
    for (const auto& [name, saved] : node->saved_selections) visit(saved.get(), saved->size());
    if (!node->object) continue;
    std::vector<TextureSet> sets = node->object->sets;
    for (const BakedBody& body : node->object->bodies)
      sets.insert(sets.end(), body.object->sets.begin(), body.object->sets.end());
    for (const TextureSet& set : sets) {
      visit_soup(set.soup);
      if (set.soup.lineage()) {
        visit_soup(set.soup.lineage()->whole);
        visit(set.soup.lineage().get(), set.soup.lineage()->faces.size() * sizeof(std::uint32_t));
      }
      if (!textures.insert(set.texels.get()).second) continue;
      for (int row = 0; row < set.texels->tile_rows(); ++row)
        for (int column = 0; column < set.texels->tile_columns(); ++column)
          visit(set.texels->tile(column, row).get(), set.texels->tile(column, row)->memory());
    }
  }
}

}  // namespace

History::History(Scene start, std::uint64_t budget) : budget_(budget) {
  steps_.push_back({});
  keep(0, std::move(start));
}

std::vector<Edit> History::edits() const {
  std::vector<Edit> result;
  for (std::size_t k = position_; k > 0; k = steps_[k].base) result.push_back(*steps_[k].edit);
  std::reverse(result.begin(), result.end());
  return result;
}

std::vector<std::size_t> History::edits_before() const {
  std::vector<std::size_t> result;
  for (std::size_t k = position_; k > 0; k = steps_[k].base) result.push_back(steps_[k].base);
  std::reverse(result.begin(), result.end());
  return result;
}

std::vector<History::Entry> History::entries() const {
  std::vector<Entry> result;
  for (std::size_t k = 1; k < steps_.size(); ++k)
    result.push_back({*steps_[k].edit, steps_[k].joined, k - 1 - steps_[k].base});
  return result;
}

std::vector<Edit> History::undone() const {
  std::vector<Edit> result;
  for (std::size_t k = position_ + 1; k < steps_.size(); ++k) result.push_back(*steps_[k].edit);
  return result;
}

std::size_t History::kept() const {
  std::size_t result = 0;
  for (const Step& step : steps_) result += step.scene ? 1 : 0;
  return result;
}

void History::forget_last(std::size_t edits) {
  position_ -= edits;
  while (steps_.size() > position_ + 1) {
    drop(steps_.size() - 1);
    steps_.pop_back();
  }
}

void History::add(Edit edit, Scene scene, bool joined, std::size_t replaced) {
  forget_last(0);
  steps_.push_back({std::move(edit), std::nullopt, joined && position_ > 0, position_ - replaced});
  keep(++position_, std::move(scene));
  evict_to_budget();
}

std::size_t History::undo_step() const {
  if (position_ == 0) return 0;
  std::size_t edits = 1;
  while (steps_[position_ + 1 - edits].joined) ++edits;
  return edits;
}

std::optional<Scene> History::before_last_step() const {
  if (position_ == 0) return std::nullopt;
  return steps_[steps_[position_ + 1 - undo_step()].base].scene;
}

std::optional<std::pair<Scene, Scene>> History::scenes_around(std::size_t first, std::size_t count) const {
  const std::optional<Scene>&before = steps_[steps_[first + 1].base].scene, &after = steps_[first + count].scene;
  if (!before || !after) return std::nullopt;
  return std::pair(*before, *after);
}

std::size_t History::replaced_by_last_step() const {
  if (position_ == 0) return 0;
  const std::size_t first = position_ + 1 - undo_step();
  return first - 1 - steps_[first].base;
}

std::size_t History::redo_step() const {
  if (redo_count() == 0) return 0;
  std::size_t edits = 1;
  while (edits < redo_count() && steps_[position_ + 1 + edits].joined) ++edits;
  return edits;
}

bool History::undo(std::size_t edits, const Progress& progress) {
  if (edits > position_) return false;
  go_to(position_ - edits, progress);
  return true;
}

bool History::redo(std::size_t edits, const Progress& progress) {
  if (edits > redo_count()) return false;
  go_to(position_ + edits, progress);
  return true;
}

// Steps whose edits must be applied to get a step's scene, in order. The first starts from a cached scene, each other
// from the result before it.
std::vector<std::size_t> History::uncached_chain(std::size_t step) const {
  std::vector<std::size_t> chain;
  for (; !steps_[step].scene; step = steps_[step].base) chain.push_back(step);
  std::reverse(chain.begin(), chain.end());
  return chain;
}

Scene History::scene_at(std::size_t edits, const Progress& progress) const {
  const std::vector<std::size_t> chain = uncached_chain(edits);
  Scene scene = *steps_[chain.empty() ? edits : steps_[chain.front()].base].scene;
  for (const std::size_t k : chain) scene = rebake::apply(scene, *steps_[k].edit, progress).scene;
  return scene;
}

void History::go_to(std::size_t step, const Progress& progress) {
  const std::vector<std::size_t> chain = uncached_chain(step);
  // The last intermediate scenes are cached too, because one undo is often followed by another. Scenes of later steps
  // are evicted only after success; until then, intermediate scenes may take half of the budget in addition.
  const std::uint64_t there = memory_;
  Scene scene = *steps_[chain.empty() ? step : steps_[chain.front()].base].scene;
  std::size_t oldest = 0;
  for (std::size_t k = 0; k < chain.size(); ++k) {
    scene = rebake::apply(scene, *steps_[chain[k]].edit, progress).scene;
    keep(chain[k], scene);
    while (oldest < k && (memory_ - there > budget_ / 2 || k - oldest >= checkpoint_distance)) drop(chain[oldest++]);
  }
  position_ = step;
  evict_to_budget();
}

void History::keep(std::size_t step, Scene scene) {
  std::unordered_set<const void*> seen;
  for_each_part(scene, [&](const void* part, std::uint64_t bytes) {
    if (!seen.insert(part).second) return;
    Part& entry = parts_.try_emplace(part, Part{0, bytes}).first->second;
    if (entry.uses++ == 0) memory_ += bytes;
  });
  steps_[step].scene = std::move(scene);
}

void History::drop(std::size_t step) {
  if (!steps_[step].scene) return;
  std::unordered_set<const void*> seen;
  for_each_part(*steps_[step].scene, [&](const void* part, std::uint64_t) {
    if (!seen.insert(part).second) return;
    const auto entry = parts_.find(part);
    if (--entry->second.uses > 0) return;
    memory_ -= entry->second.bytes;
    parts_.erase(entry);
  });
  steps_[step].scene.reset();
}

void History::evict_to_budget() {
  // Checkpoints are evicted last, so that few edits must be repeated to get an evicted scene back.
  for (const bool checkpoints : {false, true}) {
    // From both ends towards the present scene, the farther end first.
    std::size_t first = 1, last = steps_.size() - 1;
    while (memory_ > budget_ && (first < position_ || last > position_)) {
      const bool oldest = first < position_ && (last <= position_ || position_ - first >= last - position_);
      const std::size_t k = oldest ? first++ : last--;
      if ((k % checkpoint_distance == 0) == checkpoints) drop(k);
    }
  }
}

}  // namespace rebake
