#include "render/gpu_scene/gpu_scene.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>

namespace rebake {

namespace {

constexpr std::size_t faces_per_draw_cluster = 2048;

std::vector<GpuCluster> clusters_of(const Soup& soup, const std::vector<Face>& faces) {
  std::vector<GpuCluster> clusters((faces.size() + faces_per_draw_cluster - 1) / faces_per_draw_cluster);
  tbb::parallel_for(std::size_t{0}, clusters.size(), [&](std::size_t k) {
    const std::size_t first = k * faces_per_draw_cluster;
    GpuCluster cluster{first, std::min(faces_per_draw_cluster, faces.size() - first), {}};
    for (std::size_t f = first; f < first + cluster.face_count; ++f)
      for (const std::uint32_t vertex : faces[f]) cluster.bounds.extend(soup.positions()[vertex]);
    clusters[k] = cluster;
  });
  return clusters;
}

// In bytes: the overhead per surface or mesh, and the size up to which upload_slice() leaves a change to update().
constexpr double each_upload = 65536, at_once = 8e6;

// Surfaces that a scene no longer needs. Sets for which serves() is true can take them over.
class ReleasedSurfaces {
 public:
  ReleasedSurfaces(const std::vector<SurfaceKey>& keys, const std::map<SurfaceKey, GpuSurface>& surfaces)
      : surfaces_(surfaces) {
    for (const SurfaceKey& key : keys) left_.emplace(std::pair(key.uvs, key.faces), key);
  }

  std::optional<SurfaceKey> take(const TextureSet& set, bool coded) {
    const SurfaceKey wanted = surface_key(set, coded);
    const auto [begin, end] = left_.equal_range({wanted.uvs, wanted.faces});
    const auto found = std::find_if(begin, end, [&](const auto& entry) {
      const GpuSurface& held = surfaces_.at(entry.second);
      return entry.second.coded == coded && is_reusable_for(held.opacity_source, held.source, set);
    });
    if (found == end) return std::nullopt;
    const SurfaceKey key = found->second;
    left_.erase(found);
    return key;
  }
  std::vector<SurfaceKey> left() const {
    std::vector<SurfaceKey> keys;
    for (const auto& [place, key] : left_) keys.push_back(key);
    return keys;
  }

 private:
  const std::map<SurfaceKey, GpuSurface>& surfaces_;
  std::multimap<std::pair<const void*, const void*>, SurfaceKey> left_;
};

// Whether two meshes differ in positions only, as during a drag.
bool differs_in_positions(const MeshKey& held, const MeshKey& wanted) {
  return held.surface == wanted.surface && held.turns == nullptr && wanted.turns == nullptr;
}

// Replaces the positions of a resident mesh.
void update_positions(GpuMesh& mesh, PreparedMesh made) {
  mesh.source = std::move(made.source);
  mesh.center = made.center;
  mesh.clusters = std::move(made.clusters);
  mesh.nearby = std::move(made.nearby);
  glBindBuffer(GL_ARRAY_BUFFER, mesh.positions.name());
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(made.positions.size() * sizeof(made.positions[0])),
                  made.positions.data());
}

GpuMesh upload(PreparedMesh made, const GpuSurface& surface) {
  GpuMesh mesh;
  mesh.array = gl::make_vertex_array();
  glBindVertexArray(mesh.array.name());
  mesh.positions =
      gl::make_buffer(GL_ARRAY_BUFFER, made.positions.data(), made.positions.size() * sizeof(made.positions[0]));
  bind_vertices(mesh.positions, surface);
  if (!made.turns.empty()) {
    mesh.turns = gl::make_buffer(GL_ARRAY_BUFFER, made.turns.data(), made.turns.size() * sizeof(made.turns[0]));
    for (GLuint column = 0; column < 3; ++column) {
      glEnableVertexAttribArray(2 + column);
      glVertexAttribPointer(2 + column, 3, GL_FLOAT, GL_FALSE, sizeof(glm::mat3),
                            reinterpret_cast<const void*>(column * sizeof(glm::vec3)));
    }
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, surface.indices.name());
  glBindVertexArray(0);
  mesh.source = std::move(made.source);
  mesh.center = made.center;
  mesh.clusters = std::move(made.clusters);
  mesh.nearby = std::move(made.nearby);
  return mesh;
}

gl::Texture upload(const LightChart& chart, GLenum format, int bytes, GLenum order, const float* values) {
  gl::Texture texture = gl::make_texture(format, chart.width, chart.height, bytes);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, chart.width, chart.height, order, GL_FLOAT, values);
  return texture;
}

