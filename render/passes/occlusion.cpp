#include "render/passes/occlusion.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>

#include "render/passes/depth_pyramid.h"
#include "render/passes/screen_bounds.h"

namespace rebake {

/// What frames pass on to each other.
struct OcclusionState {
  /// Bits of a face's flags.
  static constexpr std::uint8_t shown = 1;    ///< in the last frame that looked
  static constexpr std::uint8_t drawn = 2;    ///< in this frame
  static constexpr std::uint8_t pending = 4;  ///< to be drawn next

  using Key = std::pair<NodeId, std::size_t>;      ///< node, first triangle of the set
  std::map<Key, std::vector<std::uint8_t>> faces;  ///< flags; which ones show is a guess that may be wrong
  std::vector<float> depth;
  DepthPyramid pyramid;
  std::vector<std::uint8_t> blocks;  ///< of the picture: 1 where something may have been drawn
  int block_columns = 0;
};

namespace {

constexpr int block_pixels = 16;
// Triangles in view of which nothing is known, from which drawing them in parts pays: each part is drawn twice, to ask
// whether samples are equally near. On the mic (82,421) parts lose a quarter, on nine of them they win a tenth.
constexpr std::size_t worth_parts = 200'000;
constexpr auto not_shown = static_cast<std::uint8_t>(~OcclusionState::shown);

struct Candidate {
  std::uint32_t set;
  std::uint32_t cluster;
  float nearness;
};

// A set in this frame.
struct Set {
  const Draw* draw;
  const GpuMesh* mesh;
  const GpuSurface* surface;
  ScreenBounder bounder;
  std::vector<std::uint8_t>* flags;
};

class Frame {
 public:
  Frame(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use)
      : input_(input), use_(use), state_(*input.state.occlusion), side_(input.plan.view.side()) {
    const PixelRect& covered = input.plan.covered;
    rect_ = {covered.left * side_, (input.plan.view.height - covered.bottom) * side_, covered.right * side_,
             (input.plan.view.height - covered.top) * side_};
    state_.block_columns = (input.plan.view.width + block_pixels - 1) / block_pixels;
    const int rows = (input.plan.view.height + block_pixels - 1) / block_pixels;
    state_.blocks.assign(static_cast<std::size_t>(state_.block_columns) * static_cast<std::size_t>(rows), 0);
    std::map<OcclusionState::Key, std::vector<std::uint8_t>> kept;
    for (const Draw& draw : input.plan.draws) {
      const GpuMesh& mesh = input.gpu.mesh(draw.set);
      const GpuSurface& surface = input.gpu.surface(draw.set);
      const OcclusionState::Key key{draw.node, draw.first_triangle};
      auto node = state_.faces.extract(key);
      std::vector<std::uint8_t>& flags = kept[key];
      if (!node.empty()) flags = std::move(node.mapped());
      // Of another object by now, whose faces have other numbers.
      if (flags.size() != surface.shown.faces->size()) flags.assign(surface.shown.faces->size(), 0);
      sets_.push_back({&draw, &mesh, &surface, bounder(draw), &flags});
    }
    state_.faces = std::move(kept);
  }

