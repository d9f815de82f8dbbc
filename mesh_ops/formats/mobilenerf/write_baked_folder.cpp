#include "mesh_ops/formats/mobilenerf/write_baked_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "mesh_ops/base/counted.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/features/atlas/atlas.h"
#include "mesh_ops/formats/mobilenerf/baked_folder.h"
#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"
#include "mesh_ops/formats/mobilenerf/dialect.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/rotations_file.h"
#include "mesh_ops/formats/mobilenerf/source_file.h"
#include "mesh_ops/texture/linear_filter.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// The source set whose texels (and with `geometry` also triangles) a set still has; null if none.
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

// Copies a source file if its bytes have not changed since it was read. Returns false if they have; the output is then
// useless.
bool copy_unchanged(AtomicFolder& out, const fs::path& to, const Origin& origin, const SourceFile& file) {
  try {
    ContentHash hash;
    std::uint64_t size = 0;
    out.write_in_pieces(to, [&](const AtomicFolder::Append& append) {
      read_in_pieces(origin.folder / file.name, [&](std::string_view piece) {
        hash.add(piece);
        size += piece.size();
        // Never appends more than the former size, since the file may be growing.
        if (size <= file.size) append(piece);
      });
    });
    return size == file.size && hash.value() == file.hash;
  } catch (const FileError&) {
    // The file was moved or removed, so its contents are written from memory. That also reports a full disk.
    return false;
  }
}

// Text of a count: exact below a million.
std::string in_millions(std::uint64_t count) {
  return count < 1'000'000 ? fmt::format("{}", count) : fmt::format("{:.2f} million", static_cast<double>(count) / 1e6);
}

std::string sizes_of(const std::vector<PackedPage>& sets) {
  std::vector<std::string> sizes;
  for (const PackedPage& set : sets) sizes.push_back(fmt::format("{}×{}", set.texels.width, set.texels.height));
  return fmt::format("{}", fmt::join(sizes, ", "));
}

std::uint64_t area_of(const std::vector<PackedPage>& sets) {
  std::uint64_t area = 0;
  for (const PackedPage& set : sets)
    area += static_cast<std::uint64_t>(set.texels.width) * static_cast<std::uint64_t>(set.texels.height);
  return area;
}

// The textures to write: unchanged sets as they were read, edited ones repacked if that saves texels.
struct Fitted {
  std::vector<PackedPage> pages;
  // The object's sets in the first pages, which are not repacked.
  std::vector<TextureSet> kept;
};
Fitted fitted(const BakedObject& object, Layout layout, bool all_texels, std::optional<int> page_side,
              std::vector<std::string>& notes) {
  const AlphaCode code = alpha_code_of(layout, object.dialect);
  const BakedObject* const objects[] = {&object};
  const int largest = page_side.value_or(largest_page_side(layout, objects));
  const auto is_too_large = [&](const TextureSet& set) {
    return page_side && std::max(set.texels->width(), set.texels->height()) > largest;
  };
  if (code == AlphaCode::halved && std::any_of(object.sets.begin(), object.sets.end(),
                                               [&](const TextureSet& s) { return s.texels->alpha_code() != code; }))
    notes.emplace_back("features 3 and 7 lose their lowest bit: split folders store them halved");
  if (layout == Layout::unsplit && object.sets.size() > 1) {
    std::vector<PackedPage> pages = packed_pages(object.sets, largest, code);
    if (pages.size() > 1)
      throw Error(fmt::format("the texels do not fit into one texture of {}²: use --layout split", largest));
    return {std::move(pages), {}};
  }
  // Sets that lost triangles lose their unused texels; unchanged sets are not repacked.
  Fitted result;
  std::vector<TextureSet> edited;
  bool must_pack = false;
  for (const TextureSet& set : object.sets) {
    const Origin::Set* source = source_set(object, set, false);
    const bool same_faces = source != nullptr && source->faces.lock() == set.soup.shared_faces();
    // Textures for linear filtering lie on the grid of their blocks.
    if (object.dialect.linear != 0 || (!is_too_large(set) && (all_texels || same_faces || !can_pack(set)))) {
      result.kept.push_back(set);
    } else {
      must_pack = must_pack || is_too_large(set);
      edited.push_back(set);
    }
  }
  const auto as_pages = [&](const std::vector<TextureSet>& sets) {
    std::vector<PackedPage> pages;
    for (const TextureSet& set : sets) pages.push_back({set.soup, rows_of(set.texels, code)});
    return pages;
  };
  std::vector<PackedPage> packed;
  if (!edited.empty()) {
    packed = packed_pages(edited, largest, code);
    const std::vector<PackedPage> before = as_pages(edited);
    if (area_of(packed) < area_of(before) || must_pack) {
      notes.push_back(
          fmt::format("edited texture sets were repacked without unused texels: {} instead of {} texels "
                      "({} → {}); {} not repacked",
                      in_millions(area_of(packed)), in_millions(area_of(before)), sizes_of(before), sizes_of(packed),
                      counted(result.kept.size(), "other set was", "other sets were")));
    } else {
      packed.clear();
      result.kept.insert(result.kept.end(), edited.begin(), edited.end());
    }
  }
  result.pages = as_pages(result.kept);
  std::move(packed.begin(), packed.end(), std::back_inserter(result.pages));
  return result;
}

