#include "render/gpu_scene/gpu_scene.h"

#include <epoxy/gl.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "mesh_ops/index/opacity.h"

namespace rebake {

namespace {

constexpr std::size_t faces_a_cluster = 2048;

std::vector<GpuVertex> vertices_of(const TextureSet& set, const Vec3& center) {
  const Soup& soup = set.soup;
  std::vector<GpuVertex> vertices(soup.positions().size());
  const double width = set.texels->width(), height = set.texels->height();
  tbb::parallel_for(std::size_t{0}, vertices.size(), [&](std::size_t v) {
    const Eigen::Vector3f position = (soup.positions()[v] - center).cast<float>();
    const Vec2& uv = soup.uvs()[v];
    vertices[v] = {{position.x(), position.y(), position.z()},
                   {static_cast<float>(uv.x() * width), static_cast<float>((1 - uv.y()) * height)}};
  });
  return vertices;
}

std::vector<GpuCluster> clusters_of(const Soup& soup, const std::vector<Face>& faces) {
  std::vector<GpuCluster> clusters((faces.size() + faces_a_cluster - 1) / faces_a_cluster);
  tbb::parallel_for(std::size_t{0}, clusters.size(), [&](std::size_t k) {
    const std::size_t first = k * faces_a_cluster;
    GpuCluster cluster{first, std::min(faces_a_cluster, faces.size() - first), {}};
    for (std::size_t f = first; f < first + cluster.face_count; ++f)
      for (const std::uint32_t vertex : faces[f]) cluster.bounds.extend(soup.positions()[vertex]);
    clusters[k] = cluster;
  });
  return clusters;
}

// Whether the same triangles of both show something.
bool same_faces(const MeshKey& a, const MeshKey& b) {
  return a.uvs == b.uvs && a.faces == b.faces && a.texels == b.texels;
}

// Whether a mesh is a set's but for its positions, as while something is dragged.
bool differs_in_place(const MeshKey& held, const MeshKey& wanted) {
  return same_faces(held, wanted) && held.turns == nullptr && wanted.turns == nullptr;
}

// New positions into a mesh that is there.
void move_vertices(GpuMesh& mesh, PreparedMesh made) {
  mesh.source = std::move(made.source);
  mesh.center = made.center;
  mesh.clusters = std::move(made.clusters);
  mesh.nearby = std::move(made.nearby);
  glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.name());
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(made.vertices.size() * sizeof(GpuVertex)),
                  made.vertices.data());
}

GpuMesh upload(PreparedMesh made) {
  GpuMesh mesh;
  mesh.array = gl::make_vertex_array();
  glBindVertexArray(mesh.array.name());
  mesh.vertices = gl::make_buffer(GL_ARRAY_BUFFER, made.vertices.data(), made.vertices.size() * sizeof(GpuVertex));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(GpuVertex), nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(GpuVertex),
                        reinterpret_cast<const void*>(offsetof(GpuVertex, texel)));
  if (!made.turns.empty()) {
    mesh.turns = gl::make_buffer(GL_ARRAY_BUFFER, made.turns.data(), made.turns.size() * sizeof(float));
    for (GLuint column = 0; column < 3; ++column) {
      glEnableVertexAttribArray(2 + column);
      glVertexAttribPointer(2 + column, 3, GL_FLOAT, GL_FALSE, 9 * sizeof(float),
                            reinterpret_cast<const void*>(column * 3 * sizeof(float)));
    }
  }
  mesh.indices =
      gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, made.shown.faces->data(), made.shown.faces->size() * sizeof(Face));
  glBindVertexArray(0);
  mesh.source = std::move(made.source);
  mesh.center = made.center;
  mesh.shown = std::move(made.shown);
  mesh.clusters = std::move(made.clusters);
  mesh.nearby = std::move(made.nearby);
  return mesh;
}

GpuTexture upload(const std::shared_ptr<const FeatureTexture>& source) {
  GpuTexture result{source, gl::make_texture(GL_RG32UI, source->width(), source->height(), sizeof(Texel))};
  glPixelStorei(GL_UNPACK_ROW_LENGTH, TexelTile::size);
  for (int row = 0; row < source->tile_rows(); ++row) {
    for (int column = 0; column < source->tile_columns(); ++column) {
      const int x = column * TexelTile::size, y = row * TexelTile::size;
      glTexSubImage2D(GL_TEXTURE_2D, 0, x, y, std::min(TexelTile::size, source->width() - x),
                      std::min(TexelTile::size, source->height() - y), GL_RG_INTEGER, GL_UNSIGNED_INT,
                      source->tile(column, row)->texels.data());
    }
  }
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  return result;
}

gl::Texture upload(const LightChart& chart, const std::vector<Eigen::Vector3f>& values) {
  gl::Texture texture = gl::make_texture(GL_RGBA16F, chart.width, chart.height, 8);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, chart.width, chart.height, GL_RGB, GL_FLOAT, values.data());
  return texture;
}