gl::Texture upload(const LightChart& chart, const std::vector<Eigen::Vector3f>& values) {
  return upload(chart, GL_RGBA16F, 8, GL_RGB, values.front().data());
}

void upload_gloss(const LightChart& chart, const GlossMap& map, GpuLight& light) {
  light.gloss_before = upload(chart, GL_RGBA16F, 8, GL_RGBA, map.before.normals.front().data());
  light.gloss_after = upload(chart, GL_RGBA16F, 8, GL_RGBA, map.after.normals.front().data());
  std::vector<float> suns;
  for (std::size_t k = 0; k < map.before.suns.size(); ++k) {
    suns.push_back(map.before.suns[k]);
    suns.push_back(map.after.suns[k]);
  }
  light.gloss_suns = upload(chart, GL_RG16F, 4, GL_RG, suns.data());
}

GpuLight upload(const std::shared_ptr<const LightMap>& map) {
  GpuLight light;
  light.source = map;
  light.places = gl::make_buffer(GL_ARRAY_BUFFER, map->chart->places.data(),
                                 map->chart->places.size() * sizeof(map->chart->places[0]));
  light.gain = upload(*map->chart, map->gain);
  if (!map->offset.empty()) light.offset = upload(*map->chart, map->offset);
  if (map->gloss) upload_gloss(*map->chart, *map->gloss, light);
  return light;
}

}  // namespace

PreparedMesh prepared(const TextureSet& set, const ShownFaces& shown) {
  const Soup& soup = set.soup;
  PreparedMesh made;
  made.source = set;
  made.shown = shown.faces;
  if (!soup.bounds().isEmpty()) made.center = soup.bounds().center();
  made.positions.resize(soup.positions().size());
  tbb::parallel_for(std::size_t{0}, made.positions.size(),
                    [&](std::size_t v) { made.positions[v] = to_glm(Vec3(soup.positions()[v] - made.center)); });
  if (soup.rotations() != nullptr) {
    const auto& rotations = *soup.rotations();
    made.turns.resize(rotations.size());
    tbb::parallel_for(std::size_t{0}, rotations.size(),
                      [&](std::size_t v) { made.turns[v] = to_glm(Mat3(rotations[v].matrix())); });
  }
  made.clusters = clusters_of(soup, *shown.faces);
  made.nearby = face_clusters(soup, *shown.faces, *shown.nearby, made.center);
  return made;
}

PreparedMesh GpuScene::take_mesh(const TextureSet& set, bool coded, const GpuSurface& surface) {
  {
    const std::lock_guard lock(mutex_);
    if (auto node = prepared_meshes_.extract(mesh_key(set, coded));
        node && node.mapped().made.shown == surface.shown.faces)
      return std::move(node.mapped().made);
  }
  return prepared(set, surface.shown);
}

PreparedSurface GpuScene::take_surface(const TextureSet& set, bool coded) {
  {
    const std::lock_guard lock(mutex_);
    if (auto node = prepared_surfaces_.extract(surface_key(set, coded))) return std::move(node.mapped().made);
  }
  return prepared_surface(set, coded);
}

