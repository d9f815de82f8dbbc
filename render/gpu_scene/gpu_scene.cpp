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

void make_clusters(GpuMesh& mesh) {
  mesh.clusters.resize((mesh.faces.size() + faces_a_cluster - 1) / faces_a_cluster);
  tbb::parallel_for(std::size_t{0}, mesh.clusters.size(), [&](std::size_t k) {
    const std::size_t first = k * faces_a_cluster;
    GpuMesh::Cluster cluster{first, std::min(faces_a_cluster, mesh.faces.size() - first), {}};
    for (std::size_t f = first; f < first + cluster.face_count; ++f)
      for (const std::uint32_t vertex : mesh.faces[f]) cluster.bounds.extend(mesh.source.positions()[vertex]);
    mesh.clusters[k] = cluster;
  });
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
void move_vertices(GpuMesh& mesh, const TextureSet& set) {
  mesh.source = set.soup;
  if (!set.soup.bounds().isEmpty()) mesh.center = set.soup.bounds().center();
  const std::vector<GpuVertex> vertices = vertices_of(set, mesh.center);
  glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.name());
  glBufferSubData(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(vertices.size() * sizeof(GpuVertex)), vertices.data());
  make_clusters(mesh);
}

// `shown` are the faces that show something where they are known, else it is empty.
GpuMesh upload(const TextureSet& set, std::vector<Face> shown) {
  const Soup& soup = set.soup;
  GpuMesh mesh;
  mesh.source = soup;
  if (!soup.bounds().isEmpty()) mesh.center = soup.bounds().center();
  const std::vector<GpuVertex> vertices = vertices_of(set, mesh.center);

  mesh.array = gl::make_vertex_array();
  glBindVertexArray(mesh.array.name());
  mesh.vertices = gl::make_buffer(GL_ARRAY_BUFFER, vertices.data(), vertices.size() * sizeof(GpuVertex));
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(GpuVertex), nullptr);
  glEnableVertexAttribArray(1);
  glVertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, sizeof(GpuVertex),
                        reinterpret_cast<const void*>(offsetof(GpuVertex, texel)));
  if (soup.rotations() != nullptr) {
    std::vector<float> turns;
    turns.reserve(soup.rotations()->size() * 9);
    for (const Mat3& turn : *soup.rotations())
      for (Eigen::Index k = 0; k < 9; ++k) turns.push_back(static_cast<float>(turn.data()[k]));
    mesh.turns = gl::make_buffer(GL_ARRAY_BUFFER, turns.data(), turns.size() * sizeof(float));
    for (GLuint column = 0; column < 3; ++column) {
      glEnableVertexAttribArray(2 + column);
      glVertexAttribPointer(2 + column, 3, GL_FLOAT, GL_FALSE, 9 * sizeof(float),
                            reinterpret_cast<const void*>(column * 3 * sizeof(float)));
    }
  }
  // Faces that show nothing are not worth a draw.
  mesh.faces = std::move(shown);
  if (mesh.faces.empty()) {
    const std::vector<std::uint8_t> shows = faces_with_opaque_texels(set);
    for (std::size_t f = 0; f < shows.size(); ++f)
      if (shows[f] != 0) mesh.faces.push_back(soup.faces()[f]);
  }
  mesh.indices = gl::make_buffer(GL_ELEMENT_ARRAY_BUFFER, mesh.faces.data(), mesh.faces.size() * sizeof(Face));
  glBindVertexArray(0);
  make_clusters(mesh);
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

}  // namespace

void GpuScene::update(const Scene& scene) {
  std::set<MeshKey> held_meshes;
  for (const auto& [key, mesh] : meshes_) held_meshes.insert(key);
  std::set<TextureKey> held_textures;
  for (const auto& [key, texture] : textures_) held_textures.insert(key);
  ResourceDiff change = diff(held_meshes, held_textures, scene);
  // What has only moved keeps its buffers.
  std::erase_if(change.meshes, [&](const TextureSet& set) {
    const auto held = std::find_if(change.released_meshes.begin(), change.released_meshes.end(),
                                   [&](const MeshKey& key) { return differs_in_place(key, mesh_key(set)); });
    if (held == change.released_meshes.end()) return false;
    auto node = meshes_.extract(*held);
    change.released_meshes.erase(held);
    node.key() = mesh_key(set);
    move_vertices(node.mapped(), set);
    meshes_.insert(std::move(node));
    return true;
  });
  // Bent triangles show what they showed: that is not worked out again.
  std::vector<std::vector<Face>> shown;
  for (const TextureSet& set : change.meshes) {
    const auto same = std::find_if(meshes_.begin(), meshes_.end(),
                                   [&](const auto& held) { return same_faces(held.first, mesh_key(set)); });
    shown.push_back(same != meshes_.end() ? same->second.faces : std::vector<Face>{});
  }
  for (const MeshKey& key : change.released_meshes) meshes_.erase(key);
  for (const TextureKey key : change.released_textures) textures_.erase(key);
  for (std::size_t k = 0; k < change.meshes.size(); ++k)
    meshes_.emplace(mesh_key(change.meshes[k]), upload(change.meshes[k], std::move(shown[k])));
  for (const auto& texture : change.textures) textures_.emplace(texture.get(), upload(texture));
}

}  // namespace rebake
