#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <thread>

#include "mesh_ops/light/lighting.h"

namespace rebake {

/// Computes the light corrections (Lighting) of the shown scene on a background thread. Progressive: a result with few
/// rays first, then one with all rays, unless a newer request cancels it.
class Relighter {
 public:
  /// `wake` is called from the background thread when latest() has changed.
  explicit Relighter(std::function<void()> wake);
  ~Relighter();
  Relighter(const Relighter&) = delete;
  Relighter& operator=(const Relighter&) = delete;

  /// Requests the light of a scene and cancels an earlier, different request. `rough`: no full result, for drags.
  /// `nodes`: nodes that may be dragged next. If only their triangles have moved since the last full result, their
  /// light is rotated with the surface (DragLight) instead of traced.
  void request(const Scene& scene, bool rough, std::set<NodeId> nodes);
  /// Makes the next request compute again, because a trained model was stored or removed.
  void forget_request();
  /// The latest result; null if the baked light is to be shown. May belong to an earlier scene and is then approximate.
  /// Lighting::map_of() ignores it for texture sets whose UVs have changed.
  std::shared_ptr<const Lighting> latest() const;
  /// Whether a request is running or waiting.
  bool busy() const;
  /// Error message of the last request; empty if it succeeded.
  std::string problem() const;

 private:
  /// A request().
  struct Wanted {
    Scene scene;
    bool rough;
    std::set<NodeId> nodes;
  };
  void loop();
  bool same(const Wanted& a, const Wanted& b) const;
  bool publish_rotated_light(const Scene& scene);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wanted> wanted_, asked_;  ///< the waiting request; the last request, waiting or not
  std::shared_ptr<const Lighting> latest_;
  std::string problem_;
  Scene start_scene_;                      ///< scene of `start_`; used by the background thread only
  std::shared_ptr<const Lighting> start_;  ///< last full result, start of drags; used by the background thread only
  bool running_ = false, ending_ = false, quick_pass_ = false;
  std::atomic<bool> cancel_ = false;
  std::thread thread_;  // declared last because it uses the other members
};

}  // namespace rebake
