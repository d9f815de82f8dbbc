#include "render/picture.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include "mesh_ops/base/error.h"
#include "render/gl/context.h"
#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/passes.h"
#include "render/graph/variants.h"
#include "render/passes/pass_support.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

}  // namespace

class Renderer::Impl {
 public:
  explicit Impl(std::unique_ptr<gl::Context> context) : context_(std::move(context)) {
    const gl::CurrentContextScope current(*context_);
    device_ = gl::device_name();
    software_ = device_.find("llvmpipe") != std::string::npos || device_.find("softpipe") != std::string::npos ||
                device_.find("SWR") != std::string::npos;
    state_.empty_array = gl::make_vertex_array();
    GLint largest = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &largest);
    // Each 64-bit word is two texels of R32UI; two words of padding follow the data.
    reads_coded_ = static_cast<std::size_t>(largest) >= 2 * (max_coded_words + 2);
  }

  // Members delete objects of this context, so it must be current.
  ~Impl() {
    try {
      const gl::CurrentContextScope current(*context_);
      state_ = {};
      gpu_.reset();
    } catch (const Error&) {
      // The context is lost, and its objects with it.
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  FrameTimes draw(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass,
                  const Lighting* lighting, const Guides* guides = nullptr) {
    const gl::CurrentContextScope current(*context_);
    const Clock::time_point start = Clock::now();
    DeviceFacts facts = device_facts();
    if (drawn_) facts.shown = &*drawn_;
    FramePlan frame_plan = plan(scene, view, options, guides, lighting, facts);
    drawn_.reset();
    shown_ = view;
    texels_ = options.texels;
    if (frame_plan.frames.size() > 65535)
      throw DeviceError("more than 65535 different orientations of objects are in view; merge or hide some objects");
    update(scene, frame_plan.options.texels == RenderOptions::Texels::coded, lighting);
    const std::size_t made_before = state_.programs.made();
    FrameTimes times = carry_out(frame_plan, each_pass, start);
    if (state_.programs.made() != made_before) ++compiled_;
    remember(variant_of(frame_plan));
    passes_ = frame_plan.passes;
    if (frame_plan.runs(effects::occlusion)) append_occlusion_results();
    if (frame_plan.runs(effects::coded_texels)) append_coded_size();
    drawn_ = std::move(frame_plan);
    return times;
  }

  bool keeps(const Scene& scene, const View& view, const Guides& guides, const Lighting* lighting) const {
    if (!drawn_) return false;
    DeviceFacts facts;
    facts.reads_coded_texels = reads_coded_;
    facts.shown = &*drawn_;
    try {
      return plan(scene, view, {}, &guides, lighting, facts).kept;
    } catch (const Error&) {
      return false;  // draw() reports the error
    }
  }
  bool kept() const { return drawn_ && drawn_->kept; }

  bool compile_next_program(const Scene& scene, const View& view, const RenderOptions& options,
                            const Lighting* lighting) {
    const gl::CurrentContextScope current(*context_);
    for (PrecompileFrame& frame : precompile_frames(scene, view, options, lighting)) {
      RenderOptions all_drawn = options;
      all_drawn.occlusion = RenderOptions::Occlusion::off;
      const FramePlan frame_plan = plan(frame.scene, frame.view, all_drawn, nullptr, lighting, device_facts());
      if (!remember(variant_of(frame_plan))) continue;
      update(scene, uses_coded_texels(scene, options.texels, device_facts()), lighting);
      // Draws into separate render targets, so that the shown picture stays.
      PassState other;
      other.empty_array = gl::make_vertex_array();
      const auto exchange = [&] {
        std::swap(other, state_);
        std::swap(other.programs, state_.programs);
      };
      exchange();
      try {
        carry_out(frame_plan, false, Clock::now());
      } catch (...) {
        exchange();
        throw;
      }
      exchange();
      return true;
    }
    return false;
  }
  std::size_t compile_stall_count() const { return compiled_; }

  void prepare(const Scene& scene) { gpu_->prepare(scene, codes(scene)); }
  double upload_slice(const Scene& scene, double milliseconds) {
    const gl::CurrentContextScope current(*context_);
    try {
      const double share = gpu_->upload_slice(scene, codes(scene), milliseconds);
      if (glGetError() != GL_OUT_OF_MEMORY) return share;
    } catch (const std::exception&) {
      // draw() reports the error.
    }
    // The GPU cannot hold both scenes: update() will evict the current one before it uploads the next.
    gpu_->evict_staged();
    return 1;
  }
  void evict_staged() {
    const gl::CurrentContextScope current(*context_);
    gpu_->evict_staged();
  }
  const std::string& device() const { return device_; }
  gl::Context& context() { return *context_; }
  const std::vector<PlannedPass>& passes() const { return passes_; }
  unsigned texture() const { return state_.targets.texture(Target::picture).name(); }

  Image read_back() {
    const gl::CurrentContextScope current(*context_);
    const View& view = shown_;
    Image image{
        view.width,
        view.height,
        std::vector<std::uint8_t>(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * 3),
        {}};
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * 4);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_buffer());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    const auto width = static_cast<std::size_t>(view.width), height = static_cast<std::size_t>(view.height);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        std::memcpy(&image.rgb[(y * width + x) * 3], &rgba[((height - 1 - y) * width + x) * 4], 3);
    if (!drawn_ || !drawn_->options.transparent) return image;
    image.alpha.resize(width * height);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const std::size_t pixel = y * width + x;
        const unsigned alpha = rgba[((height - 1 - y) * width + x) * 4 + 3];
        image.alpha[pixel] = static_cast<std::uint8_t>(alpha);
        // Files store colours that are not multiplied by alpha.
        for (std::size_t c = 0; alpha > 0 && c < 3; ++c) {
          std::uint8_t& channel = image.rgb[pixel * 3 + c];
          channel = static_cast<std::uint8_t>(std::min(255U, (channel * 255U + alpha / 2) / alpha));
        }
      }
    return image;
  }

 private:
  bool codes(const Scene& scene) const {
    return uses_coded_texels(scene, texels_, {.reads_coded_texels = reads_coded_});
  }

  void update(const Scene& scene, bool coded, const Lighting* lighting) {
    gpu_->update(scene, coded, lighting);
    // Coded and plain texels are read by different programs.
    if (std::exchange(coded_, coded) != coded) variants_.clear();
  }

  // Runs the passes of a plan on the resident data.
  FrameTimes carry_out(const FramePlan& frame_plan, bool each_pass, Clock::time_point start) {
    state_.targets.fit(frame_plan);
    if (!frame_plan.runs(effects::selection)) state_.selected.clear();
    glBindFramebuffer(GL_FRAMEBUFFER, picture_buffer());
    glDisable(GL_SCISSOR_TEST);
    if (frame_plan.kept) restrict_to_covered(frame_plan, 1);
    const Color& b = frame_plan.background;
    const float background[4] = {static_cast<float>(b.x()), static_cast<float>(b.y()), static_cast<float>(b.z()),
                                 frame_plan.options.transparent ? 0.0F : 1.0F};
    glClearBufferfv(GL_COLOR, 0, background);
    FrameTimes times;
    for (const Effect* pass : effect_table()) {
      if (pass->execute == nullptr || !frame_plan.runs(*pass) || (frame_plan.kept && frame_plan.covered.empty()))
        continue;
      if (each_pass) glFinish();
      const Clock::time_point pass_start = Clock::now();
      pass->execute({frame_plan, *gpu_, state_, *pass});
      if (!each_pass) continue;
      glFinish();
      times.pass_ms[pass->name] = milliseconds_since(pass_start);
    }
    glFinish();
    times.frame_ms = milliseconds_since(start);
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      throw DeviceError(error == GL_OUT_OF_MEMORY ? "GPU memory is exhausted; use fewer samples or a smaller picture"
                                                  : "OpenGL reports error " + std::to_string(error));
    return times;
  }

  // Marks a variant as drawn last. Returns whether it is not among the 32 variants drawn before.
  bool remember(ProgramVariant variant) {
    constexpr std::size_t most = 32;
    const auto known = std::find(variants_.begin(), variants_.end(), variant);
    const bool fresh = known == variants_.end();
    if (!fresh) variants_.erase(known);
    variants_.push_back(std::move(variant));
    if (variants_.size() > most) variants_.erase(variants_.begin());
    return fresh;
  }

  DeviceFacts device_facts() {
    DeviceFacts facts;
    // A GPU draws triangles about 100 times faster than llvmpipe, but the tests run on the CPU in both cases.
    if (!software_) facts.min_culling_triangles = 2'000'000;
    facts.reads_coded_texels = reads_coded_;
    // If too few triangles were occluded, culling is tried again only every retry_interval frames.
    if (share_ > max_visible_share && ++frames_without_ < retry_interval) facts.visible_share = share_;
    return facts;
  }

  void append_occlusion_results() {
    const OcclusionCounts& c = state_.occlusion_counts;
    share_ = c.triangles_in_view == 0
                 ? 0
                 : static_cast<double>(c.triangles_shown) / static_cast<double>(c.triangles_in_view);
    frames_without_ = 0;
    for (PlannedPass& pass : passes_)
      if (pass.effect == &effects::occlusion)
        pass.why +=
            fmt::format(
                ": of {} clusters {} are visible, {} occluded, {} out of view; of {} triangles {} were drawn, {} may "
                "be visible{}; ",
                c.clusters, c.clusters_drawn, c.clusters_hidden, c.clusters_out_of_view, c.triangles, c.triangles_drawn,
                c.triangles_shown, c.drawn_again ? " and drawn again in scene order" : "") +
            (c.known ? std::string("results were reused, because nothing has moved")
                     : fmt::format("tests took {:.1f} ms", c.milliseconds));
  }

  void append_coded_size() {
    for (PlannedPass& pass : passes_)
      if (pass.effect == &effects::coded_texels) pass.why += fmt::format("; {:.0f} MB", gpu_->texel_bytes() / 1e6);
  }

  static constexpr double max_visible_share = 0.7;  // visible share of the triangles in view up to which culling pays
  static constexpr int retry_interval = 16;

  unsigned picture_buffer() { return state_.targets.framebuffer({Target::picture}, false).name(); }

  std::unique_ptr<gl::Context> context_;  // declared first: outlives the members that hold its objects
  std::optional<GpuScene> gpu_{std::in_place};
  PassState state_;
  View shown_;
  std::optional<FramePlan> drawn_;  ///< plan of the picture in the targets; nullopt if drawing failed
  std::string device_;
  bool software_ = false, reads_coded_ = true;
  bool coded_ = false;  ///< whether the resident texels are coded
  std::atomic<RenderOptions::Texels> texels_ = RenderOptions::Texels::automatic;  ///< option of the last picture
  std::vector<PlannedPass> passes_;
  std::vector<ProgramVariant> variants_;  ///< of drawn frames, the latest last
  std::size_t compiled_ = 0;
  double share_ = 0;
  int frames_without_ = 0;
};