void GpuScene::prepare(const Scene& scene, bool coded) {
  std::set<MeshKey> meshes;
  std::set<SurfaceKey> surfaces;
  std::map<SurfaceKey, Held> held;
  std::map<SurfaceKey, ShownFaces> shown;
  unsigned turn = 0;
  {
    const std::lock_guard lock(mutex_);
    turn = ++prepare_calls_;
    held = held_surfaces_;
    for (const auto& [key, mesh] : held_meshes_) meshes.insert(key);
    for (const auto& [key, surface] : held_surfaces_) {
      surfaces.insert(key);
      shown[key] = surface.shown;
    }
    for (const auto& [key, faces] : staged_shown_) {
      surfaces.insert(key);
      shown[key] = faces;
    }
    const ResourceDiff wanted = diff(meshes, surfaces, scene, coded);
    const auto refresh = [&](auto& waiting, const auto& key) {
      if (const auto found = waiting.find(key); found != waiting.end()) found->second.turn = turn;
    };
    for (const TextureSet& set : wanted.meshes) refresh(prepared_meshes_, mesh_key(set, coded));
    for (const TextureSet& set : wanted.surfaces) refresh(prepared_surfaces_, surface_key(set, coded));
    // Data that this call and the two before did not need belong to a preview that was never shown.
    const auto old = [&](const auto& entry) { return entry.second.turn + 2 < turn; };
    std::erase_if(prepared_meshes_, old);
    std::erase_if(prepared_surfaces_, old);
    for (const auto& [key, made] : prepared_meshes_) meshes.insert(key);
    for (const auto& [key, made] : prepared_surfaces_) {
      surfaces.insert(key);
      shown[key] = made.made.shown;
    }
  }
  const ResourceDiff missing = diff(meshes, surfaces, scene, coded);
  std::set<SurfaceKey> taken_over;
  for (const TextureSet& set : missing.surfaces) {
    const SurfaceKey key = surface_key(set, coded);
    // update() will take over a resident surface and upload its changed texels: nothing to prepare.
    if (std::any_of(held.begin(), held.end(), [&](const auto& entry) {
          return entry.first.coded == coded && is_reusable_for(entry.second.opacity_source, entry.second.source, set);
        })) {
      taken_over.insert(key);
      continue;
    }
    PreparedSurface made = prepared_surface(set, coded);
    shown[key] = made.shown;
    const std::lock_guard lock(mutex_);
    prepared_surfaces_.insert_or_assign(key, PreparedEntry<PreparedSurface>{std::move(made), turn});
  }
  for (const TextureSet& set : missing.meshes) {
    const MeshKey key = mesh_key(set, coded);
    if (taken_over.contains(key.surface)) continue;
    PreparedMesh made = prepared(set, shown.at(key.surface));
    const std::lock_guard lock(mutex_);
    prepared_meshes_.insert_or_assign(key, PreparedEntry<PreparedMesh>{std::move(made), turn});
  }
}

void GpuScene::update_light(const Lighting* lighting) {
  std::set<const LightMap*> wanted;
  if (lighting != nullptr)
    for (const auto& [node, maps] : lighting->maps)
      for (const auto& map : maps)
        if (map) wanted.insert(map.get());
  std::erase_if(lights_, [&](const auto& entry) { return !wanted.contains(entry.first); });
  if (lighting == nullptr) return;
  for (const auto& [node, maps] : lighting->maps)
    for (const auto& map : maps)
      if (map && !lights_.contains(map.get())) lights_.emplace(map.get(), upload(map));
}

ResourceDiff GpuScene::difference(const Scene& scene, bool coded) const {
  std::set<MeshKey> held_meshes;
  for (const auto& [key, mesh] : meshes_) held_meshes.insert(key);
  std::set<SurfaceKey> held_surfaces;
  for (const auto& [key, surface] : surfaces_) held_surfaces.insert(key);
  return diff(held_meshes, held_surfaces, scene, coded);
}

void GpuScene::plan_staged_upload(const Scene& scene, bool coded) {
  const ResourceDiff change = difference(scene, coded);
  ReleasedSurfaces released(change.released_surfaces, surfaces_);
  StagedUpload plan{scene.roots, coded, changes_, {}, {}};
  std::set<SurfaceKey> wanted;
  double bytes = 0;
  for (const TextureSet& set : change.surfaces) {
    // update() takes over a resident surface and uploads its changed texels.
    if (released.take(set, coded)) continue;
    plan.surfaces.push_back(set);
    wanted.insert(surface_key(set, coded));
    bytes += each_upload + 8.0 * set.texels->width() * set.texels->height();
  }
  std::set<MeshKey> wanted_meshes;
  for (const TextureSet& set : change.meshes)
    if (const MeshKey key = mesh_key(set, coded); wanted.contains(key.surface)) {
      plan.meshes.push_back(set);
      wanted_meshes.insert(key);
      bytes += each_upload + 12.0 * static_cast<double>(set.soup.positions().size());
    }
  if (bytes <= at_once) {
    evict_staged();
    plan.surfaces.clear();
    plan.meshes.clear();
  }
  std::erase_if(staged_meshes_, [&](const auto& entry) { return !wanted_meshes.contains(entry.first); });
  std::erase_if(staged_surfaces_, [&](const auto& entry) { return !wanted.contains(entry.first); });
  staged_upload_ = std::move(plan);
  const std::lock_guard lock(mutex_);
  std::erase_if(staged_shown_, [&](const auto& entry) { return !staged_surfaces_.contains(entry.first); });
}

