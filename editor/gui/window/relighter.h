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

/// Works out what light does to the scene that is shown, off the window's thread: roughly at once, then better while
/// nothing else is shown.
class Relighter {
 public:
  /// `wake` is called, from another thread, when there is something to take.
  explicit Relighter(std::function<void()> wake);
  ~Relighter();
  Relighter(const Relighter&) = delete;
  Relighter& operator=(const Relighter&) = delete;

  /// Wants the light of this scene; what was asked for before is stopped unless it is the same. `rough`: only the
  /// first, quick answer, as while something is dragged: where just triangles of `nodes` move, their light turns along
  /// (TurnedLight).
  void request(const Scene& scene, bool rough, std::set<NodeId> nodes);
  /// Null where light stays as it was baked. What was worked out last, maybe of a scene before: of triangles that are
  /// still the same it holds roughly.
  std::shared_ptr<const Lighting> latest() const;
  /// Whether something better is being worked out.
  bool busy() const;
  /// Why there is none, in words for people; empty where there is.
  std::string problem() const;

 private:
  struct Wanted {
    Scene scene;
    bool rough;
    std::set<NodeId> nodes;
  };
  void loop();
  bool same(const Wanted& a, const Wanted& b) const;
  bool turn_along(const Scene& scene);

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Wanted> wanted_, asked_;  ///< to be done; asked for last
  std::shared_ptr<const Lighting> latest_;
  std::string problem_;
  Scene start_scene_;                      ///< of `start_`; the thread's own
  std::shared_ptr<const Lighting> start_;  ///< worked out in full, and how it goes along; the thread's own
  bool running_ = false, ending_ = false, quick_pass_ = false;
  std::atomic<bool> cancel_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace rebake