Renderer::Renderer() : Renderer(gl::make_headless_context()) {}
Renderer::Renderer(std::unique_ptr<gl::Context> context) : impl_(std::make_unique<Impl>(std::move(context))) {}
Renderer::~Renderer() = default;

bool Renderer::compile_next_program(const Scene& scene, const View& view, const RenderOptions& options,
                                    const Lighting* lighting) {
  return impl_->compile_next_program(scene, view, options, lighting);
}
std::size_t Renderer::compile_stall_count() const { return impl_->compile_stall_count(); }

void Renderer::prepare(const Scene& scene) { impl_->prepare(scene); }

double Renderer::upload_slice(const Scene& scene, double milliseconds) {
  return impl_->upload_slice(scene, milliseconds);
}
void Renderer::evict_staged() { impl_->evict_staged(); }

Image Renderer::render(const Scene& scene, const View& view, const RenderOptions& options, const Lighting* lighting) {
  impl_->draw(scene, view, options, false, lighting);
  return impl_->read_back();
}

FrameTimes Renderer::time_frame(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass,
                                const Lighting* lighting) {
  return impl_->draw(scene, view, options, each_pass, lighting);
}

Renderer::Shown Renderer::show(const Scene& scene, const View& view, const RenderOptions& options, const Guides& guides,
                               bool each_pass, const Lighting* lighting) {
  Shown shown;
  shown.times = impl_->draw(scene, view, options, each_pass, lighting, &guides);
  shown.passes = impl_->passes();
  shown.texture = impl_->texture();
  shown.kept = impl_->kept();
  return shown;
}
bool Renderer::keeps(const Scene& scene, const View& view, const Guides& guides, const Lighting* lighting) const {
  return impl_->keeps(scene, view, guides, lighting);
}
Image Renderer::shown_image() { return impl_->read_back(); }

const std::vector<PlannedPass>& Renderer::passes() const { return impl_->passes(); }

std::string Renderer::device() const { return impl_->device(); }
gl::Context& Renderer::context() { return impl_->context(); }
std::uint64_t Renderer::peak_gpu_bytes() const { return gl::memory_use().peak; }

}  // namespace rebake