double GpuScene::upload_slice(const Scene& scene, bool coded, double milliseconds) {
  if (!staged_upload_ || staged_upload_->roots != scene.roots || staged_upload_->coded != coded ||
      staged_upload_->changes != changes_)
    plan_staged_upload(scene, coded);
  StagedUpload& plan = *staged_upload_;
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double, std::milli>(milliseconds);
  bool first = true;
  const auto goes_on = [&] { return std::exchange(first, false) || Clock::now() < end; };
  const double all = static_cast<double>(plan.surfaces.size() + 1);
  for (; plan.surfaces_uploaded < plan.surfaces.size(); ++plan.surfaces_uploaded) {
    const TextureSet& set = plan.surfaces[plan.surfaces_uploaded];
    const SurfaceKey key = surface_key(set, coded);
    auto arriving = staged_surfaces_.find(key);
    if (arriving == staged_surfaces_.end()) {
      if (!goes_on()) return static_cast<double>(plan.surfaces_uploaded) / all;
      arriving = staged_surfaces_.emplace(key, begin_upload(take_surface(set, coded))).first;
      const std::lock_guard lock(mutex_);
      staged_shown_.emplace(key, arriving->second.shown);
    }
    GpuSurface& surface = arriving->second;
    do
      if (!goes_on()) return (static_cast<double>(plan.surfaces_uploaded) + surface.uploaded) / all;
    while (!upload_next_slice(surface));
  }
  for (; plan.meshes_uploaded < plan.meshes.size(); ++plan.meshes_uploaded) {
    const TextureSet& set = plan.meshes[plan.meshes_uploaded];
    if (staged_meshes_.contains(mesh_key(set, coded))) continue;
    if (!goes_on()) return (all - 1) / all;
    const GpuSurface& surface = staged_surfaces_.at(surface_key(set, coded));
    staged_meshes_.emplace(mesh_key(set, coded), upload(take_mesh(set, coded, surface), surface));
  }
  return 1;
}

void GpuScene::evict_staged() {
  staged_upload_.reset();
  staged_meshes_.clear();
  staged_surfaces_.clear();
  const std::lock_guard lock(mutex_);
  staged_shown_.clear();
}

