#include "render/passes/occlusion.h"

#include <epoxy/gl.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <memory>

#include "mesh_ops/base/counted.h"
#include "render/passes/depth_pyramid.h"
#include "render/passes/screen_bounds.h"

namespace rebake {

/// Visibility of triangles that is remembered from frame to frame.
struct OcclusionState {
  /// Bits of a face's flags:
  static constexpr std::uint8_t shown = 1;    ///< found visible in the last frame with a test
  static constexpr std::uint8_t pending = 2;  ///< to be drawn by the next draw call
  static constexpr std::uint8_t close = 4;    ///< also found visible in the test per sample

  using Key = std::pair<NodeId, std::size_t>;  ///< node, first triangle of the set
  /// Visibility from one camera: a prediction for the next frame from a camera nearby, which may be wrong.
  struct CameraVisibility {
    Camera camera;
    std::map<Key, std::vector<std::uint8_t>> faces;  ///< flags per face
    /// Identity of a draw for which the visibility was found.
    struct Drawn {
      Key key;
      Eigen::Matrix4d to_camera;
      std::array<std::weak_ptr<const void>, 4> arrays;  ///< positions, UVs, faces, texels
      bool operator==(const Drawn& other) const;
    };
    std::vector<Drawn> draws;
    std::array<int, 4> raster{};       ///< width, height, samples per pixel side, RenderOptions::Shading
    int frames_at_rest = 0;            ///< since camera, raster or draws changed
    bool known = false;                ///< whether `close` is valid: the test per sample has run in this state
    OcclusionCounts counts;            ///< of the test per sample
    std::vector<std::uint8_t> blocks;  ///< OcclusionState::blocks of that test
  };
  std::vector<CameraVisibility> visibilities;  ///< most recently used last
  std::vector<float> depth;                    ///< nearness per sample, as in DepthPyramid
  DepthPyramid pyramid;
  std::vector<std::uint8_t> blocks;  ///< per 16×16 pixels: 1 if something may have been drawn
  int block_columns = 0;
};

bool OcclusionState::CameraVisibility::Drawn::operator==(const Drawn& other) const {
  const auto same = [](const std::weak_ptr<const void>& a, const std::weak_ptr<const void>& b) {
    return !a.owner_before(b) && !b.owner_before(a);
  };
  return key == other.key && to_camera == other.to_camera &&
         std::equal(arrays.begin(), arrays.end(), other.arrays.begin(), same);
}

namespace {

constexpr int block_pixels = 16;
// Number of frames at rest after which triangles are tested per sample. Later frames draw the triangles found visible.
// The test takes about as long as drawing the triangles that it removes.
constexpr int frames_before_sample_test = 2;
// If the second pass has at most a quarter as many triangles as the first, it is drawn on top. Otherwise all visible
// triangles are drawn again.
constexpr std::size_t missing_ratio = 4;

// A cluster in view: indices of its set and within the set.
struct Candidate {
  std::uint32_t set;
  std::uint32_t cluster;
};

// Whether visibility from one camera predicts visibility from another.
bool is_near(const Camera& a, const Camera& b) {
  const Vec3 to_a = a.target - a.eye, to_b = b.target - b.eye;
  constexpr double min_cosine = 0.9;  // 26°
  constexpr double max_moved = 0.25;  // share of the distance to the target
  return to_a.dot(to_b) > min_cosine * to_a.norm() * to_b.norm() &&
         (a.eye - b.eye).norm() < max_moved * std::max(to_a.norm(), to_b.norm()) &&
         a.orthographic() == b.orthographic();
}

// Removes and returns the latest memory of a camera nearby; an empty one if there is none. Keeps up to three memories,
// so that views can alternate, and evicts the oldest.
OcclusionState::CameraVisibility take_nearby_visibility(std::vector<OcclusionState::CameraVisibility>& visibilities,
                                                        const Camera& camera) {
  constexpr std::size_t most = 3;
  OcclusionState::CameraVisibility found;
  for (std::size_t k = visibilities.size(); k-- > 0;) {
    if (!is_near(visibilities[k].camera, camera)) continue;
    found = std::move(visibilities[k]);
    visibilities.erase(visibilities.begin() + static_cast<std::ptrdiff_t>(k));
    break;
  }
  if (visibilities.size() >= most) visibilities.erase(visibilities.begin());
  return found;
}

// A texture set in this frame.
struct Set {
  const Draw* draw;
  const GpuMesh* mesh;
  const GpuSurface* surface;
  ScreenBounder bounder;
  std::vector<std::uint8_t>* flags;
};

class TwoPassCulling {
 public:
  TwoPassCulling(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use)
      : input_(input), use_(use), state_(*input.state.occlusion), side_(input.plan.view.side()) {
    const PixelRect& covered = input.plan.covered;
    rect_ = {covered.left * side_, (input.plan.view.height - covered.bottom) * side_, covered.right * side_,
             (input.plan.view.height - covered.top) * side_};
    state_.block_columns = (input.plan.view.width + block_pixels - 1) / block_pixels;
    const int rows = (input.plan.view.height + block_pixels - 1) / block_pixels;
    state_.blocks.assign(static_cast<std::size_t>(state_.block_columns) * static_cast<std::size_t>(rows), 0);
    OcclusionState::CameraVisibility before = take_nearby_visibility(state_.visibilities, input.plan.view.camera);
    OcclusionState::CameraVisibility& now = state_.visibilities.emplace_back();
    now.camera = input.plan.view.camera;
    now.raster = {input.plan.view.width, input.plan.view.height, side_, static_cast<int>(input.plan.options.shading)};
    for (const Draw& draw : input.plan.draws)
      now.draws.push_back({{draw.node, draw.first_triangle},
                           draw.to_camera.matrix(),
                           {draw.set.soup.shared_positions(), draw.set.soup.shared_uvs(), draw.set.soup.shared_faces(),
                            draw.set.texels}});
    const bool at_rest = before.camera == now.camera && before.raster == now.raster && before.draws == now.draws;
    if (at_rest) {
      now.frames_at_rest = before.frames_at_rest + 1;
      now.known = before.known;
      now.counts = before.counts;
      now.blocks = std::move(before.blocks);
    }
    for (const Draw& draw : input.plan.draws) {
      const GpuMesh& mesh = input.gpu.mesh(draw.set);
      const GpuSurface& surface = input.gpu.surface(draw.set);
      const OcclusionState::Key key{draw.node, draw.first_triangle};
      auto node = before.faces.extract(key);
      std::vector<std::uint8_t>& flags = now.faces[key];
      if (!node.empty()) flags = std::move(node.mapped());
      // The node shows another object now, whose faces are numbered differently.
      if (flags.size() != surface.shown.faces->size()) flags.assign(surface.shown.faces->size(), 0);
      sets_.push_back({&draw, &mesh, &surface, bounder(draw), &flags});
    }
  }

