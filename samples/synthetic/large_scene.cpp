#include "samples/synthetic/large_scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh_ops/index/numbering.h"

namespace rebake {

namespace {

constexpr int cell = 17;  // side of a quad's patch in texels

// Stateless random numbers in [0, 1), addressed by purpose and indices, so that sets can be created in parallel.
class Numbers {
 public:
  Numbers(unsigned seed, std::uint64_t purpose) : seed_(seed), purpose_(purpose) {}
  double operator()(std::uint64_t which, std::uint64_t part) const {
    // Mixed twice: after one pass, numbers of neighbouring parts are correlated.
    return static_cast<double>(mixed(mixed(which, seed_ * 64 + purpose_, part), part, 7) >> 11) * 0x1p-53;
  }
  double between(double low, double high, std::uint64_t which, std::uint64_t part) const {
    return low + (high - low) * (*this)(which, part);
  }

 private:
  std::uint64_t seed_, purpose_;
};

// A grid of 2×2 or 3×2 quads in space.
struct Piece {
  Vec3 corner, right, up;
  int columns = 2;
};

// Four of five pieces are around the middle, the others on a backdrop. Pieces of 2 columns have 16 vertices at 9
// positions, those of 3 columns have 24 at 12; their mixture gives vertices_per_point.
Piece piece_of(const LargeSceneOptions& options, std::uint64_t number) {
  const Numbers random(options.seed, 1);
  const double narrow_places = 9, wide_places = 12;
  // s is the share of wide pieces: vertices = 16 (1 − s) + 24 s, positions = 9 (1 − s) + 12 s.
  const double r = options.vertices_per_point,
               wide = std::clamp((r * narrow_places - 16) / (8 - r * (wide_places - narrow_places)), 0.0, 1.0);
  const Vec3 direction =
      Vec3(random.between(-1, 1, number, 0), random.between(-1, 1, number, 1), random.between(-1, 1, number, 2))
          .stableNormalized();
  const bool backdrop = random(number, 3) < 0.2;
  const double distance = options.extent * (backdrop ? random.between(0.5, 0.93, number, 4)
                                                     : 0.13 * std::cbrt(random.between(0.02, 1, number, 4)));
  const double size = distance * (backdrop ? 0.02 : 0.01);
  Piece piece;
  piece.columns = random(number, 5) < wide ? 3 : 2;
  const Vec3 across = direction.unitOrthogonal();
  const double turn = random.between(0, 6.283185307179586, number, 6);
  piece.right = size * (std::cos(turn) * across + std::sin(turn) * direction.cross(across));
  piece.up = size * direction.cross(piece.right).normalized();
  piece.corner = distance * direction;
  return piece;
}

// A texel of a quad: features that are smooth over the quad, with noise of up to two quantisation steps, like trained
// features.
Texel texel_of(const LargeSceneOptions& options, std::uint64_t quad, int x, int y) {
  const Numbers random(options.seed, 2), noise(options.seed, 3);
  const double u = static_cast<double>(x) / cell - 0.5, v = static_cast<double>(y) / cell - 0.5;
  // Quads are fully opaque or cut by a random half plane, which leaves half of them opaque on average. The mixture
  // gives opaque_share.
  const double angle = random.between(0, 6.283185307179586, quad, 16);
  const double edge = random.between(-0.5, 0.5, quad, 17);
  const double whole = random(quad, 18);
  const double of_quads = options.opaque_share * options.texture_side * options.texture_side *
                          static_cast<double>(options.sets) * 2 /
                          (static_cast<double>(options.triangles) * cell * cell);
  const double full = 2 * of_quads - 1;  // share of fully opaque quads
  if (whole >= std::max(0.0, full) && std::cos(angle) * u + std::sin(angle) * v > edge)
    return empty_texel(AlphaCode::halved);
  Texel texel;
  for (std::uint64_t k = 0; k < 8; ++k) {
    const double base = random(quad, k), slope = random.between(-0.4, 0.4, quad, 8 + k);
    const double step = noise.between(-2, 2, quad * 289 + static_cast<std::uint64_t>(y * cell + x), k) / 255;
    const double value = std::clamp(base + slope * (k % 2 == 0 ? u : v) + step, 0.0, 1.0);
    auto& byte = k < 4 ? texel.feat0[k] : texel.feat1[k - 4];
    byte = static_cast<std::uint8_t>(std::lround(k % 4 == 3 ? 128 + 127 * value : 255 * value));
  }
  texel.feat0[0] = std::max<std::uint8_t>(texel.feat0[0], 1);
  return texel;
}

TextureSet set_of(const LargeSceneOptions& options, std::size_t number, std::size_t quads) {
  const int side = options.texture_side, columns = side / cell;
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  std::size_t made = 0;
  for (std::uint64_t p = 0; made < quads; ++p) {
    const Piece piece = piece_of(options, (static_cast<std::uint64_t>(number) << 32) + p);
    for (int q = 0; q < piece.columns * 2 && made < quads; ++q, ++made) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      const int column = static_cast<int>(made) % columns, row = static_cast<int>(made) / columns;
      for (const auto& [dx, dy] : {std::array{0, 0}, std::array{1, 0}, std::array{0, 1}, std::array{1, 1}}) {
        positions.push_back(piece.corner + (q / 2 + dx) * piece.right + (q % 2 + dy) * piece.up);
        uvs.emplace_back((column * cell + 0.5 + dx * (cell - 1)) / side,
                         1 - (row * cell + 0.5 + dy * (cell - 1)) / side);
      }
      faces.push_back({first, first + 1, first + 3});
      faces.push_back({first, first + 3, first + 2});
    }
  }
  const std::uint64_t first_quad = static_cast<std::uint64_t>(number) << 32;
  auto texels = std::make_shared<const FeatureTexture>(
      FeatureTexture::from_rows(side, side, AlphaCode::halved, [&, columns](int y, Texel* row) {
        for (int x = 0; x < side; ++x) {
          const std::size_t quad = static_cast<std::size_t>(y / cell) * static_cast<std::size_t>(columns) +
                                   static_cast<std::size_t>(x / cell);
          row[x] = x / cell < columns && quad < quads ? texel_of(options, first_quad + quad, x % cell, y % cell)
                                                      : empty_texel(AlphaCode::halved);
        }
      }));
  return {Soup(std::move(positions), std::move(uvs), std::move(faces)), std::move(texels)};
}

// Random weights of both signs, so that colours cover their whole range.
Decoder decoder_of(const LargeSceneOptions& options) {
  const Numbers random(options.seed, 4);
  std::uint64_t next = 0;
  const auto matrix = [&](int rows, int columns) {
    Eigen::MatrixXd weights(rows, columns);
    for (int c = 0; c < columns; ++c)
      for (int r = 0; r < rows; ++r) weights(r, c) = random.between(-1, 1, next++, 0);
    return weights;
  };
  Decoder decoder;
  decoder.weights0 = matrix(Decoder::inputs, 16);
  decoder.weights1 = matrix(16, 16);
  decoder.weights2 = matrix(16, 3);
  decoder.bias0 = matrix(16, 1);
  decoder.bias1 = matrix(16, 1);
  decoder.bias2 = matrix(3, 1);
  return decoder;
}

}  // namespace

std::shared_ptr<const BakedObject> large_synthetic_scene(const LargeSceneOptions& options) {
  auto object = std::make_shared<BakedObject>();
  object->layout = Layout::chunked;
  object->decoder = std::make_shared<const Decoder>(decoder_of(options));
  object->sets.resize(options.sets);
  tbb::parallel_for(std::size_t{0}, options.sets, [&](std::size_t s) {
    const std::size_t quads = options.triangles / 2;
    object->sets[s] = set_of(options, s, quads * (s + 1) / options.sets - quads * s / options.sets);
  });
  return object;
}

}  // namespace rebake
