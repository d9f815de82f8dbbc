#include "editor/gui/window.h"

#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include "mesh_ops/error.h"

namespace rebake {

namespace {

std::string last_error = "unknown";  // GLFW tells it to a plain function only

constexpr const char* without_window = "without a window there are: rebake run, render, export, batch";

class WindowContext final : public gl::Context {
 public:
  explicit WindowContext(GLFWwindow* window) : window_(window) {}
  void make_current() override { glfwMakeContextCurrent(window_); }

 private:
  GLFWwindow* window_;
};

}  // namespace

/// GLFW's callbacks, which carry a pointer to the window. They are there before Dear ImGui's, which call them.
class Window::Callbacks {
 public:
  static void install(GLFWwindow* window) {
    glfwSetKeyCallback(window, [](GLFWwindow* w, int key, int, int action, int modifiers) {
      Window& self = of(w);
      if (action == GLFW_RELEASE || !self.on_key) return;
      self.on_key({key, (modifiers & GLFW_MOD_SHIFT) != 0, (modifiers & GLFW_MOD_CONTROL) != 0,
                   (modifiers & GLFW_MOD_ALT) != 0, action == GLFW_REPEAT});
    });
    glfwSetDropCallback(window, [](GLFWwindow* w, int count, const char** paths) {
      Window& self = of(w);
      if (self.on_drop) self.on_drop(std::vector<std::string>(paths, paths + count));
    });
    glfwSetCursorPosCallback(window, [](GLFWwindow* w, double, double) { of(w); });
    glfwSetMouseButtonCallback(window, [](GLFWwindow* w, int, int, int) { of(w); });
    glfwSetScrollCallback(window, [](GLFWwindow* w, double, double) { of(w); });
    glfwSetCharCallback(window, [](GLFWwindow* w, unsigned) { of(w); });
    glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { of(w); });
    glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w); });
    glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int) { of(w); });
    glfwSetWindowCloseCallback(window, [](GLFWwindow* w) { of(w); });
  }

 private:
  static Window& of(GLFWwindow* window) {
    Window& self = *static_cast<Window*>(glfwGetWindowUserPointer(window));
    ++self.events_;
    return self;
  }
};

Window::Window(const std::string& title, int width, int height) {
  glfwSetErrorCallback([](int, const char* text) { last_error = text; });
  if (glfwInit() != GLFW_TRUE)
    throw DeviceError(fmt::format("no window can be opened here ({}); {}", last_error, without_window));
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (window_ == nullptr) {
    glfwTerminate();
    throw DeviceError(
        fmt::format("no window with OpenGL 3.3 core can be opened here ({}); {}", last_error, without_window));
  }
  glfwSetWindowSizeLimits(window_, 640, 480, GLFW_DONT_CARE, GLFW_DONT_CARE);
  glfwSetWindowUserPointer(window_, this);
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  Callbacks::install(window_);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // the layout is kept in the settings
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  glfwMakeContextCurrent(window_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
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
  if (seconds < 0)
    glfwWaitEvents();
  else if (seconds > 0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
  return std::exchange(events_, 0) > 0;
}
void Window::wake() { glfwPostEmptyEvent(); }

void Window::begin_frame() {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
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
