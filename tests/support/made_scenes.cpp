#include "tests/support/made_scenes.h"

#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "mesh_ops/base/files.h"
#include "mesh_ops/formats/mobilenerf/feature_png.h"
#include "mesh_ops/formats/mobilenerf/mlp_json.h"
#include "mesh_ops/formats/mobilenerf/obj.h"

namespace rebake::test {

namespace fs = std::filesystem;

Decoder made_decoder(unsigned seed, int hidden0, int hidden1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto matrix = [&](int rows, int columns) {
    Eigen::MatrixXd m(rows, columns);
    for (double& value : m.reshaped())
      value = static_cast<double>(static_cast<float>(normal(random) * 1.6 / std::sqrt(rows)));
    return m;
  };
  const auto vector = [&](int size) { return Eigen::VectorXd(matrix(size, 1) * 0.5); };
  Decoder d;
  d.weights0 = matrix(Decoder::inputs, hidden0);
  d.bias0 = vector(hidden0);
  d.weights1 = matrix(hidden0, hidden1);
  d.bias1 = vector(hidden1);
  d.weights2 = matrix(hidden1, 3);
  d.bias2 = vector(3);
  return d;
}

std::shared_ptr<const BakedObject> made_object(const MadeObject& o) {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  const int per_row = 16;
  const int width = per_row * o.cell + 3, height = (o.columns * o.rows + per_row - 1) / per_row * o.cell;
  const auto point = [&](int column, int row) -> Vec3 {
    const double theta = std::numbers::pi * row / o.rows, phi = 2 * std::numbers::pi * (column % o.columns) / o.columns;
    return o.radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  for (int row = 0; row < o.rows; ++row) {
    for (int column = 0; column < o.columns; ++column) {
      const int k = row * o.columns + column;
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        positions.push_back(point(column + corner % 2, row + corner / 2));
        const double x = k % per_row * o.cell + 0.5 + corner % 2 * (o.cell - 1),
                     y = k / per_row * o.cell + 0.5 + corner / 2 * (o.cell - 1);
        uvs.emplace_back(x / width, 1 - y / height);
      }
      faces.push_back({first, first + 1, first + 3});
      faces.push_back({first, first + 3, first + 2});
    }
  }
  std::mt19937 random(o.seed * 7919);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<std::array<double, 8>> base(static_cast<std::size_t>(o.columns * o.rows)), slope(base.size());
  for (auto& b : base)
    for (double& value : b) value = uniform(random);
  for (auto& s : slope)
    for (double& value : s) value = (uniform(random) - 0.5) * 0.5;
  auto texture = FeatureTexture::from_rows(width, height, o.code, [&](int y, Texel* row) {
    for (int x = 0; x < width; ++x) {
      const int k = y / o.cell * per_row + x / o.cell;
      row[x] = empty_texel(o.code);
      if (x >= per_row * o.cell || k >= o.columns * o.rows) continue;
      const double u = static_cast<double>(x % o.cell) / (o.cell - 1) - 0.5,
                   v = static_cast<double>(y % o.cell) / (o.cell - 1) - 0.5;
      if (o.holes && k % 3 == 0 && u * u + v * v < 0.08) continue;
      for (std::size_t c = 0; c < 8; ++c) {
        const double value = std::clamp(
            base[static_cast<std::size_t>(k)][c] + slope[static_cast<std::size_t>(k)][c] * (u + v), 0.0, 1.0);
        auto& channel = c < 4 ? row[x].feat0[c] : row[x].feat1[c - 4];
        channel = static_cast<std::uint8_t>(std::lround(value * 255));
        if (c % 4 == 3 && o.code == AlphaCode::halved) channel = static_cast<std::uint8_t>(channel / 2 + 128);
      }
      if (row[x].feat0[0] == 0) row[x].feat0[0] = 1;
    }
  });
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back({Soup(positions, uvs, faces), std::make_shared<const FeatureTexture>(std::move(texture))});
  object->decoder = std::make_shared<const Decoder>(made_decoder(o.seed));
  object->axes = o.axes;
  object->layout = o.layout;
  return object;
}

Scene scene_of(std::shared_ptr<const BakedObject> object, const std::string& name) {
  Node node;
  node.name = name;
  node.object = std::move(object);
  return with_added({}, std::move(node), NodeId::none, 0);
}

std::shared_ptr<const FeatureTexture> made_features(const Soup& soup, int width, int height, unsigned seed) {
  std::vector<Texel> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                            empty_texel(AlphaCode::halved));
  for (const Face& face : soup.faces()) {
    double left = 1e9, right = -1, top = 1e9, bottom = -1;
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t v : face) {
      const double x = soup.uvs()[v].x() * width, y = (1 - soup.uvs()[v].y()) * height;
      left = std::min(left, x), right = std::max(right, x), top = std::min(top, y), bottom = std::max(bottom, y);
      centre += soup.positions()[v] / 3;
    }
    for (int y = static_cast<int>(top); y <= static_cast<int>(bottom); ++y)
      for (int x = static_cast<int>(left); x <= static_cast<int>(right); ++x) {
        const double u = (x + 0.5 - left) / (right - left) - 0.5, v = (y + 0.5 - top) / (bottom - top) - 0.5;
        if (u * u + v * v < 0.02) continue;
        Texel& texel =
            texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        for (std::size_t c = 0; c < 8; ++c) {
          // Smooth over space, as real features are.
          const double value =
              0.5 + 0.45 * std::sin((static_cast<double>(c) + 2) * (centre.x() + 0.7 * centre.y() - 0.5 * centre.z()) +
                                    static_cast<double>(c * seed) + 0.3 * (u - v));
          auto& channel = c < 4 ? texel.feat0[c] : texel.feat1[c - 4];
          channel = static_cast<std::uint8_t>(std::lround(value * 255));
          if (c % 4 == 3) channel = static_cast<std::uint8_t>(channel / 2 + 128);
        }
        if (texel.feat0[0] == 0) texel.feat0[0] = 1;
      }
  }
  return std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(
      width, height, AlphaCode::halved,
      [&](int y, Texel* row) { std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * width, width, row); }));
}

