#include "editor/gui/platform/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <utility>

#include "mesh_ops/base/error.h"

namespace rebake {

namespace {

std::string last_error = "unknown";  // global because GLFW's error callback has no user pointer

constexpr const char* without_window = "subcommands that need no window: rebake run, render, export, batch";

class WindowContext final : public gl::Context {
 public:
  explicit WindowContext(GLFWwindow* window) : window_(window) {}
  bool is_current() const override { return glfwGetCurrentContext() == window_; }
  void make_current() override { glfwMakeContextCurrent(window_); }
  void release() override { glfwMakeContextCurrent(nullptr); }

 private:
  GLFWwindow* window_;
};

}  // namespace

/// GLFW's callbacks. They find the Window by GLFW's user pointer and queue input for begin_frame().
class Window::Callbacks {
 public:
  static void install(GLFWwindow* window) {
    using Kind = InputEvent::Kind;
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int scancode, int action, int modifiers) {
      of(w).waiting_.push_back(
          {action == GLFW_REPEAT ? Kind::repeat : Kind::key, key, scancode, action != GLFW_RELEASE, modifiers, 0, 0});
    });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned character) {
      of(w).waiting_.push_back({Kind::text, static_cast<int>(character), 0, true, 0, 0, 0});
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) {
      of(w).waiting_.push_back({Kind::move, 0, 0, false, 0, x, y});
    });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int button, int action, int modifiers) {
      of(w).waiting_.push_back({Kind::button, button, 0, action == GLFW_PRESS, modifiers, 0, 0});
    });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double x, double y) {
      of(w).waiting_.push_back({Kind::wheel, 0, 0, false, 0, x, y});
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
      Window& self = of(w);
      if (self.on_drop) self.on_drop(std::vector<std::string>(paths, paths + count));
    });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { of(w); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
      of(w);
      ImGui_ImplGlfw_WindowFocusCallback(w, focused);
    });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* w) { of(w); });
  }

 private:
  static Window& of(GLFWwindow* window) {
    Window& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    ++self.events_;
    return self;
  }
};

WindowSystem::WindowSystem() {
  glfwSetErrorCallback([](int, const char* text) { last_error = text; });
  if (glfwInit() != GLFW_TRUE)
    throw DeviceError(fmt::format("cannot open a window ({}); {}", last_error, without_window));
}
WindowSystem::~WindowSystem() { glfwTerminate(); }
void WindowSystem::wake() { glfwPostEmptyEvent(); }

Window::Window(const WindowSystem& /*system*/, const std::string& title, int width, int height) {
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  // Asks the driver to report resets, if it can; without a report, drawing just stops.
  glfwWindowHint(GLFW_CONTEXT_ROBUSTNESS, GLFW_LOSE_CONTEXT_ON_RESET);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr)
    throw DeviceError(fmt::format("cannot open a window with OpenGL 3.3 core ({}); {}", last_error, without_window));
  glfwSetWindowSizeLimits(window_, 640, 400, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSetWindowUserPointer(window_, this);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwGetCursorPos(window_, &pointer_x_, &pointer_y_);
  loss_.emplace();
  Callbacks::install(window_);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // Settings holds the layout
  ImGui_ImplGlfw_InitForOpenGL(window_, false);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  glfwMakeContextCurrent(window_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
}

std::unique_ptr<gl::Context> Window::context() { return std::make_unique<WindowContext>(window_); }
bool Window::wants_to_close() const { return glfwWindowShouldClose(window_) == GLFW_TRUE; }
void Window::stay_open() { glfwSetWindowShouldClose(window_, GLFW_FALSE); }
void Window::close() { glfwSetWindowShouldClose(window_, GLFW_TRUE); }
void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

int Window::width() const {
  int width = 0;
  glfwGetFramebufferSize(window_, &width, nullptr);
  return width;
}
int Window::height() const {
  int height = 0;
  glfwGetFramebufferSize(window_, nullptr, &height);
  return height;
}
double Window::scale() const {
  float scale = 1;
  glfwGetWindowContentScale(window_, &scale, nullptr);
  return static_cast<double>(scale);
}

bool Window::wait(double seconds) {
  if (!waiting_.empty()) seconds = 0;
  if (seconds < 0)
    glfwWaitEvents();
  else if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
  return std::exchange(events_, 0) > 0 || !waiting_.empty();
}
bool Window::lost() const { return loss_->lost(); }

void Window::renew_fonts() {
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

void Window::begin_frame() {
  using Kind = InputEvent::Kind;
  moves_.clear();
  for (std::size_t count = events_of_frame(waiting_); count > 0; --count) {
    const InputEvent event = waiting_.front();
    waiting_.pop_front();
    switch (event.kind) {
      case Kind::move:
        pointer_x_ = event.x;
        pointer_y_ = event.y;
        moves_.push_back({event.x, event.y});
        break;
      case Kind::button:
        if (static_cast<std::size_t>(event.code) < buttons_.size())
          buttons_[static_cast<std::size_t>(event.code)] = event.down;
        ++seen_.buttons;
        break;
      case Kind::wheel:
        ImGui_ImplGlfw_ScrollCallback(window_, event.x, event.y);
        ++seen_.wheel;
        break;
      case Kind::text:
        ImGui_ImplGlfw_CharCallback(window_, static_cast<unsigned>(event.code));
        ++seen_.text;
        break;
      case Kind::key:
      case Kind::repeat:
        if (event.kind == Kind::key) ++seen_.keys;
        // Before Dear ImGui gets the key.
        if (event.down && on_key)
          on_key({event.code, (event.modifiers & GLFW_MOD_SHIFT) != 0, (event.modifiers & GLFW_MOD_CONTROL) != 0,
                  (event.modifiers & GLFW_MOD_ALT) != 0, event.kind == Kind::repeat});
        ImGui_ImplGlfw_KeyCallback(window_, event.code, event.scancode, event.down ? GLFW_PRESS : GLFW_RELEASE,
                                   event.modifiers);
    }
  }
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  // Overrides the current state, which the backend has read, by the state at the last processed event.
  ImGuiIO& io = ImGui::GetIO();
  io.MousePos = {static_cast<float>(pointer_x_), static_cast<float>(pointer_y_)};
  std::copy(buttons_.begin(), buttons_.end(), io.MouseDown);
  ImGui::NewFrame();
}
void Window::end_frame() {
  ImGui::Render();
  glfwMakeContextCurrent(window_);
  gl::clear_window(width(), height());
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
}

}  // namespace rebake
