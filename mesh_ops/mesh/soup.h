#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/base/turn.h"
#include "mesh_ops/base/types.h"
#include "mesh_ops/mesh/attributes.h"

namespace rebake {

/// The triangles of one texture set: an unwelded, non-manifold soup. Immutable; each array is shared on its own, so an
/// edit that moves vertices keeps the UVs and faces of the scene before.
class Soup {
 public:
  using Positions = std::shared_ptr<const std::vector<Vec3>>;
  using Uvs = std::shared_ptr<const std::vector<Vec2>>;
  using Faces = std::shared_ptr<const std::vector<Face>>;

  Soup();
  /// The vertex attribute that is the rotation field: by which orthogonal matrix an edit turned each vertex against its
  /// object (Turn).
  static constexpr const char* rotation = "rotation";
  /// The vertex attribute that says how far edits moved each vertex from where it was when its light was baked
  /// (Eigen::Vector3f, object space).
  static constexpr const char* displacement = "displacement";

  /// Positions in object space, UVs with v up, one of each a vertex. Faces must be in range, and attributes as many as
  /// vertices and faces (std::invalid_argument).
  Soup(Positions positions, Uvs uvs, Faces faces, Attributes vertex_attributes = {}, Attributes face_attributes = {});
  Soup(std::vector<Vec3> positions, std::vector<Vec2> uvs, std::vector<Face> faces);

  const std::vector<Vec3>& positions() const { return *positions_; }
  const std::vector<Vec2>& uvs() const { return *uvs_; }
  const std::vector<Face>& faces() const { return *faces_; }
  /// Null where nothing was turned.
  const std::vector<Turn>* rotations() const { return rotations_; }
  const Attributes& vertex_attributes() const { return vertex_attributes_; }
  const Attributes& face_attributes() const { return face_attributes_; }
  /// With other attributes of the faces.
  Soup with_face_attributes(Attributes attributes) const;
  /// With another displacement of the vertices; null for none.
  Soup with_displacement(Attributes::Shared displaced) const;

  const Positions& shared_positions() const { return positions_; }
  const Uvs& shared_uvs() const { return uvs_; }
  const Faces& shared_faces() const { return faces_; }

  /// Of which soup this is a subset, so that parts can be put together again as they were; null for a whole soup and
  /// for one whose vertices were moved.
  struct Lineage;
  const std::shared_ptr<const Lineage>& lineage() const { return lineage_; }

  std::size_t triangle_count() const { return faces_->size(); }
  /// Box of the vertices that faces use; empty when there are no faces.
  const Box& bounds() const { return bounds_; }
  std::uint64_t memory() const;

 private:
  friend Soup subset(const Soup& soup, const std::vector<std::uint8_t>& keep, std::size_t first_flag, bool wanted);

  Positions positions_;
  Uvs uvs_;
  Faces faces_;
  Attributes vertex_attributes_;
  Attributes face_attributes_;
  const std::vector<Turn>* rotations_ = nullptr;  ///< one of vertex_attributes_
  Box bounds_;
  std::shared_ptr<const Lineage> lineage_;
};

struct Soup::Lineage {
  Soup whole;
  std::vector<std::uint32_t> faces;  ///< number in `whole` of each face
};

/// The faces whose `keep` flag (one a face) is `wanted`, with the vertices they use, in the old order.
Soup subset(const Soup& soup, const std::vector<std::uint8_t>& keep, std::size_t first_flag, bool wanted);

/// Both soups as one. Parts of one soup without a common face become its subset again (the soup itself when all faces
/// are there, bit for bit); others are put one after the other.
Soup united(const Soup& a, const Soup& b);
/// Which face each one of united(a, b) was, counted through those of a and then those of b.
std::vector<std::uint32_t> faces_of_united(const Soup& a, const Soup& b);

/// Gives the flagged faces' vertices other positions and rotations: `change` is called once for each. Vertices that
/// change and are shared with other faces are split; where nothing changes, nothing does.
Soup change_vertices(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag,
                     const std::function<void(std::uint32_t vertex, Vec3& position, Mat3& rotation)>& change);

/// Moves the flagged faces by `motion`, recording `turn` (orthogonal, in object space) in their rotations.
/// Vertices shared by moved and unmoved faces are split.
Soup move_faces(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag, const Affine& motion,
                const Mat3& turn);

}  // namespace rebake
