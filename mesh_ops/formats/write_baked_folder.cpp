#include "mesh_ops/formats/write_baked_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/features/atlas.h"
#include "mesh_ops/formats/baked_folder.h"
#include "mesh_ops/formats/baked_places_file.h"
#include "mesh_ops/formats/feature_png.h"
#include "mesh_ops/formats/mlp_json.h"
#include "mesh_ops/formats/obj.h"
#include "mesh_ops/formats/turns_file.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The source set whose texels (and, with `geometry`, triangles) a set still has.
const Origin::Set* source_set(const BakedObject& object, const TextureSet& set, bool geometry) {
  if (!object.origin) return nullptr;
  for (const Origin::Set& source : object.origin->sets) {
    if (source.texels.lock() != set.texels) continue;
    if (geometry && (source.positions.lock() != set.soup.shared_positions() ||
                     source.uvs.lock() != set.soup.shared_uvs() || source.faces.lock() != set.soup.shared_faces()))
      continue;
    return &source;
  }
  return nullptr;
}

// The bytes of a file that was read before, when they are still the same.
std::optional<std::string> unchanged_bytes(const Origin& origin, const SourceFile& file) {
  try {
    std::string bytes = read_file(origin.folder / file.name);
    if (bytes.size() == file.size && content_hash(bytes) == file.hash) return bytes;
  } catch (const FileError&) {
    // Moved or removed since: what is in memory is written instead.
  }
  return std::nullopt;
}

// A count for people: exact below a million.
std::string counted(std::uint64_t count) {
  return count < 1'000'000 ? fmt::format("{}", count) : fmt::format("{:.2f} million", static_cast<double>(count) / 1e6);
}

std::string sizes_of(const std::vector<TextureSet>& sets) {
  std::vector<std::string> sizes;
  for (const TextureSet& set : sets) sizes.push_back(fmt::format("{}×{}", set.texels->width(), set.texels->height()));
  return fmt::format("{}", fmt::join(sizes, ", "));
}

// The sets as they are written: untouched ones as they were read, edited ones laid out again when that saves texels.
std::vector<TextureSet> fitted(const BakedObject& object, Layout layout, bool all_texels, std::optional<int> page_side,
                               std::vector<std::string>& notes) {
  const AlphaCode code = layout == Layout::unsplit ? AlphaCode::plain : AlphaCode::halved;
  const BakedObject* const objects[] = {&object};
  const int largest = page_side.value_or(largest_page_side(layout, objects));
  const auto is_too_large = [&](const TextureSet& set) {
    return page_side && std::max(set.texels->width(), set.texels->height()) > largest;
  };
  if (code == AlphaCode::halved && std::any_of(object.sets.begin(), object.sets.end(),
                                               [&](const TextureSet& s) { return s.texels->alpha_code() != code; }))
    notes.emplace_back("features 3 and 7 lose their lowest bit: split folders store them halved");
  if (layout == Layout::unsplit && object.sets.size() > 1) {
    PackedSets packed = pack(object.sets, largest, code);
    if (packed.sets.size() > 1)
      throw Error(fmt::format("the texels do not fit into one texture of {}²: use --layout split", largest));
    return std::move(packed.sets);
  }
  // Sets that lost triangles give up the texels that nobody uses; sets as they were read are left alone.
  std::vector<TextureSet> kept, edited;
  std::uint64_t edited_area = 0;
  bool must_pack = false;
  for (const TextureSet& set : object.sets) {
    const TextureSet same_or_converted{set.soup, with_alpha_code(set.texels, code)};
    const Origin::Set* source = source_set(object, set, false);
    const bool same_faces = source != nullptr && source->faces.lock() == set.soup.shared_faces();
    if (!is_too_large(set) && (all_texels || same_faces || !can_pack(set))) {
      kept.push_back(same_or_converted);
    } else {
      must_pack = must_pack || is_too_large(set);
      edited_area += static_cast<std::uint64_t>(set.texels->width()) * static_cast<std::uint64_t>(set.texels->height());
      edited.push_back(same_or_converted);
    }
  }
  if (edited.empty()) return kept;
  PackedSets packed = pack(edited, largest, code);
  if (packed.texel_area < edited_area || must_pack) {
    notes.push_back(fmt::format(
        "edited texture sets were laid out again without unused texels: {} instead of {} texels "
        "({} → {}); {} untouched sets are as they were",
        counted(packed.texel_area), counted(edited_area), sizes_of(edited), sizes_of(packed.sets), kept.size()));
    edited = std::move(packed.sets);
  }
  kept.insert(kept.end(), edited.begin(), edited.end());
  return kept;
}

