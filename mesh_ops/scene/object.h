#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "mesh_ops/mesh/soup.h"
#include "mesh_ops/texture/decoder.h"
#include "mesh_ops/texture/texels.h"

namespace rebake {

/// File layout of a MobileNeRF folder (format.md, "Files of one scene").
enum class Layout {
  split,    ///< shape{i}.obj per texture set
  chunked,  ///< shape{i}_{j}.obj: several chunks per texture set
  unsplit   ///< shape.obj: one texture set
};

/// Differences of a MobileNeRF folder from the published format that its files do not reveal. Objects in memory have
/// the published form; reading converts to it, and exports convert back.
struct Dialect {
  bool half_direction = false;       ///< the decoder takes (d + 1) / 2 instead of the direction d
  bool direction_first = false;      ///< the decoder takes the direction before the features
  bool bgr = false;                  ///< the images' channels are blue, green, red, alpha
  std::optional<AlphaCode> alpha{};  ///< code of the alpha channels; nothing: that of the layout
  /// Texels whose red byte in feat0 is 0 are opaque. Reading makes it 1, which changes their first feature by 1/255;
  /// exports of edited textures keep the 1.
  bool no_holes = false;
  /// Textures are meant for linear filtering: reading makes them this many times as fine per side (linear_filter.h), an
  /// odd number from 3 on. 0: for nearest sampling.
  int linear = 0;
  bool operator==(const Dialect&) const = default;
};

/// A triangle soup and the feature texture that its UVs refer to.
struct TextureSet {
  Soup soup;
  std::shared_ptr<const FeatureTexture> texels;
};

/// A file that an object was read from, so that an export can copy it unchanged.
struct SourceFile {
  std::string name;        ///< empty: it needed repair, so exports write it instead of copying
  std::uint64_t size = 0;  ///< bytes
  std::uint64_t hash = 0;  ///< XXH64 of the bytes
  bool operator==(const SourceFile&) const = default;
};

/// Source folder of an object, and the arrays read from it, to recognise the parts that are unchanged.
struct Origin {
  /// Files and arrays of one texture set.
  struct Set {
    std::vector<SourceFile> geometry;  ///< shape{i}.obj, or its chunks in order
    SourceFile feat0;
    SourceFile feat1;
    std::weak_ptr<const std::vector<Vec3>> positions;
    std::weak_ptr<const std::vector<Vec2>> uvs;
    std::weak_ptr<const std::vector<Face>> faces;
    std::weak_ptr<const FeatureTexture> texels;
  };
  std::filesystem::path folder;
  std::string format = "mobilenerf";  ///< Format::name; only the writer of this format copies files
  Layout layout = Layout::split;
  Dialect dialect;  ///< of the files
  std::vector<Set> sets;
  SourceFile mlp;
  int obj_num = 0;  ///< value in mlp.json; 0 if absent
  std::shared_ptr<const Decoder> decoder;
  /// Sentences about missing information in the folder and the values assumed instead.
  std::vector<std::string> assumptions = {};
};

/// One flag per triangle of an object, numbered through its sets in order.
using TriangleSet = std::vector<std::uint8_t>;

struct BakedObject;
/// An object with its geometry as baked, before edits: it defines the occlusion in its baked colours.
struct BakedBody {
  std::shared_ptr<const BakedObject> object;
  Affine to_object = Affine::Identity();  ///< from the body's space to that of the object derived from it
};

/// One baked scene: texture sets that share a decoder. Immutable after creation, and shared by nodes.
struct BakedObject {
  std::vector<TextureSet> sets;
  std::shared_ptr<const Decoder> decoder;
  Axes axes = Axes::y_up;
  Layout layout = Layout::split;
  Dialect dialect;                       ///< in which exports write the object
  std::shared_ptr<const Origin> origin;  ///< null for objects that were not read from a folder
  /// Members of mlp.json that the format does not define, preserved by exports: key → JSON text.
  std::map<std::string, std::string> other_members = {};
  /// The bodies from which edits that move, remove or erase triangles derived this object; empty if its geometry is as
  /// baked.
  std::vector<BakedBody> bodies;
  /// Name of the face attribute for the number of a face's body (std::uint16_t).
  static constexpr const char* body = "body";

  std::size_t triangle_count() const;
  std::size_t vertex_count() const;
  std::uint64_t opaque_texel_count() const;
  Box bounds() const;
  bool any_rotations() const;    ///< whether edits rotated any vertex
  std::uint64_t memory() const;  ///< bytes; data shared by several sets count once
};

/// Sums over objects, in which data that several of them share count once.
class SharedTotals {
 public:
  void add(const BakedObject& object);
  std::uint64_t opaque_texels() const { return opaque_texels_; }  ///< of all textures
  std::uint64_t memory() const { return memory_; }                ///< bytes of geometry and texels

 private:
  std::set<const void*> seen_;
  std::set<std::tuple<const TexelTile*, int, int>> tiles_;  ///< with column and row
  std::uint64_t opaque_texels_ = 0, memory_ = 0;
};

/// The object's bodies; the object itself if its geometry is as baked.
std::vector<BakedBody> bodies_of(const BakedObject& object);
/// Records the bodies of `of` in `made`, unless it has some. Must be called for an object derived from another by
/// moving, removing or erasing triangles.
void record_bodies(BakedObject& made, const BakedObject& of);
/// Whether both have the same arrays and transform.
bool same_body(const BakedBody& a, const BakedBody& b);
/// Whether both are unchanged since they were read from the same folder with identical files.
bool same_source(const BakedObject& a, const BakedObject& b);

/// Number of flagged triangles.
std::size_t count(const TriangleSet& triangles);

}  // namespace rebake
