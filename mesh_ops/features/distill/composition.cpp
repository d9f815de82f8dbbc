#include "mesh_ops/features/distill/composition.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/polar.h"
#include "mesh_ops/features/atlas/rotation_groups.h"
#include "mesh_ops/features/distill/diffuse_network.h"
#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

constexpr const char* part_attribute = "part";
// Vertex attribute: position in the part's light chart, as LightChart::places.
constexpr const char* light_attribute = "light place";

// Frobenius distance of two rotations (about 10°) above which triangles need separate copies of their texels.
constexpr double separate_rotation = 0.25;

// The flagged triangles of a set in world space, with their part number and, if lit, their places in the light chart.
TextureSet in_world(const TextureSet& set, const TriangleSet& flags, const Affine& to_world, const Mat3& node_turn,
                    bool bent, std::uint32_t part, const LightMap* light) {
  Soup whole = set.soup;
  if (light != nullptr)
    whole = Soup(
        whole.shared_positions(), whole.shared_uvs(), whole.shared_faces(),
        whole.vertex_attributes().with(light_attribute, Values<Eigen::Vector2f>::of(std::vector(light->chart->places))),
        whole.face_attributes());
  const Soup some = subset(whole, flags, 0, true);
  auto positions = std::make_shared<std::vector<Vec3>>(some.positions());
  for (Vec3& p : *positions) p = to_world * p;
  Attributes vertices;
  if (bent) {
    std::vector<PackedRotation> turns(positions->size());
    for (std::size_t v = 0; v < turns.size(); ++v)
      turns[v] = PackedRotation(node_turn * (*some.rotations())[v].matrix() * node_turn.transpose());
    vertices = vertices.with(Soup::rotation, Values<PackedRotation>::of(std::move(turns)));
  }
  if (light != nullptr) vertices = vertices.with(light_attribute, some.vertex_attributes().shared(light_attribute));
  const Attributes faces = Attributes().with(
      part_attribute, Values<std::uint32_t>::of(std::vector<std::uint32_t>(some.triangle_count(), part)));
  return {Soup(std::move(positions), some.shared_uvs(), some.shared_faces(), std::move(vertices), faces), set.texels};
}

Mat3 turn_of(const Soup& soup, std::uint32_t vertex) {
  return soup.rotations() == nullptr ? Mat3(Mat3::Identity()) : (*soup.rotations())[vertex].matrix();
}

// Splits a set so that no texel is used by triangles whose rotations differ by more than separate_rotation.
std::vector<TextureSet> split_by_rotation(const TextureSet& set) {
  if (set.soup.rotations() == nullptr) return {set};
  const auto& faces = set.soup.faces();
  const TexelPatches patches = texel_patches(set);
  std::vector<std::vector<Mat3>> turns(patches.rects.size());
  std::vector<std::size_t> cluster(faces.size());
  std::size_t most = 1;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    std::vector<Mat3>& known = turns[patches.of_face[f]];
    const Mat3 mean =
        (turn_of(set.soup, faces[f][0]) + turn_of(set.soup, faces[f][1]) + turn_of(set.soup, faces[f][2])) / 3;
    std::size_t k = 0;
    while (k < known.size() && (known[k] - mean).norm() > separate_rotation) ++k;
    if (k == known.size()) known.push_back(mean);
    cluster[f] = k;
    most = std::max(most, known.size());
  }
  if (most == 1) return {set};
  std::vector<TextureSet> result;
  for (std::size_t k = 0; k < most; ++k) {
    TriangleSet flags(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) flags[f] = cluster[f] == k ? 1 : 0;
    result.push_back({subset(set.soup, flags, 0, true), set.texels});
  }
  return result;
}

std::uint32_t part_of(const TextureSet& page, std::size_t face) {
  const auto* parts = page.soup.face_attributes().find<std::uint32_t>(part_attribute);
  return parts == nullptr ? 0 : (*parts)[face];
}

// Mean rotation of a teacher's triangles; the identity if one of its parts is not bent.
Mat3 frame_of(const Composition& composition, const std::vector<TextureSet>& sets, std::size_t teacher) {
  Mat3 sum = Mat3::Zero();
  for (const TextureSet& set : sets) {
    const Composition::Part& part = composition.parts[part_of(set, 0)];
    if (part.teacher != teacher) continue;
    if (!part.bent) return Mat3::Identity();
    for (std::uint32_t v = 0; v < set.soup.positions().size(); ++v) sum += turn_of(set.soup, v);
  }
  return local_rotation(sum).rotation;
}

