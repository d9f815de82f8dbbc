#include "render/picture.h"

#include <epoxy/gl.h>

#include <chrono>
#include <cstring>

#include "mesh_ops/base/error.h"
#include "render/gl/context.h"
#include "render/gpu_scene/gpu_scene.h"
#include "render/graph/passes.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void fit_overlay(FrameTargets& targets, const FramePlan& plan, bool wanted) {
  if (!wanted) {
    targets.overlay_buffer = {};
  } else if (!targets.overlay_buffer) {
    targets.overlay_buffer = gl::make_framebuffer({&targets.picture}, nullptr);
  }
  if (!plan.runs("selection")) {
    targets.mask_buffer = {};
    targets.mask = {};
  } else if (!targets.mask) {
    targets.mask = gl::make_texture(GL_R8, targets.width, targets.height, 1);
    targets.mask_buffer = gl::make_framebuffer({&targets.mask}, nullptr);
  }
}

// Makes the buffers that the plan calls for, and frees those that it does not.
void fit(FrameTargets& targets, const FramePlan& plan) {
  const bool features = plan.runs("geometry"), frames = features && plan.runs("node frames"),
             rays = features && plan.runs("turned rays");
  const bool forward = plan.runs("forward") || plan.runs("inspect");
  const bool overlay = plan.runs("selection") || plan.runs("guides");
  const int side = plan.view.side();
  const int width = plan.view.width, height = plan.view.height;
  if (targets.picture && targets.width == width && targets.height == height && targets.side == side &&
      targets.has_features == features && targets.has_frames == frames && targets.has_rays == rays &&
      bool(targets.depth) == (features || forward)) {
    fit_overlay(targets, plan, overlay);
    return;
  }
  // Its size is set at the end: what fails in between is made anew.
  targets = {};
  targets.side = side;
  targets.has_features = features;
  targets.has_frames = frames;
  targets.has_rays = rays;
  targets.picture = gl::make_texture(GL_RGBA8, width, height, 4);
  if (features || forward) targets.depth = gl::make_texture(GL_DEPTH_COMPONENT32F, width * side, height * side, 4);
  if (features) {
    targets.features = gl::make_texture(GL_RG32UI, width * side, height * side, 8);
    std::vector<const gl::Texture*> colors{&targets.features};
    if (frames) {
      targets.frames = gl::make_texture(GL_R16UI, width * side, height * side, 2);
      colors.push_back(&targets.frames);
    }
    if (rays) {
      targets.rays = gl::make_texture(GL_RGBA32F, width * side, height * side, 16);
      colors.push_back(&targets.rays);
    }
    targets.sample_buffer = gl::make_framebuffer(colors, &targets.depth);
  }
  targets.picture_buffer = gl::make_framebuffer({&targets.picture}, forward ? &targets.depth : nullptr);
  targets.width = width;
  targets.height = height;
  fit_overlay(targets, plan, overlay);
}

}  // namespace

class Renderer::Impl {
 public:
  explicit Impl(std::unique_ptr<gl::Context> context) : context_(std::move(context)) {
    const gl::Current current(*context_);
    device_ = gl::device_name();
    state_.empty_array = gl::make_vertex_array();
  }

  // What members delete are names in this context, whichever was used last.
  ~Impl() {
    try {
      const gl::Current current(*context_);
      state_ = {};
      gpu_ = {};
    } catch (const Error&) {
      // Lost, and its names with it.
    }
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  FrameTimes draw(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass,
                  const Guides* guides = nullptr, std::vector<PlannedPass>* passes = nullptr) {
    const gl::Current current(*context_);
    const Clock::time_point start = Clock::now();
    const FramePlan frame_plan = plan(scene, view, options, guides);
    if (passes != nullptr) *passes = frame_plan.passes;
    shown_ = view;
    if (frame_plan.frames.size() > 65535)
      throw DeviceError("more than 65535 differently placed objects are in view; merge or hide some");
    gpu_.update(scene);
    fit(state_.targets, frame_plan);
    if (!frame_plan.runs("selection")) state_.selected.clear();
    glBindFramebuffer(GL_FRAMEBUFFER, state_.targets.picture_buffer.name());
    glDisable(GL_SCISSOR_TEST);
    const Color& b = frame_plan.background;
    const float background[4] = {static_cast<float>(b.x()), static_cast<float>(b.y()), static_cast<float>(b.z()), 1};
    glClearBufferfv(GL_COLOR, 0, background);
    FrameTimes times;
    for (const Pass& pass : pass_table) {
      if (!frame_plan.runs(pass.name)) continue;
      if (each_pass) glFinish();
      const Clock::time_point pass_start = Clock::now();
      pass.execute({frame_plan, gpu_, state_});
      if (!each_pass) continue;
      glFinish();
      times.pass_ms[pass.name] = milliseconds_since(pass_start);
    }
    glFinish();
    times.frame_ms = milliseconds_since(start);
    if (const GLenum error = glGetError(); error != GL_NO_ERROR)
      throw DeviceError(error == GL_OUT_OF_MEMORY ? "the GPU's memory is out; use fewer samples or a smaller picture"
                                                  : "OpenGL reports error " + std::to_string(error));
    return times;
  }

  const std::string& device() const { return device_; }
  unsigned texture() const { return state_.targets.picture.name(); }

  Image read_back() {
    const gl::Current current(*context_);
    const View& view = shown_;
    Image image{
        view.width, view.height,
        std::vector<std::uint8_t>(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * 3)};
    std::vector<std::uint8_t> rgba(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * 4);
    glBindFramebuffer(GL_FRAMEBUFFER, state_.targets.picture_buffer.name());
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
    const auto width = static_cast<std::size_t>(view.width), height = static_cast<std::size_t>(view.height);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x)
        std::memcpy(&image.rgb[(y * width + x) * 3], &rgba[((height - 1 - y) * width + x) * 4], 3);
    return image;
  }

 private:
  std::unique_ptr<gl::Context> context_;  // outlives the rest, which are names in it
  GpuScene gpu_;
  PassState state_;
  View shown_;
  std::string device_;
};

Renderer::Renderer() : Renderer(gl::make_headless_context()) {}
Renderer::Renderer(std::unique_ptr<gl::Context> context) : impl_(std::make_unique<Impl>(std::move(context))) {}
Renderer::~Renderer() = default;

Image Renderer::render(const Scene& scene, const View& view, const RenderOptions& options) {
  impl_->draw(scene, view, options, false);
  return impl_->read_back();
}

FrameTimes Renderer::time_frame(const Scene& scene, const View& view, const RenderOptions& options, bool each_pass) {
  return impl_->draw(scene, view, options, each_pass);
}

Renderer::Shown Renderer::show(const Scene& scene, const View& view, const RenderOptions& options, const Guides& guides,
                               bool each_pass) {
  Shown shown;
  shown.times = impl_->draw(scene, view, options, each_pass, &guides, &shown.passes);
  shown.texture = impl_->texture();
  return shown;
}
Image Renderer::shown_image() { return impl_->read_back(); }

std::string Renderer::device() const { return impl_->device(); }
std::uint64_t Renderer::peak_gpu_bytes() const { return gl::memory_use().peak; }

}  // namespace rebake