  void draw(const std::function<void()>& clear) {
    counts() = {};
    std::vector<Candidate> candidates;
    timed([&] { candidates = in_view(); });
    bool remembered = false;
    for (const Candidate& c : candidates) {
      for_faces(c, [&](std::uint32_t, std::uint8_t& flags) {
        if ((flags & OcclusionState::shown) == 0) return;
        flags |= OcclusionState::pending;
        remembered = true;
      });
    }
    std::vector<std::size_t> ends;  // of batches of candidates
    if (remembered) {
      draw_pending(false);
      ends = {candidates.size()};
    } else if (triangles_of(candidates) < worth_parts) {
      // Nothing is known: all of it, and then what of it shows.
      for (const Candidate& c : candidates)
        for_faces(c, [](std::uint32_t, std::uint8_t& flags) { flags |= OcclusionState::pending; });
      draw_pending(false);
      ends = {candidates.size()};
    } else {
      // Nothing is known of many: from near to far, in parts that hide those behind them.
      std::stable_sort(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.nearness > b.nearness; });
      for (const std::size_t share : {1, 3, 6, 10}) ends.push_back(candidates.size() * share / 10);
      for (std::size_t k = 0; k < ends[0]; ++k) {
        const ScreenBounds box = box_of(candidates[k]);
        mark(box.where, box.samples);
        for_faces(candidates[k],
                  [](std::uint32_t, std::uint8_t& flags) { flags |= OcclusionState::pending | OcclusionState::shown; });
      }
      draw_pending(false);
    }
    for (std::size_t k = remembered ? 0 : 1; k < ends.size(); ++k) {
      glFinish();  // so that only what looking adds is counted
      timed([&] {
        read_depth();
        look(candidates, k == 0 ? 0 : ends[k - 1], ends[k]);
      });
      draw_pending(true);
    }
    counts().clusters_drawn = 0;
    for (const Candidate& c : candidates) {
      bool any = false;
      for_faces(c,
                [&](std::uint32_t, const std::uint8_t& flags) { any = any || (flags & OcclusionState::drawn) != 0; });
      counts().clusters_drawn += any ? 1 : 0;
    }
    counts().clusters_hidden = candidates.size() - counts().clusters_drawn;
    if (ties_) draw_again(clear);
    for (const Set& set : sets_)
      for (std::uint8_t& flags : *set.flags) flags &= OcclusionState::shown;
  }

 private:
  template <class Work>
  void timed(Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    counts().milliseconds +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  std::size_t triangles_of(const std::vector<Candidate>& candidates) const {
    std::size_t triangles = 0;
    for (const Candidate& c : candidates) triangles += sets_[c.set].mesh->nearby.clusters[c.cluster].count;
    return triangles;
  }

  OcclusionCounts& counts() { return input_.state.occlusion_counts; }

  ScreenBounder bounder(const Draw& draw) const {
    const View& view = input_.plan.view;
    return {projection(view) * draw.to_camera.matrix(),
            draw.set.soup.bounds(),
            nearness_of_depth(),
            view.width * side_,
            view.height * side_,
            rect_};
  }

  template <class Visit>
  void for_faces(const Candidate& candidate, Visit visit) const {
    const Set& set = sets_[candidate.set];
    const FaceCluster& cluster = set.mesh->nearby.clusters[candidate.cluster];
    for (std::uint32_t k = cluster.first; k < cluster.first + cluster.count; ++k) {
      const std::uint32_t face = (*set.surface->shown.nearby)[k];
      visit(face, (*set.flags)[face]);
    }
  }

  ScreenBounds box_of(const Candidate& candidate) const {
    const Set& set = sets_[candidate.set];
    return set.bounder.box(set.mesh->nearby.clusters[candidate.cluster].bounds);
  }

  std::vector<Candidate> in_view() {
    std::vector<Candidate> candidates;
    for (std::size_t s = 0; s < sets_.size(); ++s) {
      const std::vector<FaceCluster>& clusters = sets_[s].mesh->nearby.clusters;
      counts().clusters += clusters.size();
      counts().triangles += sets_[s].surface->shown.faces->size();
      std::vector<ScreenBounds> bounds(clusters.size());
      tbb::parallel_for(std::size_t{0}, clusters.size(),
                        [&](std::size_t k) { bounds[k] = sets_[s].bounder.box(clusters[k].bounds); });
      for (std::size_t k = 0; k < clusters.size(); ++k)
        if (bounds[k].where != ScreenBounds::Where::outside)
          candidates.push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(k),
                                bounds[k].where == ScreenBounds::Where::inside
                                    ? bounds[k].nearness
                                    : std::numeric_limits<float>::infinity()});
    }
    counts().clusters_out_of_view = counts().clusters - candidates.size();
    return candidates;
  }