// The texels within a rectangle that nearest sampling on a face may read: its bounding box with a margin of one texel.
TexelRect near_texels(const std::array<Vec2, 3>& corners, const TexelRect& within) {
  const Vec2 low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]).array() - 1,
             high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]).array() + 1;
  const auto texel = [](double at, int least, int most) {
    return std::clamp(static_cast<int>(std::floor(at)), least, most);
  };
  return {texel(low.x(), within.left, within.right), texel(low.y(), within.top, within.bottom),
          texel(high.x(), within.left, within.right), texel(high.y(), within.top, within.bottom)};
}

std::uint32_t opaque_texels_in(const FeatureTexture& texels, const TexelRect& rect) {
  std::uint32_t opaque = 0;
  for (int y = rect.top; y <= rect.bottom; ++y)
    for (int x = rect.left; x <= rect.right; ++x) opaque += texels.opaque(x, y) ? 1 : 0;
  return opaque;
}

void add_blocks(Composition& result, std::uint32_t number, const TexelPatches& patches) {
  const TextureSet& page = result.pages[number];
  constexpr int side = Composition::block_side;
  const auto columns = [](const TexelRect& rect) { return (rect.width() + side - 1) / side; };
  const std::size_t before = result.blocks.size();
  std::vector<std::size_t> first_block;  // per patch; its blocks are row-major
  for (const TexelRect& rect : patches.rects) {
    first_block.push_back(result.blocks.size());
    for (int top = rect.top; top <= rect.bottom; top += side)
      for (int left = rect.left; left <= rect.right; left += side)
        result.blocks.push_back(
            {number,
             0,
             {left, top, std::min(rect.right, left + side - 1), std::min(rect.bottom, top + side - 1)},
             0,
             0,
             0});
  }
  // Visits the blocks that a face may read: first to count them, then to list them.
  const auto for_each_block = [&](std::size_t face, auto&& visit) {
    const std::size_t patch = patches.of_face[face];
    const TexelRect& rect = patches.rects[patch];
    const TexelRect near = near_texels(texel_corners(page, face), rect);
    for (int row = (near.top - rect.top) / side; row <= (near.bottom - rect.top) / side; ++row)
      for (int column = (near.left - rect.left) / side; column <= (near.right - rect.left) / side; ++column)
        visit(result.blocks[first_block[patch] + static_cast<std::size_t>(row * columns(rect) + column)]);
  };
  const std::size_t faces = page.soup.triangle_count();
  for (std::size_t f = 0; f < faces; ++f) for_each_block(f, [](Composition::Block& block) { ++block.face_count; });
  auto place = static_cast<std::uint32_t>(result.faces.size());
  for (std::size_t b = before; b < result.blocks.size(); ++b) {
    result.blocks[b].first_face = place;
    place += result.blocks[b].face_count;
    result.blocks[b].face_count = 0;
  }
  result.faces.resize(place);
  for (std::size_t f = 0; f < faces; ++f)
    for_each_block(f, [&](Composition::Block& block) {
      if (block.face_count == 0) block.part = part_of(page, f);
      result.faces[block.first_face + block.face_count++] = static_cast<std::uint32_t>(f);
    });
  tbb::parallel_for(before, result.blocks.size(), [&](std::size_t b) {
    // Texels that no face reads are never visible.
    if (result.blocks[b].face_count > 0)
      result.blocks[b].opaque = opaque_texels_in(*page.texels, result.blocks[b].rect);
  });
}

}  // namespace

bool Composition::exact() const {
  return !recoded && teachers.size() == 1 && teachers.front()->rule == ColorRule::network &&
         std::none_of(parts.begin(), parts.end(), [](const Part& p) { return p.bent || p.light; });
}

