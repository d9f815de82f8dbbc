#include "mesh_ops/mesh/soup.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include "mesh_ops/base/polar.h"

namespace rebake {

namespace {

constexpr std::uint32_t unused = std::numeric_limits<std::uint32_t>::max();

}  // namespace

Soup::Soup() : Soup(std::vector<Vec3>{}, std::vector<Vec2>{}, std::vector<Face>{}) {}

Soup::Soup(Positions positions, Uvs uvs, Faces faces, Attributes vertex_attributes, Attributes face_attributes)
    : positions_(std::move(positions)),
      uvs_(std::move(uvs)),
      faces_(std::move(faces)),
      vertex_attributes_(std::move(vertex_attributes)),
      face_attributes_(std::move(face_attributes)),
      rotations_(vertex_attributes_.find<PackedRotation>(rotation)) {
  const std::size_t count = positions_->size();
  if (uvs_->size() != count) throw std::invalid_argument("a soup needs as many UVs as positions");
  for (const auto& [name, attribute] : vertex_attributes_)
    if (attribute->size() != count) throw std::invalid_argument("a soup needs one " + name + " per vertex");
  for (const auto& [name, attribute] : face_attributes_)
    if (attribute->size() != faces_->size()) throw std::invalid_argument("a soup needs one " + name + " per face");
  for (const Face& face : *faces_) {
    for (const std::uint32_t vertex : face) {
      if (vertex >= count) throw std::invalid_argument("a face has a vertex index out of range");
      bounds_.extend((*positions_)[vertex]);
    }
  }
}

Soup::Soup(std::vector<Vec3> positions, std::vector<Vec2> uvs, std::vector<Face> faces)
    : Soup(std::make_shared<const std::vector<Vec3>>(std::move(positions)),
           std::make_shared<const std::vector<Vec2>>(std::move(uvs)),
           std::make_shared<const std::vector<Face>>(std::move(faces))) {}

Soup Soup::with_face_attributes(Attributes attributes) const {
  Soup result(positions_, uvs_, faces_, vertex_attributes_, std::move(attributes));
  result.lineage_ = lineage_;
  return result;
}

Soup Soup::with_displacement(Attributes::Shared displaced) const {
  Soup result(positions_, uvs_, faces_, vertex_attributes_.with(displacement, std::move(displaced)), face_attributes_);
  result.lineage_ = lineage_;
  return result;
}

Soup subset(const Soup& soup, const std::vector<std::uint8_t>& keep, std::size_t first_flag, bool wanted) {
  std::vector<std::uint8_t> used(soup.positions().size(), 0);
  std::vector<Face> faces;
  std::vector<std::uint32_t> kept_faces, kept_vertices;
  auto lineage = std::make_shared<Soup::Lineage>();
  lineage->whole = soup.lineage() ? soup.lineage()->whole : soup;
  for (std::uint32_t f = 0; f < soup.faces().size(); ++f) {
    if ((keep[first_flag + f] != 0) != wanted) continue;
    faces.push_back(soup.faces()[f]);
    kept_faces.push_back(f);
    lineage->faces.push_back(soup.lineage() ? soup.lineage()->faces[f] : f);
    for (const std::uint32_t vertex : soup.faces()[f]) used[vertex] = 1;
  }
  std::vector<std::uint32_t> renumbered(soup.positions().size(), unused);
  auto positions = std::make_shared<std::vector<Vec3>>();
  auto uvs = std::make_shared<std::vector<Vec2>>();
  for (std::uint32_t v = 0; v < used.size(); ++v) {
    if (used[v] == 0) continue;
    renumbered[v] = static_cast<std::uint32_t>(positions->size());
    positions->push_back(soup.positions()[v]);
    uvs->push_back(soup.uvs()[v]);
    kept_vertices.push_back(v);
  }
  for (Face& face : faces)
    for (std::uint32_t& vertex : face) vertex = renumbered[vertex];
  Soup result(positions, uvs, std::make_shared<const std::vector<Face>>(std::move(faces)),
              soup.vertex_attributes().picked(kept_vertices), soup.face_attributes().picked(kept_faces));
  result.lineage_ = std::move(lineage);
  return result;
}

namespace {

// Union of disjoint subsets of one soup; nullopt for any other two soups.
std::optional<Soup> reunited(const Soup& a, const Soup& b) {
  if (!a.lineage() || !b.lineage()) return std::nullopt;
  const Soup& whole = a.lineage()->whole;
  if (whole.shared_faces() != b.lineage()->whole.shared_faces() ||
      whole.shared_positions() != b.lineage()->whole.shared_positions() ||
      whole.shared_uvs() != b.lineage()->whole.shared_uvs() ||
      whole.vertex_attributes() != b.lineage()->whole.vertex_attributes() ||
      whole.face_attributes() != b.lineage()->whole.face_attributes())
    return std::nullopt;
  std::vector<std::uint8_t> flags(whole.triangle_count(), 0);
  for (const Soup* part : {&a, &b})
    for (const std::uint32_t face : part->lineage()->faces)
      if (std::exchange(flags[face], std::uint8_t{1}) != 0) return std::nullopt;
  if (a.triangle_count() + b.triangle_count() == whole.triangle_count()) return whole;
  return subset(whole, flags, 0, true);
}

}  // namespace

std::vector<std::uint32_t> faces_of_united(const Soup& a, const Soup& b) {
  std::vector<std::uint32_t> order(a.triangle_count() + b.triangle_count());
  std::iota(order.begin(), order.end(), 0U);
  if (!reunited(a, b)) return order;
  const auto whole_face = [&](std::uint32_t f) {
    const auto in_a = static_cast<std::uint32_t>(a.triangle_count());
    return f < in_a ? a.lineage()->faces[f] : b.lineage()->faces[f - in_a];
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t f, std::uint32_t g) { return whole_face(f) < whole_face(g); });
  return order;
}