  void mark(ScreenBounds::Where where, SampleRect samples) {
    if (where == ScreenBounds::Where::outside) return;
    if (where == ScreenBounds::Where::anywhere) samples = {rect_.left, rect_.bottom, rect_.right - 1, rect_.top - 1};
    const int size = block_pixels * side_;
    for (int y = samples.bottom / size; y <= samples.top / size; ++y)
      for (int x = samples.left / size; x <= samples.right / size; ++x) {
        // Several threads may set the same one, to the same value.
        std::uint8_t& block =
            state_.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(state_.block_columns) +
                          static_cast<std::size_t>(x)];
        std::atomic_ref<std::uint8_t>(block).store(1, std::memory_order_relaxed);
      }
  }

  void read_depth() {
    const int width = rect_.right - rect_.left, height = rect_.top - rect_.bottom;
    state_.depth.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    glReadPixels(rect_.left, rect_.bottom, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, state_.depth.data());
    if (!reversed_depth())
      for (float& depth : state_.depth) depth = 1 - depth;
    state_.pyramid.build(rect_, state_.depth);
  }

  // Finds what of candidates [first, last) is not hidden by what was drawn so far.
  void look(const std::vector<Candidate>& candidates, std::size_t first, std::size_t last) {
    using Where = ScreenBounds::Where;
    tbb::parallel_for(first, last, [&](std::size_t k) {
      const Set& set = sets_[candidates[k].set];
      const ScreenBounds box = box_of(candidates[k]);
      const bool hidden = box.where == Where::outside ||
                          (box.where == Where::inside && state_.pyramid.hides(box.samples, box.nearness));
      if (hidden) {
        for_faces(candidates[k], [](std::uint32_t, std::uint8_t& flags) { flags &= not_shown; });
        return;
      }
      ClusterBounds triangles;
      set.bounder.triangles(set.mesh->nearby.corners[candidates[k].cluster], triangles);
      std::size_t number = 0;
      for_faces(candidates[k], [&](std::uint32_t, std::uint8_t& flags) {
        const std::size_t i = number++;
        const auto where = static_cast<Where>(triangles.where[i]);
        flags &= not_shown;
        if (where == Where::outside) return;
        if (where == Where::inside && state_.pyramid.hides(triangles.samples(i), triangles.nearness[i])) return;
        flags |= OcclusionState::shown;
        if ((flags & OcclusionState::drawn) == 0) flags |= OcclusionState::pending;
        mark(where, triangles.samples(i));
      });
    });
  }

  // Faces with a flag, in their order, as indices; where those of each set end.
  std::vector<std::size_t> gather(std::uint8_t flag) {
    std::vector<std::size_t> ends;
    indices_.clear();
    for (const Set& set : sets_) {
      const std::vector<std::uint8_t>& flags = *set.flags;
      std::size_t k = 0;
      const auto take = [&](std::size_t end) {
        for (; k < end; ++k)
          if ((flags[k] & flag) != 0) indices_.push_back((*set.surface->shown.faces)[k]);
      };
      // Eight at a time: mostly none of them is.
      while (k + 8 <= flags.size()) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, &flags[k], 8);
        if ((eight & (0x0101010101010101U * flag)) == 0)
          k += 8;
        else
          take(k + 8);
      }
      take(flags.size());
      ends.push_back(indices_.size());
    }
    return ends;
  }

  void draw_indices(const std::vector<std::size_t>& ends, const gl::Buffer& buffer) {
    std::size_t first = 0;
    for (std::size_t s = 0; s < sets_.size(); first = ends[s], ++s) {
      if (ends[s] == first) continue;
      const gl::Program& program = use_(*sets_[s].draw);
      bind_set(input_, *sets_[s].draw, program);
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer.name());
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>((ends[s] - first) * 3), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(first * sizeof(Face)));
      // The vertex array remembers it.
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, sets_[s].surface->indices.name());
      unbind_set(*sets_[s].draw);
    }
  }

  // `after`: something was drawn before, and what comes now stands before some of it in the scene's order.
  void draw_pending(bool after) {
    const std::vector<std::size_t> ends = gather(OcclusionState::pending);
    if (indices_.empty()) return;
    glBindVertexArray(0);
    const gl::Buffer buffer = gl::make_buffer(GL_ARRAY_BUFFER, indices_.data(), indices_.size() * sizeof(Face));
    if (after && !ties_) timed([&] { ties_ = any_tie(ends, buffer); });
    // What is drawn again later need not be drawn right, but deep enough to hide.
    draw_indices(ends, buffer);
    counts().triangles_drawn += indices_.size();
    for (const Set& set : sets_)
      for (std::uint8_t& flags : *set.flags)
        if ((flags & OcclusionState::pending) != 0)
          flags = static_cast<std::uint8_t>((flags & ~OcclusionState::pending) | OcclusionState::drawn);
  }

  // Whether a sample is as near as what is there: of two that are equally near the later one in the scene's order
  // shows, which is not always the one that is drawn later here.
  bool any_tie(const std::vector<std::size_t>& ends, const gl::Buffer& buffer) {
    GLuint query = 0;
    glGenQueries(1, &query);
    GLint function = GL_LEQUAL;
    glGetIntegerv(GL_DEPTH_FUNC, &function);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_EQUAL);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
    draw_indices(ends, buffer);
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    glDepthFunc(static_cast<GLenum>(function));
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    GLuint any = 0;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &any);
    glDeleteQueries(1, &query);
    return any != 0;
  }

  void draw_again(const std::function<void()>& clear) {
    const std::vector<std::size_t> ends = gather(OcclusionState::drawn);
    glBindVertexArray(0);
    const gl::Buffer buffer = gl::make_buffer(GL_ARRAY_BUFFER, indices_.data(), indices_.size() * sizeof(Face));
    clear();
    draw_indices(ends, buffer);
    counts().drawn_again = true;
  }

  const PassInput& input_;
  const std::function<const gl::Program&(const Draw&)>& use_;
  OcclusionState& state_;
  int side_;
  SampleRect rect_;
  std::vector<Set> sets_;
  std::vector<Face> indices_;
  bool ties_ = false;
};

}  // namespace

