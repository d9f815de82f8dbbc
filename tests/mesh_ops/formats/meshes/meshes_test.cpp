// Textured meshes of modelling programs: OBJ, glTF and PLY become objects with plain colours.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/formats.h"
#include "mesh_ops/formats/images/png_writer.h"
#include "mesh_ops/formats/meshes/ply_file.h"
#include "mesh_ops/formats/scene_files.h"
#include "mesh_ops/rays/scene_rays.h"
#include "mesh_ops/scene/scene_light.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

namespace fs = std::filesystem;

// A 2 × 2 image, RGBA, rows from the top: red, green / blue, transparent white.
std::string corners_png() {
  const std::vector<std::uint8_t> pixels{255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 0};
  return encode_png(2, 2, 4, pixels, 6);
}

// The bytes R, G, B of the texel that a point of the plane z = 0 shows; nothing in a hole or beside the mesh.
std::optional<std::array<int, 3>> shown_at(const Scene& scene, double x, double y) {
  const std::vector<PlacedNode> placed = placed_nodes(scene);
  for (const TextureSet& set : placed[0].node->object->sets)
    for (const Face& face : set.soup.faces()) {
      const Vec3 a = placed[0].to_world * set.soup.positions()[face[0]],
                 b = placed[0].to_world * set.soup.positions()[face[1]],
                 c = placed[0].to_world * set.soup.positions()[face[2]];
      Eigen::Matrix2d sides;
      sides << (b - a).x(), (c - a).x(), (b - a).y(), (c - a).y();
      const Vec2 w = sides.inverse() * Vec2(x - a.x(), y - a.y());
      if (w.minCoeff() < 0 || w.sum() > 1) continue;
      const Vec2 uv =
          set.soup.uvs()[face[0]] * (1 - w.sum()) + set.soup.uvs()[face[1]] * w.x() + set.soup.uvs()[face[2]] * w.y();
      const Texel texel = TexelReader(*set.texels).sample(uv.x(), uv.y());
      if (!texel.opaque()) return std::nullopt;
      return std::array<int, 3>{texel.feat0[1], texel.feat0[2], texel.feat0[3]};
    }
  return std::nullopt;
}

constexpr std::array<int, 3> red_bytes{255, 0, 0}, green_bytes{0, 255, 0}, blue_bytes{0, 0, 255};

void expect_quarters(const Scene& scene, const std::string& what) {
  EXPECT_EQ(shown_at(scene, -0.5, 0.5), red_bytes) << what;
  EXPECT_EQ(shown_at(scene, 0.5, 0.5), green_bytes) << what;
  EXPECT_EQ(shown_at(scene, -0.5, -0.5), blue_bytes) << what;
  EXPECT_EQ(shown_at(scene, 0.5, -0.5), std::nullopt) << what;
}

class Meshes : public ::testing::Test {
 protected:
  Meshes() { write_text(path("image.png"), corners_png()); }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  Scene read(const std::string& name) const { return read_any(path(name), Axes::y_up); }
  std::string problem(const std::string& name, const std::string& text) const {
    write_text(path(name), text);
    try {
      read(name);
    } catch (const FileError& error) {
      return error.what();
    }
    return "none";
  }
  // The square −1 … 1 of z = 0 with the image, in a node that moves it by `node`.
  nlohmann::json square_gltf(const nlohmann::json& node = nlohmann::json::object()) const {
    std::string bytes;
    const auto add = [&](const std::vector<float>& values) {
      bytes.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
    };
    add({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0});
    add({0, 1, 1, 1, 1, 0, 0, 0});  // v points down
    const std::uint16_t corners[] = {0, 1, 2, 0, 2, 3};
    bytes.append(reinterpret_cast<const char*>(corners), sizeof corners);
    write_text(path("square.bin"), bytes);
    nlohmann::json root = nlohmann::json::parse(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "alphaMode": "MASK"}],
      "textures": [{"source": 0}], "images": [{"uri": "image.png"}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
                    {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
                      {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
      "buffers": [{"uri": "square.bin", "byteLength": 92}]})");
    nlohmann::json made = node;
    made["mesh"] = 0;
    root["nodes"] = nlohmann::json::array({made});
    return root;
  }
  TemporaryFolder folder_;
};

const std::string square_obj = R"(mtllib square.mtl
o square
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 1
usemtl picture
f 1/1/1 2/2/1 3/3/1 4/4/1
)";

