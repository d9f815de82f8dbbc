#include "mesh_ops/index/traits.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

constexpr double least_opaque_share = 1e-6;

// Sums of texel bytes; converted to features once per triangle.
struct Sum {
  std::array<std::uint32_t, 8> bytes{};
  std::uint32_t opaque = 0;
  std::uint32_t all = 0;

  // At most 256 texels, whose sums fit into 16 bits, so that one addition adds four bytes.
  void add(const Texel* texels, int count) {
    std::uint64_t even = 0, odd = 0;
    for (int i = 0; i < count; ++i) {
      if (!texels[i].opaque()) continue;
      ++opaque;
      const auto all_bytes = std::bit_cast<std::uint64_t>(texels[i]);
      even += all_bytes & 0x00ff00ff00ff00ffULL;
      odd += all_bytes >> 8 & 0x00ff00ff00ff00ffULL;
    }
    all += static_cast<std::uint32_t>(count);
    for (std::size_t k = 0; k < 4; ++k) {
      bytes[2 * k] += static_cast<std::uint32_t>(even >> 16 * k & 0xffff);
      bytes[2 * k + 1] += static_cast<std::uint32_t>(odd >> 16 * k & 0xffff);
    }
  }
};
static_assert(std::endian::native == std::endian::little && sizeof(Texel) == 8);

// Share of a triangle's area that opaque texels cover, also those whose centres are outside; 0 below a millionth, which
// rounding of UVs can produce. Calls visit(x, y) for these texels.
template <class Visit>
double for_each_opaque_piece(const TextureSet& set, std::size_t f, Visit visit) {
  const FeatureTexture& texels = *set.texels;
  double whole = 0, opaque = 0;
  for_each_texel_piece(texel_corners(set, f), texels.width(), texels.height(),
                       [&](int x, int y, double area, const Vec2& /*centroid*/) {
                         whole += area;
                         if (!texels.opaque(x, y)) return;
                         opaque += area;
                         visit(x, y);
                       });
  return opaque > least_opaque_share * whole ? opaque / whole : 0;
}

TexelTraits looks_of(const TextureSet& set, const TexelReader& reader, std::size_t f) {
  const FeatureTexture& texels = *set.texels;
  const std::array<Vec2, 3> corners = texel_corners(set, f);
  Sum sum;
  for_each_row_inside(corners, texels.width(), texels.height(), [&](int y, int begin, int end) {
    while (begin < end) {
      const int part = std::min(end, (begin / TexelTile::size + 1) * TexelTile::size);
      sum.add(reader.row_part(begin, y), part - begin);
      begin = part;
    }
  });
  if (sum.all == 0) {
    const Vec2 middle = (corners[0] + corners[1] + corners[2]) / 3;
    sum.add(&reader.sample(middle.x() / texels.width(), 1 - middle.y() / texels.height()), 1);
  }
  TexelTraits looks;
  looks.opacity = static_cast<float>(sum.opaque) / static_cast<float>(sum.all);
  if (sum.opaque == 0)
    looks.opacity =
        static_cast<float>(for_each_opaque_piece(set, f, [&](int x, int y) { sum.add(&reader.at(x, y), 1); }));
  if (sum.opaque > 0 && looks.opacity > 0) {
    for (std::size_t k = 0; k < 8; ++k) looks.features[k] = static_cast<float>(sum.bytes[k]) / (255.0F * sum.opaque);
    if (texels.alpha_code() == AlphaCode::halved)
      for (const std::size_t k : {3, 7}) looks.features[k] = 2 * looks.features[k] - 1;
  }
  return looks;
}

// Sets the colours of triangles with opaque texels; one column per triangle.
void set_colors(const Eigen::MatrixXf& colors, TexelTraits* looks) {
  for (Eigen::Index i = 0; i < colors.cols(); ++i)
    if (looks[i].opacity > 0)
      for (Eigen::Index k = 0; k < 3; ++k) looks[i].color[static_cast<std::size_t>(k)] = colors(k, i);
}