void draw_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use,
               const std::function<void()>& clear) {
  clear();
  if (input.plan.runs(effects::occlusion)) {
    if (!input.state.occlusion) input.state.occlusion = std::make_shared<OcclusionState>();
    Frame(input, use).draw(clear);
    return;
  }
  for (const Draw& draw : input.plan.draws) draw_set(input, draw, use(draw));
}

std::vector<SampleRect> drawn_pixels(const PassInput& input) {
  const View& view = input.plan.view;
  const PixelRect& covered = input.plan.covered;
  const SampleRect whole{covered.left, view.height - covered.bottom, covered.right, view.height - covered.top};
  if (!input.plan.runs(effects::occlusion)) return {whole};
  const OcclusionState& state = *input.state.occlusion;
  std::vector<SampleRect> rects;
  const int columns = state.block_columns, rows = static_cast<int>(state.blocks.size()) / columns;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns;) {
      const auto at = [&](int column) {
        return state.blocks[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                            static_cast<std::size_t>(column)] != 0;
      };
      if (!at(x)) {
        ++x;
        continue;
      }
      const int first = x;
      while (x < columns && at(x)) ++x;
      rects.push_back({std::max(first * block_pixels, whole.left), std::max(y * block_pixels, whole.bottom),
                       std::min(x * block_pixels, whole.right), std::min((y + 1) * block_pixels, whole.top)});
    }
  return rects;
}

namespace {

std::optional<Decision> decide(const FrameFacts& facts) {
  using Occlusion = RenderOptions::Occlusion;
  const FramePlan& plan = facts.plan;
  if (!facts.any_draw()) return Decision{false, nothing_in_view};
  if (plan.options.occlusion == Occlusion::off) return Decision{false, "all triangles are to be drawn"};
  if (plan.options.occlusion == Occlusion::automatic) {
    if (plan.triangles < facts.device.occlusion_from)
      return Decision{false, fmt::format("{} are drawn sooner than looked at; here it pays from {} on",
                                         plural(plan.triangles, "triangle", "triangles"), facts.device.occlusion_from)};
    if (facts.device.shown_share > 0)
      return Decision{false, fmt::format("when it was looked, {:.0f} % of the triangles had to be drawn",
                                         100 * facts.device.shown_share)};
  }
  return Decision{true, "hidden triangles are left out"};
}

}  // namespace

const Effect effects::occlusion{"occlusion", Effect::Kind::colors, decide};

}  // namespace rebake
