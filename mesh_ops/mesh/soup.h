#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "mesh_ops/base/packed_rotation.h"
#include "mesh_ops/base/types.h"
#include "mesh_ops/mesh/attributes.h"

namespace rebake {

/// Triangles of one texture set: an unwelded, non-manifold triangle soup. Immutable; each array is shared separately,
/// so an edit that moves vertices shares the UVs and faces with the previous scene.
class Soup {
 public:
  using Positions = std::shared_ptr<const std::vector<Vec3>>;
  using Uvs = std::shared_ptr<const std::vector<Vec2>>;
  using Faces = std::shared_ptr<const std::vector<Face>>;

  Soup();
  /// Name of the vertex attribute for rotations: the orthogonal matrix by which edits rotated a vertex relative to its
  /// object (type PackedRotation).
  static constexpr const char* rotation = "rotation";
  /// Name of the vertex attribute for displacements: how far edits moved a vertex since its light was baked (type
  /// Eigen::Vector3f, object space).
  static constexpr const char* displacement = "displacement";

  /// Positions in object space, one UV per position, v up. Throws std::invalid_argument if a face index is out of
  /// range, or an array or attribute has the wrong size.
  Soup(Positions positions, Uvs uvs, Faces faces, Attributes vertex_attributes = {}, Attributes face_attributes = {});
  Soup(std::vector<Vec3> positions, std::vector<Vec2> uvs, std::vector<Face> faces);

  const std::vector<Vec3>& positions() const { return *positions_; }
  const std::vector<Vec2>& uvs() const { return *uvs_; }
  const std::vector<Face>& faces() const { return *faces_; }
  /// Rotation per vertex; null if no vertex was rotated.
  const std::vector<PackedRotation>* rotations() const { return rotations_; }
  const Attributes& vertex_attributes() const { return vertex_attributes_; }
  const Attributes& face_attributes() const { return face_attributes_; }
  /// A copy with other face attributes.
  Soup with_face_attributes(Attributes attributes) const;
  /// A copy with other displacements of the vertices; null removes them.
  Soup with_displacement(Attributes::Shared displaced) const;

  const Positions& shared_positions() const { return positions_; }
  const Uvs& shared_uvs() const { return uvs_; }
  const Faces& shared_faces() const { return faces_; }

  /// Records the soup that this one is a subset of, so that united() can restore it. Null for a whole soup, and after
  /// vertices were moved.
  struct Lineage;
  const std::shared_ptr<const Lineage>& lineage() const { return lineage_; }

  std::size_t triangle_count() const { return faces_->size(); }
  /// Bounding box of the vertices used by faces; empty without faces.
  const Box& bounds() const { return bounds_; }

 private:
  friend Soup subset(const Soup& soup, const std::vector<std::uint8_t>& keep, std::size_t first_flag, bool wanted);

  Positions positions_;
  Uvs uvs_;
  Faces faces_;
  Attributes vertex_attributes_;
  Attributes face_attributes_;
  const std::vector<PackedRotation>* rotations_ = nullptr;  ///< points into vertex_attributes_; null if absent
  Box bounds_;
  std::shared_ptr<const Lineage> lineage_;
};

struct Soup::Lineage {
  Soup whole;
  std::vector<std::uint32_t> faces;  ///< per face: its number in `whole`
};

/// Faces whose flag keep[first_flag + face] equals `wanted`, with the vertices that they use; preserves the order.
Soup subset(const Soup& soup, const std::vector<std::uint8_t>& keep, std::size_t first_flag, bool wanted);

/// Union of two soups. Disjoint subsets of one soup become its subset again (the soup itself, bit for bit, if
/// complete); other soups are concatenated.
Soup united(const Soup& a, const Soup& b);
/// Per face of united(a, b): its number among the faces of a followed by those of b.
std::vector<std::uint32_t> faces_of_united(const Soup& a, const Soup& b);

/// Calls `change` once for each vertex of the faces with a non-zero flags[first_flag + face], to set its position and
/// rotation. Also updates displacements. Changed vertices that other faces share are split. Returns `soup` if nothing
/// changes.
Soup change_vertices(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag,
                     const std::function<void(std::uint32_t vertex, Vec3& position, Mat3& rotation)>& change);

/// Applies `motion` to the flagged faces, and `turn` (orthogonal, object space) to their rotations. Vertices shared by
/// moved and unmoved faces are split.
Soup move_faces(const Soup& soup, const std::vector<std::uint8_t>& flags, std::size_t first_flag, const Affine& motion,
                const Mat3& turn);

}  // namespace rebake
