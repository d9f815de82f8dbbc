#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "mesh_ops/base/progress.h"
#include "mesh_ops/scene/scene.h"

namespace rebake {

/// A scene that is drawn in place of the one it was made of.
struct Preview {
  Scene scene;
  std::vector<NodePtr> of;  ///< the roots of the scene that it stands for
};

/// Makes previews off the window's thread. What is asked for last is made; what was asked for meanwhile is not.
class Previews {
 public:
  using Make = std::function<Scene(const Progress&)>;
  /// `wake` is called, from another thread, when there is one to take.
  explicit Previews(std::function<void()> wake);
  ~Previews();
  Previews(const Previews&) = delete;
  Previews& operator=(const Previews&) = delete;

  /// `make` may throw Error: there is no preview then, and what is shown stays. `exact` makes a better one of the same,
  /// where there is one, while nothing else is asked for.
  void request(std::vector<NodePtr> of, Make make, Make exact = {});
  /// Called with every preview before it can be taken, on their thread; null for none.
  void set_prepare(std::function<void(const Scene&)> prepare);
  /// What is being made is stopped where something later was asked for: nobody wants to see it any more.
  void drop_stale();
  /// Nothing is wanted any more; what is being made is stopped where it can be.
  void drop();
  /// How many were asked for so far.
  std::size_t requests() const;
  /// Whether one is being made or waits to be.
  bool busy() const;
  /// The latest that is done, once.
  std::optional<Preview> take();

 private:
  void loop();
  void make(std::unique_lock<std::mutex>& lock, const std::vector<NodePtr>& of, const Make& make);

  struct Wanted {
    std::vector<NodePtr> of;
    Make make, exact;
  };
  std::function<void()> wake_;
  std::mutex prepare_mutex_;
  std::function<void(const Scene&)> prepare_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wanted> wanted_;
  std::optional<Preview> made_;
  std::size_t requests_ = 0;
  bool running_ = false, refining_ = false, ending_ = false;
  std::atomic<bool> cancel_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace rebake