TEST_F(Meshes, ObjWithMaterials) {
  write_text(path("square.obj"), square_obj + "usemtl plain colour\nf 1 2 3\n");
  write_text(path("square.mtl"),
             "newmtl plain colour\nKd 0.5 0.25 1\nnewmtl picture\nKd 0.8 0.8 0.8\nmap_Kd image.png\n");
  const Scene scene = read("square.obj");
  expect_quarters(scene, "obj");
  EXPECT_EQ(scene.roots[0]->name, "square");
  ASSERT_EQ(scene.roots[0]->object->sets.size(), 2U);
  const Texel plain = TexelReader(*scene.roots[0]->object->sets[1].texels).at(0, 0);
  EXPECT_EQ(plain.feat0, (std::array<std::uint8_t, 4>{255, 128, 64, 255}));
  EXPECT_FALSE(scene.roots[0]->object->origin->assumptions.empty());
}

TEST_F(Meshes, ObjLinesNameSeveralMaterialFilesOrOneWithBlanks) {
  write_text(path("first.mtl"), "newmtl other\nKd 1 0 0\n");
  write_text(path("second.mtl"), "newmtl picture\nmap_Kd image.png\n");
  std::string text = square_obj;
  text.replace(0, text.find('\n'), "mtllib first.mtl  second.mtl");
  write_text(path("square.obj"), text);
  expect_quarters(read("square.obj"), "obj");
  const std::vector<fs::path> expected{"first.mtl", "image.png", "second.mtl"};
  EXPECT_EQ(scene_files(path("square.obj")), expected);
  fs::rename(path("second.mtl"), path("second of two.mtl"));
  text.replace(0, text.find('\n'), "mtllib second of two.mtl");
  write_text(path("square.obj"), text);
  expect_quarters(read("square.obj"), "obj");
}

TEST_F(Meshes, ImagesRepeat) {
  // The image twice along u, and shifted by −3 tiles along v.
  std::string text = square_obj;
  for (const auto& [from, to] :
       {std::pair("vt 0 0", "vt 0 -3"), {"vt 1 0", "vt 2 -3"}, {"vt 1 1", "vt 2 -2"}, {"vt 0 1", "vt 0 -2"}})
    text.replace(text.find(from), 6, to);
  write_text(path("square.obj"), text);
  write_text(path("square.mtl"), "newmtl picture\nmap_Kd image.png\n");
  const Scene scene = read("square.obj");
  for (const double shift : {0.0, 1.0}) {
    EXPECT_EQ(shown_at(scene, -0.75 + shift, 0.5), red_bytes);
    EXPECT_EQ(shown_at(scene, -0.25 + shift, 0.5), green_bytes);
    EXPECT_EQ(shown_at(scene, -0.75 + shift, -0.5), blue_bytes);
  }
  text.replace(text.find("vt 2 -3"), 7, "vt 2e5 0");
  EXPECT_NE(problem("square.obj", text).find("repeats"), std::string::npos);
}

TEST_F(Meshes, GltfInAllContainers) {
  const nlohmann::json root = square_gltf();
  write_text(path("square.gltf"), root.dump());
  expect_quarters(read("square.gltf"), "gltf");
  // The same as a container with everything inside.
  nlohmann::json inside = root;
  std::string binary;
  const std::string bytes = read_file(path("square.bin"));
  binary = bytes + corners_png();
  inside["buffers"] = nlohmann::json::array({nlohmann::json{{"byteLength", binary.size()}}});
  inside["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", corners_png().size()}});
  inside["images"] = nlohmann::json::array({nlohmann::json{{"bufferView", 3}, {"mimeType", "image/png"}}});
  std::string text = inside.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  const auto word = [](std::size_t value) {
    std::string out;
    for (int k = 0; k < 4; ++k) out += static_cast<char>(value >> 8 * k & 0xff);
    return out;
  };
  write_text(path("square.glb"), "glTF" + word(2) + word(28 + text.size() + binary.size()) + word(text.size()) +
                                     "JSON" + text + word(binary.size()) + std::string("BIN\0", 4) + binary);
  expect_quarters(read("square.glb"), "glb");
}