namespace {

// Triangles of one set that belong to one part.
struct Piece {
  TextureSet set;
  TriangleSet flags;
  Affine to_world;
  Mat3 node_turn;
  std::uint32_t part;
};

std::size_t teacher_number(Composition& composition, std::shared_ptr<const Decoder> decoder) {
  for (std::size_t k = 0; k < composition.teachers.size(); ++k)
    if (nearly_equal(*composition.teachers[k], *decoder)) return k;
  composition.teachers.push_back(std::move(decoder));
  return composition.teachers.size() - 1;
}

// Adds the parts of a node, and their triangles to `pieces`.
void add_parts(Composition& composition, const PlacedNode& placed, const Lighting* lighting,
               std::vector<Piece>& pieces) {
  const BakedObject& object = *placed.node->object;
  Mat3 node_turn;
  try {
    node_turn = orthogonal_factor(placed.to_world.linear());
  } catch (const std::invalid_argument& error) {
    throw EditError(fmt::format("node \"{}\": {}", placed.node->name, error.what()));
  }
  composition.forward = composition.forward && object.axes == Axes::forward;
  const RotationGroups groups = rotation_groups(object);
  // Triangles with a light map form a separate part per texture set.
  std::map<std::pair<std::uint32_t, const LightMap*>, std::uint32_t> part_of_group;
  std::size_t first = 0;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const TextureSet& set = object.sets[s];
    const std::shared_ptr<const LightMap> light =
        lighting != nullptr ? lighting->map_of(placed.node->id, s, set) : nullptr;
    const std::size_t faces = set.soup.triangle_count();
    std::map<std::uint32_t, TriangleSet> flags;
    for (std::size_t f = 0; f < faces; ++f) {
      TriangleSet& some = flags[groups.group_of[first + f]];
      some.resize(faces);
      some[f] = 1;
    }
    first += faces;
    for (auto& [group, some] : flags) {
      const bool bent = group == RotationGroups::bent;
      const auto [it, fresh] =
          part_of_group.try_emplace({group, light.get()}, static_cast<std::uint32_t>(composition.parts.size()));
      if (fresh) {
        const Mat3 turn = bent ? node_turn : Mat3(node_turn * groups.groups[group].turn);
        const std::size_t teacher = teacher_number(
            composition,
            std::make_shared<const Decoder>(fold_rotation(*object.decoder, turn, object.axes, Axes::forward)));
        composition.parts.push_back({placed.node->id, placed.node->name, teacher, bent, 0, false, light,
                                     turn.transpose(), node_turn.transpose()});
      }
      Composition::Part& part = composition.parts[it->second];
      part.triangles += count(some);
      part.plain_alpha = part.plain_alpha || set.texels->alpha_code() == AlphaCode::plain;
      pieces.push_back({set, std::move(some), placed.to_world, node_turn, it->second});
    }
  }
}

// The pieces in world space, joined where they share texels.
std::vector<TextureSet> joined_sets(const Composition& composition, const std::vector<Piece>& pieces) {
  std::vector<TextureSet> sets;
  std::map<std::pair<const FeatureTexture*, std::size_t>, std::size_t> shared;
  for (const Piece& piece : pieces) {
    const Composition::Part& part = composition.parts[piece.part];
    if (!can_pack(piece.set))
      throw EditError(fmt::format(
          "node \"{}\": some UVs are outside 0 … 1, so its texels cannot be repacked into one folder", part.name));
    const TextureSet whole =
        in_world(piece.set, piece.flags, piece.to_world, piece.node_turn, part.bent, piece.part, part.light.get());
    if (part.light && !part.bent) {
      sets.push_back(whole);
    } else if (!part.bent) {
      // Copies of an object that use the same decoder share their texels.
      const auto [it, fresh] = shared.try_emplace({whole.texels.get(), part.teacher}, sets.size());
      if (fresh)
        sets.push_back(whole);
      else
        sets[it->second].soup = united(sets[it->second].soup, whole.soup);
    } else {
      for (TextureSet& apart : split_by_rotation(whole)) sets.push_back(std::move(apart));
    }
  }
  return sets;
}

}  // namespace