void GpuScene::update(const Scene& scene, bool coded, const Lighting* lighting) {
  update_light(lighting);
  coded_ = coded;
  ResourceDiff change = difference(scene, coded);
  if (change.meshes.empty() && change.surfaces.empty() && change.released_meshes.empty() &&
      change.released_surfaces.empty())
    return;
  // If texels changed and none became opaque, takes over the resident surface and uploads the changed texels only.
  ++changes_;
  ReleasedSurfaces released(change.released_surfaces, surfaces_);
  std::map<SurfaceKey, SurfaceKey> taken_over;
  std::erase_if(change.surfaces, [&](const TextureSet& set) {
    const std::optional<SurfaceKey> held = released.take(set, coded);
    if (!held) return false;
    const SurfaceKey key = surface_key(set, coded);
    auto node = surfaces_.extract(*held);
    taken_over[*held] = key;
    node.key() = key;
    texels_uploaded_ += reuse_surface(node.mapped(), set);
    surfaces_.insert(std::move(node));
    return true;
  });
  change.released_surfaces = released.left();
  const auto rekey_mesh = [&](std::vector<MeshKey>::iterator held, const TextureSet& set) -> GpuMesh& {
    auto node = meshes_.extract(*held);
    change.released_meshes.erase(held);
    node.key() = key(set);
    return meshes_.insert(std::move(node)).position->second;
  };
  // A mesh whose positions or texels alone changed reuses its buffers.
  std::erase_if(change.meshes, [&](const TextureSet& set) {
    const MeshKey key = mesh_key(set, coded);
    const auto now = [&](MeshKey other) {
      if (const auto found = taken_over.find(other.surface); found != taken_over.end()) other.surface = found->second;
      return other;
    };
    auto& gone = change.released_meshes;
    auto held = std::find_if(gone.begin(), gone.end(), [&](const MeshKey& other) { return now(other) == key; });
    if (held != gone.end()) {
      rekey_mesh(held, set).source = set;
      return true;
    }
    held = std::find_if(gone.begin(), gone.end(),
                        [&](const MeshKey& other) { return differs_in_positions(now(other), key); });
    if (held == gone.end()) return false;
    PreparedMesh made = take_mesh(set, coded, surface(set));
    update_positions(rekey_mesh(held, set), std::move(made));
    return true;
  });
  // Evicts before uploading, to limit the peak of memory.
  for (const MeshKey& key : change.released_meshes) meshes_.erase(key);
  for (const SurfaceKey& key : change.released_surfaces) surfaces_.erase(key);
  std::set<SurfaceKey> came;  // taken over from upload_slice()
  for (const TextureSet& set : change.surfaces) {
    const SurfaceKey key = surface_key(set, coded);
    auto arrived = staged_surfaces_.extract(key);
    if (arrived) came.insert(key);
    GpuSurface made = arrived ? std::move(arrived.mapped()) : begin_upload(take_surface(set, coded));
    while (!upload_next_slice(made)) {
    }
    texels_uploaded_ +=
        static_cast<std::uint64_t>(made.packing->width) * static_cast<std::uint64_t>(made.packing->height);
    surfaces_.emplace(key, std::move(made));
  }
  for (const TextureSet& set : change.meshes) {
    auto arrived = staged_meshes_.extract(key(set));
    if (arrived && came.contains(surface_key(set, coded)))
      meshes_.insert(std::move(arrived));
    else
      meshes_.emplace(key(set), upload(take_mesh(set, coded, surface(set)), surface(set)));
  }
  if (staged_upload_ && staged_upload_->roots == scene.roots) evict_staged();
  record_held();
}

void GpuScene::record_held() {
  const std::lock_guard lock(mutex_);
  held_meshes_.clear();
  for (const auto& [key, mesh] : meshes_) held_meshes_.emplace(key, mesh.source);
  held_surfaces_.clear();
  for (const auto& [key, surface] : surfaces_)
    held_surfaces_.emplace(key, Held{surface.source, surface.opacity_source, surface.shown});
  std::erase_if(prepared_meshes_, [&](const auto& entry) { return held_meshes_.contains(entry.first); });
  std::erase_if(prepared_surfaces_, [&](const auto& entry) { return held_surfaces_.contains(entry.first); });
  std::erase_if(staged_shown_, [&](const auto& entry) { return held_surfaces_.contains(entry.first); });
}

std::uint64_t GpuScene::texel_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [key, surface] : surfaces_)
    bytes += surface.coded ? surface.coded->blocks.bytes() + surface.coded->words.bytes() : surface.texels.bytes();
  return bytes;
}

void bind_vertices(const gl::Buffer& positions, const GpuSurface& surface) {
  glBindBuffer(GL_ARRAY_BUFFER, positions.name());
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(glm::vec3), nullptr);
  glBindBuffer(GL_ARRAY_BUFFER, surface.vertices.name());
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(SurfaceVertex),
                        reinterpret_cast<const void*>(offsetof(SurfaceVertex, texel)));
  const auto whole_numbers = [](GLuint location, GLint count, std::size_t offset) {
    glEnableVertexAttribArray(location);
    glVertexAttribIPointer(location, count, GL_UNSIGNED_SHORT, sizeof(SurfaceVertex),
                           reinterpret_cast<const void*>(offset));
  };
  whole_numbers(6, 4, offsetof(SurfaceVertex, first_texel));
  whole_numbers(7, 2, offsetof(SurfaceVertex, place));
}

}  // namespace rebake