  void draw(const std::function<void()>& clear) {
    OcclusionState::CameraVisibility& memory = state_.visibilities.back();
    // Nothing has changed: draws the triangles that the test per sample found visible.
    if (memory.known) {
      upload_faces_with(OcclusionState::close);
      draw_gathered();
      counts() = memory.counts;
      state_.blocks = memory.blocks;
      return;
    }
    counts() = {};
    std::vector<Candidate> candidates;
    timed([&] { candidates = frustum_cull(); });
    bool remembered = false;
    for (const Candidate& c : candidates)
      for_faces(c, [&](std::uint32_t, std::uint8_t& flags) {
        if ((flags & OcclusionState::shown) == 0) return;
        flags |= OcclusionState::pending;
        remembered = true;
      });
    // There is no prediction: the first pass draws all triangles in view.
    if (!remembered)
      for (const Candidate& c : candidates)
        for_faces(c, [](std::uint32_t, std::uint8_t& flags) { flags |= OcclusionState::pending; });
    const std::size_t first = upload_faces_with(OcclusionState::pending).back();
    draw_gathered();
    glFinish();  // so that the measured time excludes drawing
    timed([&] {
      read_depth();
      test_candidates(candidates);
    });
    const std::size_t missing = upload_faces_with(OcclusionState::pending).back();
    bool any_tie_found = false;
    if (missing > 0 && missing <= first / missing_ratio) {
      timed([&] { any_tie_found = any_depth_tie(); });
      draw_gathered();
    }
    counts().triangles_drawn = first + missing;
    // Draws all visible triangles again, in scene order. If many were missing, this is faster than a test for ties.
    if (any_tie_found || missing > first / missing_ratio) {
      upload_faces_with(OcclusionState::shown);
      clear();
      draw_gathered();
      counts().drawn_again = true;
    }
    for (const Candidate& c : candidates) {
      std::size_t shows = 0;
      for_faces(c, [&](std::uint32_t, const std::uint8_t& flags) { shows += flags != 0 ? 1 : 0; });
      counts().triangles_shown += shows;
      counts().clusters_drawn += shows > 0 ? 1 : 0;
    }
    counts().clusters_hidden = candidates.size() - counts().clusters_drawn;
    for (const Set& set : sets_)
      for (std::uint8_t& flags : *set.flags) flags &= OcclusionState::shown | OcclusionState::close;
    if (!tests_per_sample()) return;
    memory.counts = counts();
    memory.counts.milliseconds = 0;
    memory.counts.known = true;
    memory.counts.drawn_again = false;
    memory.counts.triangles_shown = memory.counts.clusters_drawn = 0;
    for (const Candidate& c : candidates) {
      std::size_t shows = 0;
      for_faces(
          c, [&](std::uint32_t, const std::uint8_t& flags) { shows += (flags & OcclusionState::close) != 0 ? 1 : 0; });
      memory.counts.triangles_shown += shows;
      memory.counts.clusters_drawn += shows > 0 ? 1 : 0;
    }
    memory.counts.triangles_drawn = memory.counts.triangles_shown;
    memory.counts.clusters_hidden = candidates.size() - memory.counts.clusters_drawn;
    memory.blocks = state_.blocks;
    memory.known = true;
  }

