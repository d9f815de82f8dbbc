#pragma once

#include <cstdint>
#include <filesystem>
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
  std::shared_ptr<const Decoder> decoder;
};

/// A flag for each triangle of an object, numbered through its sets in order.
using TriangleSet = std::vector<std::uint8_t>;

/// One baked scene: texture sets that share a decoder. Immutable once made; nodes share it.
struct BakedObject {
  std::vector<TextureSet> sets;
  std::shared_ptr<const Decoder> decoder;
  Axes axes = Axes::y_up;
  Layout layout = Layout::split;
  std::shared_ptr<const Origin> origin;  ///< null for objects that were not read from a folder

  std::size_t triangle_count() const;
  std::size_t vertex_count() const;
  std::uint64_t opaque_texel_count() const;
  Box bounds() const;
  bool any_rotations() const;
  std::uint64_t memory() const;
};

std::size_t count(const TriangleSet& triangles);

}  // namespace rebake
