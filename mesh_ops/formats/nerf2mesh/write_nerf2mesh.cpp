#include <fmt/format.h>

#include "mesh_ops/base/error.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/mobilenerf/obj.h"
#include "mesh_ops/formats/mobilenerf/source_file.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_folder.h"
#include "mesh_ops/formats/nerf2mesh/nerf2mesh_mlp.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

constexpr int png_compression = 6;

// Image 0 (diffuse) or 1 (specular) of a texture as RGB.
std::string encoded(const FeatureTexture& texture, int image) {
  std::string bytes;
  PngEncoder png(texture.width(), texture.height(), 3, png_compression,
                 [&](std::string_view piece) { bytes += piece; });
  const TexelReader texels(texture);
  std::vector<std::uint8_t> row;
  for (int y = 0; y < texture.height(); ++y) {
    row.clear();
    for (int x = 0; x < texture.width(); ++x) {
      const Texel& texel = texels.at(x, y);
      const std::uint8_t* rgb = image == 0 ? texel.feat0.data() + 1 : texel.feat1.data();
      row.insert(row.end(), rgb, rgb + 3);
    }
    png.write_rows(row);
  }
  png.finish();
  return bytes;
}

// The lines by which an OBJ refers to the first material of an MTL text.
std::string material_lines(int k, const std::string& material) {
  const std::size_t at = material.find("newmtl ");
  if (at == std::string::npos) return "";
  const std::string name = material.substr(at + 7, material.find_first_of("\r\n", at) - at - 7);
  return fmt::format("mtllib mesh_{}.mtl\nusemtl {}\n", k, name);
}

void write_mesh(AtomicFolder& out, int k, const Soup& soup, const Origin* origin, const Origin::Set* source) {
  std::string mesh, material;
  // A material names the images of its own number.
  if (source != nullptr && source->geometry.size() > 1 && source->geometry[1].name == fmt::format("mesh_{}.mtl", k))
    material = unchanged_bytes(*origin, source->geometry[1]).value_or("");
  if (!material.empty()) out.write(fmt::format("mesh_{}.mtl", k), material);
  if (source != nullptr && source->positions.lock() == soup.shared_positions() &&
      source->uvs.lock() == soup.shared_uvs() && source->faces.lock() == soup.shared_faces())
    mesh = unchanged_bytes(*origin, source->geometry.front()).value_or("");
  if (mesh.empty())
    mesh =
        material_lines(k, material) + write_obj(soup.positions(), soup.uvs(), soup.faces(), 0, soup.triangle_count());
  out.write(fmt::format("mesh_{}.obj", k), mesh);
}

// Returns whether an image had to be encoded.
bool write_images(AtomicFolder& out, int k, const FeatureTexture& texels, const Origin* origin,
                  const Origin::Set* source) {
  bool encodes = false;
  for (const int image : {0, 1}) {
    const SourceFile* file = source == nullptr ? nullptr : image == 0 ? &source->feat0 : &source->feat1;
    const std::string bytes = file == nullptr ? "" : unchanged_bytes(*origin, *file).value_or("");
    encodes = encodes || bytes.empty();
    const std::string extension = file == nullptr || bytes.empty() ? ".png" : fs::path(file->name).extension().string();
    out.write(fmt::format("feat{}_{}{}", image, k, extension), bytes.empty() ? encoded(texels, image) : bytes);
  }
  return encodes;
}

void check_is_exact(const BakedObject& object) {
  if (object.sets.size() > static_cast<std::size_t>(max_nerf2mesh_meshes))
    throw EditError(fmt::format("a nerf2mesh folder holds at most {} meshes, but the scene has {}",
                                max_nerf2mesh_meshes, object.sets.size()));
  if (!is_nerf2mesh_decoder(*object.decoder))
    throw EditError("the objects are not all of nerf2mesh folders, so a nerf2mesh folder cannot represent them");
  for (const TextureSet& set : object.sets) {
    const auto texels = static_cast<std::uint64_t>(set.texels->width()) * static_cast<unsigned>(set.texels->height());
    if (set.texels->opaque_count() != texels || set.texels->alpha_code() != AlphaCode::plain)
      throw EditError("texels were erased, but nerf2mesh folders are opaque: delete triangles instead");
  }
}

}  // namespace

void write_nerf2mesh_folder(AtomicFolder& out, const BakedObject& object, std::vector<std::string>& notes,
                            const Progress& progress) {
  check_is_exact(object);
  const Origin* origin = object.origin && object.origin->format == nerf2mesh_format ? object.origin.get() : nullptr;
  bool encodes = false;
  int k = 0;
  for (const TextureSet& set : object.sets) {
    progress.at("writing", k / static_cast<double>(object.sets.size()));
    const Origin::Set* source = nullptr;
    if (origin != nullptr)
      for (const Origin::Set& one : origin->sets)
        if (one.texels.lock() == set.texels) source = &one;
    write_mesh(out, k, set.soup, origin, source);
    encodes = write_images(out, k, *set.texels, origin, source) || encodes;
    ++k;
  }
  if (encodes)
    notes.emplace_back("textures were encoded as PNG, which is exact; the viewer of nerf2mesh reads .jpg names only");
  std::string mlp;
  if (origin != nullptr && object.decoder == origin->decoder && origin->obj_num == static_cast<int>(object.sets.size()))
    mlp = unchanged_bytes(*origin, origin->mlp).value_or("");
  if (mlp.empty())
    mlp = write_nerf2mesh_mlp({*object.decoder, static_cast<int>(object.sets.size()), object.other_members});
  out.write("mlp.json", mlp);
  progress.at("writing", 1);
}

}  // namespace rebake
