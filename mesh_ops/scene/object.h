#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "mesh_ops/mesh/soup.h"
#include "mesh_ops/texture/decoder.h"
#include "mesh_ops/texture/texels.h"

namespace rebake {

/// How a MobileNeRF folder names and cuts its files (format.md, "Files of one scene").
enum class Layout { split, chunked, unsplit };

/// Triangles and the texels that their UVs point into.
struct TextureSet {
  Soup soup;
  std::shared_ptr<const FeatureTexture> texels;
};

/// A file that an object was read from, to copy it unchanged later.
struct SourceFile {
  std::string name;
  std::uint64_t size = 0;
  std::uint64_t hash = 0;  ///< XXH64 of the bytes
  bool operator==(const SourceFile&) const = default;
};

/// Where an object was read from, and which of its parts are still what the files hold.
struct Origin {
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
  Layout layout = Layout::split;
  std::vector<Set> sets;
  SourceFile mlp;
  int obj_num = 0;  ///< as mlp.json says it; 0: it does not
  std::shared_ptr<const Decoder> decoder;
  /// Sentences on what the folder left open and reading assumed.
  std::vector<std::string> assumptions = {};
};

/// A flag for each triangle of an object, numbered through its sets in order.
using TriangleSet = std::vector<std::uint8_t>;

struct BakedObject;
/// What an object was when its light was baked, edits undone: what it shaded itself with.
struct BakedBody {
  std::shared_ptr<const BakedObject> object;
  Affine to_object = Affine::Identity();  ///< from its own space into that of the object made of it
};

/// One baked scene: texture sets that share a decoder. Immutable once made; nodes share it.
struct BakedObject {
  std::vector<TextureSet> sets;
  std::shared_ptr<const Decoder> decoder;
  Axes axes = Axes::y_up;
  Layout layout = Layout::split;
  std::shared_ptr<const Origin> origin;  ///< null for objects that were not read from a folder
  /// Members of mlp.json that the format does not know, which exports keep: key → JSON as it was spelt.
  std::map<std::string, std::string> other_members = {};
  /// What it was made of by edits that move, remove or erase triangles; empty: it is as its light was baked.
  std::vector<BakedBody> bodies;
  /// The face attribute with the number of a face's body (std::uint16_t).
  static constexpr const char* body = "body";

  std::size_t triangle_count() const;
  std::size_t vertex_count() const;
  std::uint64_t opaque_texel_count() const;
  Box bounds() const;
  bool any_rotations() const;
  std::uint64_t memory() const;
};

/// The object's bodies; of one that is as its light was baked, itself.
std::vector<BakedBody> bodies_of(const BakedObject& object);
/// To be called of what is made of an object by moving, removing or erasing triangles: it knows its bodies then.
void keep_bodies(BakedObject& made, const BakedObject& of);
/// The same triangles at the same places.
bool same_body(const BakedBody& a, const BakedBody& b);
/// Whether both are still what was read from one folder, whose files were the same both times.
bool same_reading(const BakedObject& a, const BakedObject& b);

std::size_t count(const TriangleSet& triangles);

}  // namespace rebake