Composition composed(const Scene& scene, int largest_side, const Progress& progress, const Lighting* lighting) {
  Composition result;
  result.forward = true;
  std::vector<Piece> pieces;
  std::vector<std::string> recoded;
  const Scene networks = with_networks(scene, &recoded);
  result.recoded = !recoded.empty();
  for (const PlacedNode& placed : placed_nodes(networks)) {
    if (!placed.visible || !placed.node->object || placed.node->object->triangle_count() == 0) continue;
    progress.at("decomposing the scene", 0);
    add_parts(result, placed, lighting, pieces);
  }
  if (pieces.empty()) throw EditError("nothing to export: no visible node has triangles");
  if (std::none_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.set.texels->opaque_count() > 0; }))
    throw EditError("nothing to export: no visible triangle has an opaque texel");
  if (result.exact()) return result;

  std::vector<TextureSet> sets = joined_sets(result, pieces);
  pieces.clear();
  for (std::size_t k = 0; k < result.teachers.size(); ++k) result.frames.push_back(frame_of(result, sets, k));
  progress.at("decomposing the scene", 0.2);
  PackedSets packed = pack(sets, largest_side, AlphaCode::plain);
  result.pages = std::move(packed.sets);
  sets.clear();
  for (std::uint32_t page = 0; page < result.pages.size(); ++page) {
    progress.at("decomposing the scene", 0.6 + 0.4 * page / static_cast<double>(result.pages.size()));
    add_blocks(result, page, packed.patches[page]);
  }
  std::erase_if(result.blocks, [](const Composition::Block& block) { return block.opaque == 0; });
  if (result.blocks.empty()) throw EditError("nothing to export: no visible triangle has an opaque texel");
  for (const Composition::Block& block : result.blocks) result.opaque_texels += block.opaque;
  return result;
}

std::vector<TexelSite> sites_of(const Composition& composition, const Composition::Block& block) {
  const TextureSet& page = composition.pages[block.page];
  const TexelRect& rect = block.rect;
  const int width = rect.width(), height = rect.height();
  // Per texel: the triangle that contains its centre, else the nearest one, because nearest sampling may read texels
  // whose centre is half a texel outside.
  constexpr auto none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> face_at(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), none);
  std::vector<double> outside(face_at.size(), std::numeric_limits<double>::infinity());
  for (std::uint32_t k = 0; k < block.face_count; ++k) {
    const std::uint32_t face = composition.faces[block.first_face + k];
    const std::array<Vec2, 3> corners = texel_corners(page, face);
    const TexelRect near = near_texels(corners, rect);
    for (int y = near.top; y <= near.bottom; ++y)
      for (int x = near.left; x <= near.right; ++x) {
        const auto at = static_cast<std::size_t>((y - rect.top) * width + x - rect.left);
        const Vec3 weights = barycentric(corners, {x + 0.5, y + 0.5});
        const double beyond = std::max(0.0, -weights.minCoeff());
        if (beyond < outside[at]) {
          outside[at] = beyond;
          face_at[at] = face;
        }
      }
  }
  std::vector<TexelSite> sites;
  sites.reserve(block.opaque);
  const bool bent = composition.parts[block.part].bent;
  const LightMap* light = composition.parts[block.part].light.get();
  const auto* light_places = page.soup.vertex_attributes().find<Eigen::Vector2f>(light_attribute);
  const auto add = [&](int x, int y) {
    const std::uint32_t number = face_at[static_cast<std::size_t>((y - rect.top) * width + x - rect.left)];
    if (number == none || !page.texels->opaque(x, y)) return;
    const Face& face = page.soup.faces()[number];
    Vec3 weights = barycentric(texel_corners(page, number), {x + 0.5, y + 0.5}).cwiseMax(0.0);
    weights /= weights.sum();
    const auto& p = page.soup.positions();
    TexelSite site{x, y, Vec3::Zero(), (p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).stableNormalized(),
                   Mat3::Identity()};
    for (std::size_t k = 0; k < 3; ++k) site.position += weights[static_cast<Eigen::Index>(k)] * p[face[k]];
    if (bent) {
      site.turn.setZero();
      for (std::size_t k = 0; k < 3; ++k)
        site.turn += weights[static_cast<Eigen::Index>(k)] * turn_of(page.soup, face[k]).transpose();
    }
    if (light != nullptr) {
      Eigen::Vector2f place = Eigen::Vector2f::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        place += static_cast<float>(weights[static_cast<Eigen::Index>(k)]) * (*light_places)[face[k]];
      site.gain = interpolated(*light->chart, light->gain, place);
      if (!light->offset.empty()) site.offset = interpolated(*light->chart, light->offset, place);
      if (light->gloss) site.gloss = interpolated(*light->chart, *light->gloss, place);
    }
    sites.push_back(site);
  };
  for (int y = rect.top; y <= rect.bottom; y += 2)
    for (int x = rect.left; x <= rect.right; ++x) {
      add(x, y);
      if (y < rect.bottom) add(x, y + 1);
    }
  return sites;
}

}  // namespace rebake