TEST_F(Meshes, GltfContentThatIsNotReadIsSaid) {
  nlohmann::json root = square_gltf();
  root["animations"] = {{{"channels", nlohmann::json::array()}, {"samplers", nlohmann::json::array()}}};
  root["cameras"] = {{{"type", "perspective"}}};
  root["extensions"]["KHR_lights_punctual"]["lights"] = nlohmann::json::array();
  root["nodes"].push_back(root["nodes"][0]);
  root["scenes"] = {{{"nodes", {0, 1}}}, {{"nodes", {0}}}};
  write_text(path("square.gltf"), root.dump());
  const Scene scene = read("square.gltf");
  const std::string said = fmt::format("{}", fmt::join(scene.roots[0]->object->origin->assumptions, "\n"));
  for (const char* what :
       {"animations are skipped", "cameras are skipped", "lights are skipped", "main scene", "become one object"})
    EXPECT_NE(said.find(what), std::string::npos) << what << "\n" << said;
}

TEST_F(Meshes, GltfTransformsAndFactors) {
  // A quarter turn about z, twice the size, moved by (10, 0, 0); the turn takes (x, y) to (−y, x).
  nlohmann::json root = square_gltf(
      {{"translation", {10, 0, 0}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 2, 2}}});
  root["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.25, 1, 1, 1};
  write_text(path("square.gltf"), root.dump());
  const Scene scene = read("square.gltf");
  EXPECT_EQ(shown_at(scene, 10 - 1, 1), green_bytes);
  EXPECT_EQ(shown_at(scene, 10 + 1, -1), blue_bytes);
  // The factor is linear: 0.25 is 0.537 as a display colour.
  EXPECT_EQ(shown_at(scene, 10 - 1, -1),
            (std::array<int, 3>{static_cast<int>(std::lround(255 * to_display(0.25))), 0, 0}));
  // The left half of the image on the whole square.
  root = square_gltf();
  root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"scale", {0.5, 1}}};
  write_text(path("square.gltf"), root.dump());
  EXPECT_EQ(shown_at(read("square.gltf"), 0.9, 0.5), red_bytes);
  EXPECT_EQ(shown_at(read("square.gltf"), 0.9, -0.5), blue_bytes);
}

const std::string square_ply = R"(ply
format ascii 1.0
comment TextureFile image.png
element vertex 4
property float x
property float y
property float z
property float s
property float t
element face 1
property list uchar int vertex_indices
end_header
-1 -1 0 0 0
1 -1 0 1 0
1 1 0 1 1
-1 1 0 0 1
4 0 1 2 3
)";

TEST_F(Meshes, PlyWithImageAndWithColours) {
  write_text(path("square.ply"), square_ply);
  expect_quarters(read("square.ply"), "ply");
  // As MeshLab writes it: texture coordinates per face, binary, big endian.
  std::string binary = R"(ply
format binary_big_endian 1.0
comment TextureFile image.png
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
property list uchar float texcoord
end_header
)";
  const auto big = [&](auto value) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    std::reverse(raw, raw + 4);
    binary.append(raw, 4);
  };
  for (const float x : {-1.F, -1.F, 0.F, 1.F, -1.F, 0.F, 1.F, 1.F, 0.F, -1.F, 1.F, 0.F}) big(x);
  binary += '\4';
  for (const int vertex : {0, 1, 2, 3}) big(vertex);
  binary += '\10';
  for (const float uv : {0.F, 0.F, 1.F, 0.F, 1.F, 1.F, 0.F, 1.F}) big(uv);
  write_text(path("binary.ply"), binary);
  expect_quarters(read("binary.ply"), "binary");
  EXPECT_NE(problem("short.ply", binary.substr(0, binary.size() - 3)).find("truncated"), std::string::npos);

  write_text(path("colours.ply"),
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
             "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
             "element face 1\nproperty list uchar int vertex_index\nend_header\n"
             "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n");
  EXPECT_EQ(shown_at(read("colours.ply"), 0.3, 0.3), (std::array<int, 3>{85, 85, 85}));
}