Soup united(const Soup& a, const Soup& b) {
  if (auto whole = reunited(a, b)) {
    // Edits of the parts may have changed values per face, such as the numbers of bodies.
    const Attributes faces = a.face_attributes()
                                 .followed_by(a.faces().size(), b.face_attributes(), b.faces().size())
                                 .picked(faces_of_united(a, b));
    return whole->face_attributes().has_values(faces) ? std::move(*whole) : whole->with_face_attributes(faces);
  }
  auto positions = std::make_shared<std::vector<Vec3>>(a.positions());
  auto uvs = std::make_shared<std::vector<Vec2>>(a.uvs());
  auto faces = std::make_shared<std::vector<Face>>(a.faces());
  const auto base = static_cast<std::uint32_t>(positions->size());
  positions->insert(positions->end(), b.positions().begin(), b.positions().end());
  uvs->insert(uvs->end(), b.uvs().begin(), b.uvs().end());
  for (const Face& face : b.faces()) faces->push_back({face[0] + base, face[1] + base, face[2] + base});
  return Soup(positions, uvs, faces,
              a.vertex_attributes().followed_by(a.positions().size(), b.vertex_attributes(), b.positions().size()),
              a.face_attributes().followed_by(a.faces().size(), b.face_attributes(), b.faces().size()));
}

Soup change_vertices(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag,
                     const std::function<void(std::uint32_t, Vec3&, Mat3&)>& change) {
  std::vector<std::uint8_t> by_changed(soup.positions().size(), 0);
  std::vector<std::uint8_t> by_others(soup.positions().size(), 0);
  for (std::size_t f = 0; f < soup.faces().size(); ++f)
    for (const std::uint32_t vertex : soup.faces()[f])
      (flags[first_flag + f] != 0 ? by_changed : by_others)[vertex] = 1;

  auto positions = std::make_shared<std::vector<Vec3>>(soup.positions());
  auto uvs = std::make_shared<std::vector<Vec2>>(soup.uvs());
  std::vector<PackedRotation> rotations =
      soup.rotations() != nullptr ? *soup.rotations() : std::vector<PackedRotation>(positions->size());

  const auto* displaced_before = soup.vertex_attributes().find<Eigen::Vector3f>(Soup::displacement);
  std::vector<Eigen::Vector3f> displacements =
      displaced_before != nullptr ? *displaced_before
                                  : std::vector<Eigen::Vector3f>(positions->size(), Eigen::Vector3f::Zero());

  bool any_position = false, any_rotation = false;
  std::vector<std::uint32_t> changed_vertex(soup.positions().size(), unused), old_vertex(soup.positions().size());
  std::iota(old_vertex.begin(), old_vertex.end(), 0U);
  for (std::uint32_t v = 0; v < by_changed.size(); ++v) {
    if (by_changed[v] == 0) continue;
    changed_vertex[v] = v;
    Vec3 position = soup.positions()[v];
    const Mat3 rotation_before = rotations[v].matrix();
    Mat3 rotation = rotation_before;
    change(v, position, rotation);
    const bool moves = position != soup.positions()[v], rotates = rotation != rotation_before;
    const PackedRotation turn = rotates ? PackedRotation(rotation) : rotations[v];
    if (!moves && !rotates) continue;
    any_position = any_position || moves;
    any_rotation = any_rotation || rotates;
    const Eigen::Vector3f displacement = displacements[v] + (position - soup.positions()[v]).cast<float>();
    if (by_others[v] != 0) {
      changed_vertex[v] = static_cast<std::uint32_t>(positions->size());
      old_vertex.push_back(v);
      positions->push_back(position);
      uvs->push_back(soup.uvs()[v]);
      rotations.push_back(turn);
      displacements.push_back(displacement);
    } else {
      (*positions)[v] = position;
      rotations[v] = turn;
      displacements[v] = displacement;
    }
  }
  if (!any_position && !any_rotation) return soup;
  const bool split = positions->size() != soup.positions().size();
  auto faces = std::make_shared<std::vector<Face>>(soup.faces());
  if (split)
    for (std::size_t f = 0; f < faces->size(); ++f)
      if (flags[first_flag + f] != 0)
        for (std::uint32_t& vertex : (*faces)[f]) vertex = changed_vertex[vertex];
  const Attributes attributes = split ? soup.vertex_attributes().picked(old_vertex) : soup.vertex_attributes();
  return Soup(any_position || split ? Soup::Positions(positions) : soup.shared_positions(),
              split ? Soup::Uvs(uvs) : soup.shared_uvs(), split ? Soup::Faces(faces) : soup.shared_faces(),
              attributes.with(Soup::rotation, Values<PackedRotation>::of(std::move(rotations)))
                  .with(Soup::displacement, Values<Eigen::Vector3f>::of(std::move(displacements))),
              soup.face_attributes());
}

Soup move_faces(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag, const Affine& motion,
                const Mat3& turn) {
  return change_vertices(soup, flags, first_flag, [&](std::uint32_t, Vec3& position, Mat3& vertex_turn) {
    position = motion * position;
    vertex_turn = orthogonal_factor(turn * vertex_turn);
  });
}

}  // namespace rebake