// Whether the file's textures, linearly filtered, give all texels of the object.
bool shows_by_linear_filtering(const BakedObject& object) {
  const bool same = object.origin && object.origin->dialect.linear == object.dialect.linear;
  return std::all_of(object.sets.begin(), object.sets.end(), [&](const TextureSet& set) {
    return (same && source_set(object, set, false) != nullptr) || is_subdivided(*set.texels, object.dialect.linear);
  });
}

// Why textures for linear filtering cannot be written; empty if they can, or are not wanted.
std::string why_not_linear(const BakedObject& object, Layout layout, std::optional<int> page_side) {
  if (object.dialect.linear == 0) return "";
  if (page_side || (layout == Layout::unsplit && object.sets.size() > 1))
    return "packed textures do not lie on the grid of the original texels";
  return shows_by_linear_filtering(object) ? "" : "edited texels cannot be shown by linear filtering";
}

// The texels of a file in the object's dialect.
TexelRows file_texels(const TexelRows& texels, const Dialect& dialect) {
  TexelRows rows = in_channel_order(texels, dialect);
  return dialect.linear == 0 ? rows : block_centers(std::move(rows), dialect.linear);
}

// Chunk viewers and the Unity importer fail on an empty chunk, so it gets one triangle whose corners are the same
// vertex, which renders nothing. read_baked_folder() removes it.
std::string placeholder_chunk(const Soup& soup) {
  const std::uint32_t vertex = soup.faces().front()[0];
  return write_obj({soup.positions()[vertex]}, {soup.uvs()[vertex]}, {Face{0, 0, 0}}, 0, 1);
}

std::vector<std::string> geometry_texts(const Soup& soup, Layout layout) {
  const std::size_t faces = soup.triangle_count();
  if (layout != Layout::chunked) return {write_obj(soup.positions(), soup.uvs(), soup.faces(), 0, faces)};
  std::vector<std::string> texts(chunks_per_set);
  tbb::parallel_for(std::size_t{0}, chunks_per_set, [&](std::size_t j) {
    const std::size_t first = faces * j / chunks_per_set, last = faces * (j + 1) / chunks_per_set;
    texts[j] =
        first == last ? placeholder_chunk(soup) : write_obj(soup.positions(), soup.uvs(), soup.faces(), first, last);
  });
  return texts;
}

// Writes a set's triangles: copies the files of `source` if it is not null and they have not changed.
void write_geometry(AtomicFolder& out, const fs::path& folder, Layout layout, std::size_t set, const Soup& soup,
                    const Origin* origin, const Origin::Set* source) {
  if (source != nullptr) {
    std::vector<std::string> texts;
    for (const SourceFile& file : source->geometry)
      if (auto bytes = unchanged_bytes(*origin, file)) texts.push_back(std::move(*bytes));
    if (!texts.empty() && texts.size() == source->geometry.size()) {
      Layout named = layout;
      if (layout == Layout::chunked && source->geometry.front().name.find('_') == std::string::npos)
        named = Layout::split;
      for (std::size_t j = 0; j < texts.size(); ++j) out.write(folder / geometry_name(named, set, j), texts[j]);
      return;
    }
  }
  const std::vector<std::string> texts = geometry_texts(soup, layout);
  for (std::size_t j = 0; j < texts.size(); ++j) out.write(folder / geometry_name(layout, set, j), texts[j]);
}