// A cube of side 2 below a red cone, z up in Blender; its exporters turn glTF and OBJ to y up (blender/make.py).
TEST_F(Meshes, FilesThatBlenderWrote) {
  const fs::path made = fs::path(REBAKE_SOURCE) / "tests/mesh_ops/formats/meshes/blender";
  for (const char* name : {"blender.glb", "blender.obj", "blender.ply"}) {
    const Scene scene = read_any(made / name, Axes::y_up);
    const bool ply = std::string(name) == "blender.ply";
    const Box box = world_bounds(scene);
    EXPECT_EQ(box.min()[ply ? 2 : 1], 0) << name;
    EXPECT_EQ(box.max()[ply ? 2 : 1], 4) << name;
    EXPECT_EQ(scene.roots[0]->object->triangle_count(), 12U + 5 + 3) << name;
    if (ply) continue;
    const std::vector<PlacedNode> placed = placed_nodes(scene);
    std::map<std::array<std::uint8_t, 4>, int> colors;
    for (const TextureSet& set : placed[0].node->object->sets) {
      const TexelReader texels(*set.texels);
      for (int y = 0; y < set.texels->height(); ++y)
        for (int x = 0; x < set.texels->width(); ++x) ++colors[texels.at(x, y).feat0];
    }
    EXPECT_EQ(colors.size(), 65U) << name;
    EXPECT_EQ((colors[{255, 255, 0, 0}]), 1) << name;
    EXPECT_EQ((colors[{255, 0, 0, 128}] + colors[{255, 0, 0, 127}]), 1) << name;
  }
  // Both give each corner of each side of the cube the same texture coordinates.
  const auto cube_corners = [&](const char* name) {
    std::set<std::array<int, 8>> found;
    const Scene scene = read_any(made / name, Axes::y_up);
    for (const TextureSet& set : scene.roots[0]->object->sets)
      for (const Face& face : set.soup.faces()) {
        const auto& p = set.soup.positions();
        const Vec3 normal = (p[face[1]] - p[face[0]]).cross(p[face[2]] - p[face[0]]).normalized();
        if (p[face[0]].y() > 2 || p[face[1]].y() > 2 || p[face[2]].y() > 2) continue;
        std::array<int, 8> corner{};
        for (const std::uint32_t v : face) {
          const auto whole = [](double value) { return static_cast<int>(std::lround(1000 * value)); };
          for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = whole(p[v][static_cast<Eigen::Index>(k)]);
            corner[3 + k] = whole(normal[static_cast<Eigen::Index>(k)]);
          }
          corner[6] = whole(set.soup.uvs()[v].x());
          corner[7] = whole(set.soup.uvs()[v].y());
          if (corner[4] != 1000 || set.texels->width() == 8) found.insert(corner);
        }
      }
    return found;
  };
  EXPECT_GE(cube_corners("blender.glb").size(), 24U);
  EXPECT_EQ(cube_corners("blender.glb"), cube_corners("blender.obj"));
}

TEST_F(Meshes, FilesBesideAreHashedAndStayInTheFolder) {
  write_text(path("square.obj"), square_obj);
  write_text(path("square.mtl"), "newmtl picture\nmap_Kd image.png\n");
  EXPECT_EQ(scene_files(path("square.obj")), (std::vector<fs::path>{"image.png", "square.mtl"}));
  const std::uint64_t before = content_hash_at(path("square.obj"));
  write_text(path("square.mtl"), "newmtl picture\nmap_Kd  image.png\n");
  EXPECT_NE(content_hash_at(path("square.obj")), before);
  for (const char* name : {"../image.png", "/etc/passwd", "..\\image.png"}) {
    write_text(path("square.mtl"), std::string("newmtl picture\nmap_Kd ") + name + "\n");
    EXPECT_NE(problem("square.obj", square_obj).find("outside its folder"), std::string::npos) << name;
    nlohmann::json root = square_gltf();
    root["images"][0]["uri"] = name;
    EXPECT_NE(problem("square.gltf", root.dump()).find("outside its folder"), std::string::npos) << name;
  }
}

// An image that is not read, such as a normal map, must not hide the files that are.
TEST_F(Meshes, GltfWithAnUnreadImageElsewhereStillNamesItsFiles) {
  nlohmann::json root = square_gltf();
  root["images"].push_back({{"uri", "../shared/normal.png"}});
  write_text(path("stray.gltf"), root.dump());
  const std::vector<fs::path> files = scene_files(path("stray.gltf"));
  EXPECT_NE(std::find(files.begin(), files.end(), "image.png"), files.end());
  SourceGuard guard;
  protect_input(guard, path("stray.gltf"));
  EXPECT_THROW(guard.check_file(path("image.png")), FileError);
}