std::shared_ptr<const BakedObject> mic_object() {
  const fs::path folder = fs::path(REBAKE_TEST_DATA) / "mic";
  if (!fs::exists(folder / "mlp.json")) return nullptr;
  ObjMesh all;
  for (int j = 0; j < 8; ++j) {
    const fs::path path = folder / ("shape0_" + std::to_string(j) + ".obj");
    const ObjMesh chunk = read_obj(read_file(path), path);
    const auto base = static_cast<std::uint32_t>(all.positions.size());
    all.positions.insert(all.positions.end(), chunk.positions.begin(), chunk.positions.end());
    all.uvs.insert(all.uvs.end(), chunk.uvs.begin(), chunk.uvs.end());
    for (const Face& f : chunk.faces) all.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  }
  auto object = std::make_shared<BakedObject>();
  const Soup soup(all.positions, all.uvs, all.faces);
  object->sets.push_back({soup, made_features(soup, 4096, 4096, 3)});
  object->decoder =
      std::make_shared<const Decoder>(read_mlp_json(read_file(folder / "mlp.json"), folder / "mlp.json").decoder);
  object->layout = Layout::chunked;
  return object;
}

std::shared_ptr<const BakedObject> morpheus_object(const std::string& name, int quads) {
  const fs::path folder = fs::path(REBAKE_TEST_DATA) / "morpheus" / name;
  if (!fs::exists(folder / "mlp.json")) return nullptr;
  const fs::path feat0 = folder / "shape0.pngfeat0.png", feat1 = folder / "shape0.pngfeat1.png";
  const FeatureTexture read =
      read_feature_images(read_file(feat0), feat0, read_file(feat1), feat1, AlphaCode::halved).texels;
  auto object = std::make_shared<BakedObject>();
  Decoder decoder = read_mlp_json(read_file(folder / "mlp.json"), folder / "mlp.json").decoder;
  // This decoder was trained with directions (d + 1) / 2.
  decoder.bias0 += 0.5 * decoder.weights0.bottomRows<3>().colwise().sum().transpose();
  decoder.weights0.bottomRows<3>() *= 0.5;
  object->decoder = std::make_shared<const Decoder>(decoder);
  constexpr int cell = 17;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  const auto point = [&](int column, int row) -> Vec3 {
    const double theta = std::numbers::pi * (0.02 + 0.96 * row / quads), phi = 2 * std::numbers::pi * column / quads;
    const double radius = 1 + 0.08 * std::sin(5 * phi) * std::sin(4 * theta);
    return radius * Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  for (int row = 0; row < quads; ++row)
    for (int column = 0; column < quads; ++column) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (int corner = 0; corner < 4; ++corner) {
        positions.push_back(point(column + corner % 2, row + corner / 2));
        uvs.emplace_back((column * cell + 0.5 + corner % 2 * (cell - 1)) / read.width(),
                         1 - (row * cell + 0.5 + corner / 2 * (cell - 1)) / read.height());
      }
      faces.push_back({first, first + 1, first + 3});
      faces.push_back({first, first + 3, first + 2});
    }
  // Some alphas are 127, which split folders cannot store.
  const TexelReader texels(read);
  object->sets.push_back(
      {Soup(positions, uvs, faces), std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(
                                        read.width(), read.height(), AlphaCode::halved, [&](int y, Texel* row) {
                                          for (int x = 0; x < read.width(); ++x) {
                                            row[x] = texels.at(x, y);
                                            for (auto* feat : {&row[x].feat0, &row[x].feat1})
                                              (*feat)[3] = std::max<std::uint8_t>((*feat)[3], 128);
                                          }
                                        }))});
  return object;
}