// Writes a set's feature images: copies the files of `source` if it is not null and they have not changed.
void write_texels(AtomicFolder& out, const fs::path& folder, Layout layout, std::size_t set, const TexelRows& texels,
                  const Origin* origin, const Origin::Set* source) {
  const fs::path names[] = {folder / feature_name(layout, set, 0), folder / feature_name(layout, set, 1)};
  bool copied[] = {false, false};
  for (const int image : {0, 1})
    copied[image] =
        source != nullptr && copy_unchanged(out, names[image], *origin, image == 0 ? source->feat0 : source->feat1);
  if (copied[0] && copied[1]) return;
  if (copied[0] || copied[1]) {
    const int image = copied[0] ? 1 : 0;
    out.write_in_pieces(names[image], [&](const AtomicFolder::Append& append) {
      write_feature_pngs(texels, image == 0 ? append : nullptr, image == 1 ? append : nullptr);
    });
    return;
  }
  out.write_in_pieces(names[0], [&](const AtomicFolder::Append& feat0) {
    out.write_in_pieces(names[1], [&](const AtomicFolder::Append& feat1) { write_feature_pngs(texels, feat0, feat1); });
  });
}

}  // namespace

int largest_page_side(Layout layout, std::span<const BakedObject* const> objects) {
  int side = layout == Layout::unsplit ? 16384 : 4096;
  for (const BakedObject* object : objects)
    for (const TextureSet& set : object->sets) side = std::max({side, set.texels->width(), set.texels->height()});
  return side;
}

BakedObject published(BakedObject object) {
  object.dialect = {};
  // Features of other rules need all bits.
  if (object.decoder->rule != ColorRule::network) object.dialect.alpha = AlphaCode::plain;
  return object;
}

void write_baked_folder(AtomicFolder& out, const fs::path& folder, const BakedObject& made, Layout layout,
                        std::vector<std::string>& notes, const Progress& progress, bool baked_places,
                        std::optional<int> page_side) {
  if (made.triangle_count() == 0) throw Error("an object without triangles cannot be written");
  BakedObject object = made;
  if (object.origin && object.origin->format != Origin{}.format) object.origin = nullptr;
  std::erase_if(object.sets, [](const TextureSet& set) { return set.soup.triangle_count() == 0; });
  if (const std::string why = why_not_linear(object, layout, page_side); !why.empty()) {
    notes.push_back(
        fmt::format("{}: the textures are written for nearest sampling, {} times as fine; open the folder "
                    "without linear",
                    why, object.dialect.linear));
    object.dialect.linear = 0;
  }
  if (object.dialect != Dialect{})
    notes.emplace_back("the folder is in the dialect in which it was read; open it with the same options");
  const Fitted fit = fitted(object, layout, baked_places, page_side, notes);
  const bool same_layout = object.origin && object.origin->layout == layout;
  const bool same_dialect = object.origin && object.origin->dialect == object.dialect;
  const bool same_names = same_dialect && (object.origin->layout == Layout::unsplit) == (layout == Layout::unsplit);

  for (std::size_t i = 0; i < fit.pages.size(); ++i) {
    const PackedPage& page = fit.pages[i];
    progress.at("writing", static_cast<double>(i) / static_cast<double>(fit.pages.size()));
    const TextureSet* kept = i < fit.kept.size() ? &fit.kept[i] : nullptr;
    write_geometry(out, folder, layout, i, page.soup, object.origin.get(),
                   same_layout && kept != nullptr ? source_set(object, *kept, true) : nullptr);
    write_texels(out, folder, layout, i, file_texels(page.texels, object.dialect), object.origin.get(),
                 same_names && kept != nullptr ? source_set(object, *kept, false) : nullptr);
  }

  std::optional<std::string> mlp;
  if (object.origin && object.decoder == object.origin->decoder && object.origin->sets.size() == fit.pages.size() &&
      (layout == Layout::unsplit || object.origin->obj_num == static_cast<int>(fit.pages.size())) && same_names)
    mlp = unchanged_bytes(*object.origin, object.origin->mlp);
  if (!mlp) {
    MlpFile file{to_dialect(*object.decoder, object.dialect), std::nullopt, object.other_members};
    if (layout != Layout::unsplit) file.obj_num = static_cast<int>(fit.pages.size());
    mlp = write_mlp_json(file);
  }
  out.write(folder / "mlp.json", *mlp);
  std::vector<TextureSet> sets;  // sets without textures
  for (const PackedPage& page : fit.pages) sets.push_back({page.soup, nullptr});
  if (object.any_rotations()) out.write(folder / "turns.bin", write_rotations(sets));
  if (baked_places && any_baked_positions(object.sets)) out.write(folder / "baked.bin", write_baked_positions(sets));
  progress.at("writing", 1);
}

}  // namespace rebake