// Decodes the colours of a batch of triangles, one per matrix column.
void decode_colors(const Decoder& decoder, TexelTraits* looks, Eigen::Index count) {
  const Eigen::MatrixXf w0 = decoder.weights0.cast<float>().transpose();
  const Eigen::MatrixXf w1 = decoder.weights1.cast<float>().transpose();
  const Eigen::MatrixXf w2 = decoder.weights2.cast<float>().transpose();
  const Eigen::VectorXf b0 = decoder.bias0.cast<float>(), b1 = decoder.bias1.cast<float>(),
                        b2 = decoder.bias2.cast<float>();
  Eigen::MatrixXf features(8, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < 8; ++k) features(k, i) = looks[i].features[static_cast<std::size_t>(k)];
  if (decoder.rule == ColorRule::diffuse) return set_colors(features.middleRows(1, 3), looks);
  const Eigen::MatrixXf base = (w0.leftCols(8) * features).colwise() + b0;
  Eigen::MatrixXf mean = Eigen::MatrixXf::Zero(3, count);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0F, 1.0F}) {
      const Eigen::MatrixXf h0 = (base.colwise() + sign * w0.col(8 + axis)).cwiseMax(0.0F);
      const Eigen::MatrixXf h1 = ((w1 * h0).colwise() + b1).cwiseMax(0.0F);
      const Eigen::MatrixXf out = (w2 * h1).colwise() + b2;
      mean.array() += (1 / (1 + (-out.array()).exp())) / 6;
    }
  if (decoder.rule == ColorRule::diffuse_and_network) mean = (mean + features.middleRows(1, 3)).cwiseMin(1.0F);
  set_colors(mean, looks);
}

// Normal times twice the area. Zero if it is not larger than the rounding of the corners as doubles: the normals of
// such triangles would be random.
Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, cross = ab.cross(ac);
  const double largest = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * largest * (ab.stableNorm() + ac.stableNorm());
  if (cross.stableNorm() <= rounding) return Vec3::Zero();
  return cross;
}

}  // namespace

std::vector<TexelTraits> texel_traits(const TextureSet& set, const Decoder& decoder) {
  std::vector<TexelTraits> looks(set.soup.triangle_count());
  const TexelReader reader(*set.texels);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, looks.size(), 512),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t f = range.begin(); f < range.end(); ++f) looks[f] = looks_of(set, reader, f);
                      decode_colors(decoder, &looks[range.begin()], static_cast<Eigen::Index>(range.size()));
                    });
  return looks;
}

bool shows_opaque(const TextureSet& set, std::size_t triangle) {
  const FeatureTexture& texels = *set.texels;
  const std::array<Vec2, 3> corners = texel_corners(set, triangle);
  bool any = false, opaque = false;
  for_each_texel_inside(corners, texels.width(), texels.height(), [&](int x, int y) {
    any = true;
    opaque = opaque || texels.opaque(x, y);
  });
  if (!any) {
    const Vec2 middle = (corners[0] + corners[1] + corners[2]) / 3;
    opaque = texels.opaque_at(middle.x() / texels.width(), 1 - middle.y() / texels.height());
  }
  return opaque || for_each_opaque_piece(set, triangle, [](int, int) {}) > 0;
}

std::vector<TriangleTraits> triangle_traits(const BakedObject& object,
                                            const std::vector<std::shared_ptr<const std::vector<TexelTraits>>>& looks) {
  std::vector<TriangleTraits> traits(object.triangle_count());
  std::size_t first = 0;
  for (std::size_t s = 0; s < object.sets.size(); ++s) {
    const Soup& soup = object.sets[s].soup;
    tbb::parallel_for(std::size_t{0}, soup.triangle_count(), [&](std::size_t f) {
      const Face& face = soup.faces()[f];
      const std::vector<Vec3>& p = soup.positions();
      const Vec3 cross = area_vector(p[face[0]], p[face[1]], p[face[2]]);
      const TexelTraits& look = (*looks[s])[f];
      TriangleTraits& one = traits[first + f];
      one.features = look.features;
      one.color = look.color;
      one.opacity = look.opacity;
      one.area = cross.stableNorm() / 2;
      const Vec3 normal = cross.stableNormalized();
      for (int k = 0; k < 3; ++k) one.normal[static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
    });
    first += soup.triangle_count();
  }
  return traits;
}

}  // namespace rebake