std::shared_ptr<const FeatureTexture> with_real_features(const FeatureTexture& texture, const std::string& name,
                                                         int first_column) {
  const fs::path folder = fs::path(REBAKE_TEST_DATA) / "morpheus" / name;
  const fs::path feat0 = folder / "shape0.pngfeat0.png", feat1 = folder / "shape0.pngfeat1.png";
  if (!fs::exists(feat0)) return nullptr;
  const FeatureTexture read =
      read_feature_images(read_file(feat0), feat0, read_file(feat1), feat1, AlphaCode::halved).texels;
  const TexelReader real(read);
  return std::make_shared<const FeatureTexture>(FeatureTexture::from_parts(
      texture.width(), texture.height(), texture.alpha_code(), [&](int y, int count, Texel* rows) {
        for (int row = y; row < y + count; ++row)
          for (int x = 0; x < texture.width(); ++x, ++rows) {
            *rows = empty_texel(texture.alpha_code());
            if (!texture.opaque(x, row)) continue;
            *rows = real.at((x + first_column) % read.width(), row % read.height());
            rows->feat0[0] = std::max<std::uint8_t>(rows->feat0[0], 1);
          }
      }));
}

std::shared_ptr<const BakedObject> tiled(const BakedObject& object) {
  auto result = std::make_shared<BakedObject>(object);
  result->sets.clear();
  const Vec3 step = object.bounds().sizes() * 1.1;
  for (int k = 0; k < 9; ++k)
    for (const TextureSet& set : object.sets) {
      std::vector<Vec3> positions = set.soup.positions();
      for (Vec3& p : positions) p += Vec3(k % 3 * step.x(), 0, k / 3 * step.z());
      result->sets.push_back({Soup(std::make_shared<const std::vector<Vec3>>(std::move(positions)),
                                   set.soup.shared_uvs(), set.soup.shared_faces()),
                              set.texels});
    }
  return result;
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "rebake-test-XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}
TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::map<std::string, std::string> folder_bytes(const fs::path& folder) {
  std::map<std::string, std::string> bytes;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) bytes[fs::relative(entry.path(), folder).string()] = read_file(entry.path());
  return bytes;
}

void write_text(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

}  // namespace rebake::test