// Chunk viewers and the Unity importer fail on an empty chunk: it gets one triangle whose corners are one vertex, which
// renders nothing. read_baked_folder drops it again.
std::string placeholder_chunk(const Soup& soup) {
  const std::uint32_t vertex = soup.faces().front()[0];
  return write_obj({soup.positions()[vertex]}, {soup.uvs()[vertex]}, {Face{0, 0, 0}}, 0, 1);
}

std::vector<std::string> geometry_texts(const Soup& soup, Layout layout) {
  const std::size_t faces = soup.triangle_count();
  if (layout != Layout::chunked) return {write_obj(soup.positions(), soup.uvs(), soup.faces(), 0, faces)};
  std::vector<std::string> texts(chunks_a_set);
  tbb::parallel_for(std::size_t{0}, chunks_a_set, [&](std::size_t j) {
    const std::size_t first = faces * j / chunks_a_set, last = faces * (j + 1) / chunks_a_set;
    texts[j] =
        first == last ? placeholder_chunk(soup) : write_obj(soup.positions(), soup.uvs(), soup.faces(), first, last);
  });
  return texts;
}

}  // namespace

int largest_page_side(Layout layout, std::span<const BakedObject* const> objects) {
  int side = layout == Layout::unsplit ? 16384 : 4096;
  for (const BakedObject* object : objects)
    for (const TextureSet& set : object->sets) side = std::max({side, set.texels->width(), set.texels->height()});
  return side;
}

void write_baked_folder(AtomicFolder& out, const fs::path& folder, const BakedObject& object, Layout layout,
                        std::vector<std::string>& notes, const Progress& progress, bool baked_places,
                        std::optional<int> page_side) {
  if (object.triangle_count() == 0) throw Error("an object without triangles cannot be written");
  BakedObject filled = object;
  std::erase_if(filled.sets, [](const TextureSet& set) { return set.soup.triangle_count() == 0; });
  std::vector<TextureSet> sets = fitted(filled, layout, baked_places, page_side, notes);
  const bool same_layout = object.origin && object.origin->layout == layout;

  for (std::size_t i = 0; i < sets.size(); ++i) {
    const TextureSet& set = sets[i];
    progress.at("writing", static_cast<double>(i) / static_cast<double>(sets.size()));
    const Origin::Set* same_geometry = same_layout ? source_set(object, set, true) : nullptr;
    bool copied = false;
    if (same_geometry != nullptr) {
      std::vector<std::string> texts;
      for (const SourceFile& file : same_geometry->geometry)
        if (auto bytes = unchanged_bytes(*object.origin, file)) texts.push_back(std::move(*bytes));
      copied = !texts.empty() && texts.size() == same_geometry->geometry.size();
      const bool in_chunks = copied && same_geometry->geometry.front().name.find('_') != std::string::npos;
      if (copied)
        for (std::size_t j = 0; j < texts.size(); ++j)
          out.write(folder / geometry_name(in_chunks                   ? Layout::chunked
                                           : layout == Layout::chunked ? Layout::split
                                                                       : layout,
                                           i, j),
                    texts[j]);
    }
    if (!copied) {
      const std::vector<std::string> texts = geometry_texts(set.soup, layout);
      for (std::size_t j = 0; j < texts.size(); ++j) out.write(folder / geometry_name(layout, i, j), texts[j]);
    }
    const bool same_names = object.origin && (object.origin->layout == Layout::unsplit) == (layout == Layout::unsplit);
    const Origin::Set* same_texels = same_names ? source_set(object, set, false) : nullptr;
    std::string encoded[2];
    tbb::parallel_for(0, 2, [&](int image) {
      if (same_texels != nullptr)
        if (auto bytes = unchanged_bytes(*object.origin, image == 0 ? same_texels->feat0 : same_texels->feat1)) {
          encoded[image] = std::move(*bytes);
          return;
        }
      encoded[image] = write_feature_png(*set.texels, image);
    });
    for (const int image : {0, 1}) out.write(folder / feature_name(layout, i, image), encoded[image]);
  }

  std::optional<std::string> mlp;
  if (object.origin && object.decoder == object.origin->decoder && object.origin->sets.size() == sets.size() &&
      (layout == Layout::unsplit || object.origin->obj_num == static_cast<int>(sets.size())) &&
      (object.origin->layout == Layout::unsplit) == (layout == Layout::unsplit))
    mlp = unchanged_bytes(*object.origin, object.origin->mlp);
  if (!mlp) {
    MlpFile file{*object.decoder, std::nullopt, object.other_members};
    if (layout != Layout::unsplit) file.obj_num = static_cast<int>(sets.size());
    mlp = write_mlp_json(file);
  }
  out.write(folder / "mlp.json", *mlp);
  if (object.any_rotations()) out.write(folder / "turns.bin", write_turns(sets));
  if (baked_places && any_baked_places(object.sets)) out.write(folder / "baked.bin", write_baked_places(sets));
  progress.at("writing", 1);
}

}  // namespace rebake