GpuLight upload(const std::shared_ptr<const LightMap>& map) {
  GpuLight light;
  light.source = map;
  light.places = gl::make_buffer(GL_ARRAY_BUFFER, map->chart->places.data(),
                                 map->chart->places.size() * sizeof(map->chart->places[0]));
  light.gain = upload(*map->chart, map->gain);
  if (!map->offset.empty()) light.offset = upload(*map->chart, map->offset);
  return light;
}

}  // namespace

PreparedMesh prepared(const TextureSet& set, ShownFaces shown) {
  const Soup& soup = set.soup;
  PreparedMesh made;
  made.source = set;
  if (!soup.bounds().isEmpty()) made.center = soup.bounds().center();
  made.vertices = vertices_of(set, made.center);
  if (soup.rotations() != nullptr) {
    const auto& rotations = *soup.rotations();
    made.turns.resize(rotations.size() * 9);
    tbb::parallel_for(std::size_t{0}, rotations.size(), [&](std::size_t v) {
      for (std::size_t k = 0; k < 9; ++k) made.turns[v * 9 + k] = static_cast<float>(rotations[v].data()[k]);
    });
  }
  // Faces that show nothing are not worth a draw.
  made.shown = std::move(shown);
  if (!made.shown.faces) {
    const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
    auto faces = std::make_shared<std::vector<Face>>();
    for (std::size_t f = 0; f < shows.size(); ++f)
      if (shows[f] != 0) faces->push_back(soup.faces()[f]);
    made.shown.faces = std::move(faces);
  }
  if (!made.shown.nearby) made.shown.nearby = nearby_order(soup, *made.shown.faces);
  made.clusters = clusters_of(soup, *made.shown.faces);
  made.nearby = face_clusters(soup, *made.shown.faces, *made.shown.nearby, made.center);
  return made;
}

// What was prepared of a set, or is now.
PreparedMesh GpuScene::take_prepared(const TextureSet& set) {
  const MeshKey key = mesh_key(set);
  ShownFaces shown;
  {
    const std::lock_guard lock(mutex_);
    if (auto node = prepared_.extract(key)) return std::move(node.mapped().mesh);
    // Bent triangles show what they showed: that is not worked out again.
    for (const auto& [other, held] : held_)
      if (same_faces(other, key)) shown = held.shown;
  }
  return prepared(set, std::move(shown));
}

void GpuScene::prepare(const Scene& scene) {
  std::set<MeshKey> there;
  std::map<MeshKey, Held> held;
  {
    const std::lock_guard lock(mutex_);
    held = held_;
    for (const auto& [key, mesh] : held_) there.insert(key);
    ++turn_;
    for (const TextureSet& set : diff({}, {}, scene).meshes)
      if (const auto found = prepared_.find(mesh_key(set)); found != prepared_.end()) found->second.turn = turn_;
    // What two calls did not want is of a preview that was never shown.
    std::erase_if(prepared_, [&](const auto& entry) { return entry.second.turn + 2 < turn_; });
    for (const auto& [key, made] : prepared_) there.insert(key);
  }
  for (const TextureSet& set : diff(there, {}, scene).meshes) {
    const MeshKey key = mesh_key(set);
    ShownFaces shown;
    for (const auto& [other, mesh] : held)
      if (same_faces(other, key)) shown = mesh.shown;
    PreparedMesh made = prepared(set, std::move(shown));
    const std::lock_guard lock(mutex_);
    prepared_.insert_or_assign(key, Waiting{std::move(made), turn_});
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

void GpuScene::update(const Scene& scene, const Lighting* lighting) {
  update_light(lighting);
  std::set<MeshKey> held_meshes;
  for (const auto& [key, mesh] : meshes_) held_meshes.insert(key);
  std::set<TextureKey> held_textures;
  for (const auto& [key, texture] : textures_) held_textures.insert(key);
  ResourceDiff change = diff(held_meshes, held_textures, scene);
  if (change.meshes.empty() && change.textures.empty() && change.released_meshes.empty() &&
      change.released_textures.empty())
    return;
  // What has only moved keeps its buffers.
  std::erase_if(change.meshes, [&](const TextureSet& set) {
    const MeshKey key = mesh_key(set);
    const auto held = std::find_if(change.released_meshes.begin(), change.released_meshes.end(),
                                   [&](const MeshKey& other) { return differs_in_place(other, key); });
    if (held == change.released_meshes.end()) return false;
    auto node = meshes_.extract(*held);
    change.released_meshes.erase(held);
    node.key() = key;
    move_vertices(node.mapped(), take_prepared(set));
    meshes_.insert(std::move(node));
    return true;
  });
  // Before what comes needs the room; held_ still knows what of them showed something.
  for (const MeshKey& key : change.released_meshes) meshes_.erase(key);
  for (const TextureKey key : change.released_textures) textures_.erase(key);
  for (const TextureSet& set : change.meshes) meshes_.emplace(mesh_key(set), upload(take_prepared(set)));
  for (const auto& texture : change.textures) textures_.emplace(texture.get(), upload(texture));
  const std::lock_guard lock(mutex_);
  held_.clear();
  for (const auto& [key, mesh] : meshes_) held_.emplace(key, Held{mesh.source, mesh.shown});
  std::erase_if(prepared_, [&](const auto& entry) { return held_.contains(entry.first); });
}

}  // namespace rebake