 private:
  template <class Work>
  void timed(Work work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    counts().milliseconds +=
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  }

  bool tests_per_sample() const { return state_.visibilities.back().frames_at_rest >= frames_before_sample_test; }
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

  std::vector<Candidate> frustum_cull() {
    std::vector<Candidate> candidates;
    for (std::size_t s = 0; s < sets_.size(); ++s) {
      const std::vector<FaceCluster>& clusters = sets_[s].mesh->nearby.clusters;
      counts().clusters += clusters.size();
      counts().triangles += sets_[s].surface->shown.faces->size();
      std::vector<ScreenBounds> bounds(clusters.size());
      tbb::parallel_for(std::size_t{0}, clusters.size(),
                        [&](std::size_t k) { bounds[k] = sets_[s].bounder.box(clusters[k].bounds); });
      for (std::size_t k = 0; k < clusters.size(); ++k)
        if (bounds[k].where != ScreenBounds::Where::outside) {
          counts().triangles_in_view += clusters[k].count;
          candidates.push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(k)});
        }
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
        // Several threads may write the same value to a block.
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

  // Tests candidates against the Hi-Z pyramid. Visible triangles become `shown`, and `pending` if not drawn yet.
  void test_candidates(const std::vector<Candidate>& candidates) {
    using Where = ScreenBounds::Where;
    const bool closely = tests_per_sample();
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t k) {
      const Set& set = sets_[candidates[k].set];
      ClusterBounds triangles;
      set.bounder.triangles(set.mesh->nearby.corners[candidates[k].cluster], triangles);
      std::size_t number = 0;
      for_faces(candidates[k], [&](std::uint32_t, std::uint8_t& flags) {
        const std::size_t i = number++;
        const auto where = static_cast<Where>(triangles.where[i]);
        const bool is_drawn = (flags & OcclusionState::pending) != 0;
        flags = 0;
        if (where == Where::outside) return;
        if (where == Where::inside && state_.pyramid.hides(triangles.samples(i), triangles.nearness[i])) return;
        flags = is_drawn ? OcclusionState::shown : OcclusionState::shown | OcclusionState::pending;
        if (closely) {
          const bool bounded = triangles.nearness[i] < std::numeric_limits<float>::infinity();
          if (where == Where::inside && bounded && state_.pyramid.hides(set.bounder.triangle(triangles, i))) return;
          flags |= OcclusionState::close;
        }
        mark(where, triangles.samples(i));
      });
    });
  }