TEST_F(Meshes, SharedImagesAreOneTexture) {
  nlohmann::json root = square_gltf();
  for (int k = 1; k < 20; ++k) {
    root["nodes"].push_back({{"mesh", 0}, {"translation", {3.0 * k, 0, 0}}});
    root["scenes"][0]["nodes"].push_back(k);
  }
  // And plain colours, which share another.
  for (int k = 1; k < 20; ++k) {
    root["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorFactor", {k / 20.0, 1, 0, 1}}}}});
    root["meshes"].push_back(root["meshes"][0]);
    root["meshes"][k]["primitives"][0]["material"] = k;
    root["nodes"].push_back({{"mesh", k}, {"translation", {3.0 * k, 5, 0}}});
    root["scenes"][0]["nodes"].push_back(19 + k);
  }
  write_text(path("square.gltf"), root.dump());
  const Scene scene = read("square.gltf");
  EXPECT_EQ(scene.roots[0]->object->sets.size(), 2U);
  EXPECT_EQ(shown_at(scene, 3 * 7 - 0.5, 0.5), red_bytes);
  EXPECT_EQ(shown_at(scene, 3 * 10 - 0.5, 5.5),
            (std::array<int, 3>{static_cast<int>(std::lround(255 * to_display(0.5))), 255, 0}));
}

TEST_F(Meshes, SamplersClampPerAxis) {
  nlohmann::json root = square_gltf();
  root["samplers"] = nlohmann::json::array({nlohmann::json{{"wrapS", 10497}, {"wrapT", 33071}}});
  root["textures"][0]["sampler"] = 0;
  root["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = {
      {"offset", {1, -1}}};
  write_text(path("square.gltf"), root.dump());
  const Scene scene = read("square.gltf");
  // One tile to the right is the same; one tile up is the upper border.
  for (const double y : {-0.5, 0.5}) {
    EXPECT_EQ(shown_at(scene, -0.5, y), red_bytes);
    EXPECT_EQ(shown_at(scene, 0.5, y), green_bytes);
  }
}

TEST_F(Meshes, HostileFilesEnd) {
  std::string deep = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": )";
  deep += std::string(200000, '[') + std::string(200000, ']') + "}]}";
  EXPECT_NE(problem("a.gltf", deep).find("nested deeper"), std::string::npos);
  EXPECT_NE(problem("a.ply",
                    "ply\nformat ascii 1.0\nelement junk 18446744073709551615\nelement vertex 0\n"
                    "property float x\nproperty float y\nproperty float z\nend_header\n")
                .find("no faces"),
            std::string::npos);
  nlohmann::json root = square_gltf({{"scale", {1e308, 1e308, 1e308}}, {"translation", {1e308, 0, 0}}});
  EXPECT_NE(problem("a.gltf", root.dump()).find("not finite"), std::string::npos);
  write_text(path("square.mtl"), "newmtl picture\nmap_Kd gone.png\n");
  EXPECT_NE(problem("square.obj", square_obj).find("refers to \"gone.png\", which is not there"), std::string::npos);
  // A material that no face uses needs no image.
  write_text(path("square.mtl"), "newmtl picture\nmap_Kd image.png\nnewmtl unused\nmap_Kd gone.png\n");
  EXPECT_EQ(problem("square.obj", square_obj), "none");
  EXPECT_EQ(scene_files(path("square.obj")).size(), 2U);
}

TEST_F(Meshes, DamageIsNamed) {
  EXPECT_NE(problem("a.obj", "v 0 0 0\n").find("no triangles"), std::string::npos);
  EXPECT_NE(problem("a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n").find("end_header"),
            std::string::npos);
  EXPECT_NE(problem("a.gltf", "{}").find("asset"), std::string::npos);
  EXPECT_NE(problem("a.glb", "glTF\2\0\0\0").find("container"), std::string::npos);
  nlohmann::json root = square_gltf();
  root["extensionsRequired"] = nlohmann::json::array({"KHR_draco_mesh_compression"});
  EXPECT_NE(problem("a.gltf", root.dump()).find("KHR_draco_mesh_compression"), std::string::npos);
  root = square_gltf();
  root["accessors"][0]["count"] = 400;
  EXPECT_NE(problem("a.gltf", root.dump()).find("outside its buffer view"), std::string::npos);
  root = square_gltf();
  root["nodes"][0]["children"] = nlohmann::json::array({0});
  EXPECT_NE(problem("a.gltf", root.dump()).find("nested deeper"), std::string::npos);
}

}  // namespace
}  // namespace rebake::test
