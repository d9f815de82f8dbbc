#include "mesh_ops/index/index.h"

#include <mutex>
#include <optional>

namespace rebake {

/// The parts, each with its own lock: whoever wants traits does not wait for rays.
class ObjectIndex {
 public:
  Memo<std::vector<TriangleTraits>> traits;
  Memo<RayTree> rays;

  std::shared_ptr<const WeldedCorners> corners(const BakedObject& object, double tolerance) const {
    const std::scoped_lock lock(corners_mutex_);
    return kept(corners_, tolerance, 0.0,
                [&] { return std::make_shared<const WeldedCorners>(weld(object, tolerance)); });
  }
  std::shared_ptr<const EdgeTable> edges(const BakedObject& object, double tolerance) const {
    const auto welded = corners(object, tolerance);
    const std::scoped_lock lock(edges_mutex_);
    return kept(edges_, tolerance, 0.0, [&] { return std::make_shared<const EdgeTable>(edges_between(*welded)); });
  }
  std::shared_ptr<const Components> components(const BakedObject& object, const Joining& joining) const {
    const auto welded = corners(object, joining.tolerance);
    const auto table = edges(object, joining.tolerance);
    const std::scoped_lock lock(components_mutex_);
    return kept(components_, joining, Joining{}, [&] {
      return std::make_shared<const Components>(opaque_components(object, *welded, *table, joining.gap));
    });
  }

 private:
  // The default setting's result is kept for good, and that of the last other setting.
  template <class Key, class T>
  struct Kept {
    std::shared_ptr<const T> standard;
    std::optional<Key> other_key;
    std::shared_ptr<const T> other;
  };
  template <class Key, class T, class Make>
  static std::shared_ptr<const T> kept(Kept<Key, T>& store, const Key& key, const Key& standard, Make make) {
    if (key == standard) return store.standard ? store.standard : store.standard = make();
    if (store.other_key != key) {
      store.other = make();
      store.other_key = key;
    }
    return store.other;
  }

  mutable std::mutex corners_mutex_, edges_mutex_, components_mutex_;
  mutable Kept<double, WeldedCorners> corners_;
  mutable Kept<double, EdgeTable> edges_;
  mutable Kept<Joining, Components> components_;
};

namespace {

std::shared_ptr<const ObjectIndex> index_of(const BakedObject& object) {
  return object.index.get([] { return std::make_shared<const ObjectIndex>(); });
}

}  // namespace

std::shared_ptr<const std::vector<TriangleTraits>> traits_of(const BakedObject& object) {
  return index_of(object)->traits.get(
      [&] { return std::make_shared<const std::vector<TriangleTraits>>(triangle_traits(object)); });
}
std::shared_ptr<const WeldedCorners> corners_of(const BakedObject& object, double tolerance) {
  return index_of(object)->corners(object, tolerance);
}
std::shared_ptr<const EdgeTable> edges_of(const BakedObject& object, double tolerance) {
  return index_of(object)->edges(object, tolerance);
}
std::shared_ptr<const Components> components_of(const BakedObject& object, const Joining& joining) {
  return index_of(object)->components(object, joining);
}
std::shared_ptr<const RayTree> rays_of(const BakedObject& object) {
  return index_of(object)->rays.get([&] { return std::make_shared<const RayTree>(object); });
}

std::shared_ptr<const RayTree> rays_if_there(const BakedObject& object) { return index_of(object)->rays.if_there(); }

void prepare_index(const BakedObject& object, const Progress& progress) {
  progress.at("indexing", 0);
  traits_of(object);
  progress.at("indexing", 0.35);
  components_of(object);
  progress.at("indexing", 0.7);
  rays_of(object);
  progress.at("indexing", 1);
}

}  // namespace rebake
