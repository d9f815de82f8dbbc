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

/// A scene that is drawn instead of the document's scene.
struct Preview {
  Scene scene;
  std::vector<NodePtr> of;  ///< roots of the scene that it was computed for
  std::size_t request = 0;  ///< number of its request, from 1
};

/// Computes previews on a background thread, latest wins: a request replaces one that has not started.
class Previews {
 public:
  using Make = std::function<Scene(const Progress&)>;
  /// `wake` is called from the background thread when a preview is ready.
  explicit Previews(std::function<void()> wake);
  ~Previews();
  Previews(const Previews&) = delete;
  Previews& operator=(const Previews&) = delete;

  /// Requests a preview for the scene with roots `of`. If `make` throws, there is no new preview. If `exact` is set, it
  /// then computes a better preview, until the next request cancels it. Returns the number of the request.
  std::size_t request(std::vector<NodePtr> of, Make make, Make exact = {});
  /// `prepare` is called on the background thread with each scene before take() can return it; null for none.
  void set_prepare(std::function<void(const Scene&)> prepare);
  /// Cancels the running computation if a newer request is waiting.
  void drop_stale();
  /// Discards all requests and results, and cancels the running computation.
  void drop();
  /// Number of requests so far.
  std::size_t requests() const;
  /// Whether a computation is running or waiting.
  bool busy() const;
  /// Why the latest request failed; empty if it did not.
  std::string problem() const;
  /// Returns the latest result, once.
  std::optional<Preview> take();

 private:
  void loop();
  /// A request().
  struct Wanted {
    std::vector<NodePtr> of;
    Make make, exact;
    std::size_t number = 0;
  };
  void make(std::unique_lock<std::mutex>& lock, const Wanted& wanted, const Make& make);

  std::function<void()> wake_;
  std::mutex prepare_mutex_;
  std::function<void(const Scene&)> prepare_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wanted> wanted_;  ///< the waiting request
  std::optional<Preview> made_;   ///< the latest result, until take()
  std::string problem_;
  std::size_t requests_ = 0;
  bool running_ = false, refining_ = false, ending_ = false;  ///< refining_: `exact` of a request is running
  std::atomic<bool> cancel_ = false;
  std::thread thread_;  // declared last because it uses the other members
};

}  // namespace rebake