  // Uploads the indices of faces with a flag, in scene order. Returns offsets: 0, then the end of each set.
  const std::vector<std::size_t>& upload_faces_with(std::uint8_t flag) {
    ends_.assign(1, 0);
    indices_.clear();
    for (const Set& set : sets_) {
      const std::vector<std::uint8_t>& flags = *set.flags;
      std::size_t k = 0;
      const auto take = [&](std::size_t end) {
        for (; k < end; ++k)
          if ((flags[k] & flag) != 0) indices_.push_back((*set.surface->shown.faces)[k]);
      };
      // Skips eight faces at a time, because most have no flag.
      while (k + 8 <= flags.size()) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, &flags[k], 8);
        if ((eight & (0x0101010101010101U * flag)) == 0)
          k += 8;
        else
          take(k + 8);
      }
      take(flags.size());
      ends_.push_back(indices_.size());
    }
    glBindVertexArray(0);
    buffer_ = indices_.empty() ? gl::Buffer()
                               : gl::make_buffer(GL_ARRAY_BUFFER, indices_.data(), indices_.size() * sizeof(Face));
    return ends_;
  }

  void draw_gathered() {
    for (std::size_t s = 0; s < sets_.size(); ++s) {
      const std::size_t first = ends_[s], count = ends_[s + 1] - first;
      if (count == 0) continue;
      const gl::Program& program = use_(*sets_[s].draw);
      bind_set(input_, *sets_[s].draw, program);
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer_.name());
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count * 3), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(first * sizeof(Face)));
      // Restores the element buffer of the vertex array.
      glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, sets_[s].surface->indices.name());
      unbind_set(*sets_[s].draw);
    }
  }

  // Whether a sample of the gathered triangles has the same depth as the drawn sample (occlusion query). Of such ties,
  // the later triangle in scene order must win, which may have been drawn first.
  bool any_depth_tie() {
    GLint function = GL_LEQUAL;
    glGetIntegerv(GL_DEPTH_FUNC, &function);
    // Restores the state even if drawing throws; later frames would draw nothing otherwise.
    struct TieQueryScope {
      GLuint query = 0;
      GLenum function;
      explicit TieQueryScope(GLenum usual) : function(usual) {
        glGenQueries(1, &query);
        glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_EQUAL);
        glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
      }
      void end() {
        if (!ended) glEndQuery(GL_ANY_SAMPLES_PASSED);
        ended = true;
      }
      ~TieQueryScope() {
        end();
        glDepthFunc(function);
        glDepthMask(GL_TRUE);
        glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
        glDeleteQueries(1, &query);
      }
      TieQueryScope(const TieQueryScope&) = delete;
      TieQueryScope& operator=(const TieQueryScope&) = delete;
      bool ended = false;
    } tie_query(static_cast<GLenum>(function));
    draw_gathered();
    tie_query.end();
    GLuint any = 0;
    glGetQueryObjectuiv(tie_query.query, GL_QUERY_RESULT, &any);
    return any != 0;
  }

  const PassInput& input_;
  const std::function<const gl::Program&(const Draw&)>& use_;
  OcclusionState& state_;
  int side_;
  SampleRect rect_;
  std::vector<Set> sets_;
  std::vector<Face> indices_;
  std::vector<std::size_t> ends_;
  gl::Buffer buffer_;
};

}  // namespace

void draw_sets(const PassInput& input, const std::function<const gl::Program&(const Draw&)>& use,
               const std::function<void()>& clear) {
  clear();
  if (input.plan.runs(effects::occlusion)) {
    if (!input.state.occlusion) input.state.occlusion = std::make_shared<OcclusionState>();
    TwoPassCulling(input, use).draw(clear);
    return;
  }
  draw_all_sets(input, use);
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
  if (plan.options.occlusion == Occlusion::off) return Decision{false, "switched off: all triangles are drawn"};
  if (plan.kept) return Decision{false, "only changed pixels are drawn"};
  if (plan.options.occlusion == Occlusion::automatic) {
    if (plan.triangles < facts.device.min_culling_triangles)
      return Decision{false, fmt::format("{}: drawing is faster than testing; culling pays from {} on this device",
                                         counted(plan.triangles, "triangle"), facts.device.min_culling_triangles)};
    // The overhead per set is as large as the time to draw a few triangles.
    if (plan.triangles < max_faces_per_cluster * plan.draws.size())
      return Decision{false, fmt::format("{} with few triangles each: drawing is faster than testing",
                                         counted(plan.draws.size(), "draw"))};
    if (facts.device.visible_share > 0)
      return Decision{false, fmt::format("in the last test, {:.0f} % of the triangles in view were visible",
                                         100 * facts.device.visible_share)};
  }
  return Decision{true, "occluded triangles are culled"};
}

}  // namespace

const Effect effects::occlusion{"occlusion", Effect::Kind::colors, decide};

}  // namespace rebake
