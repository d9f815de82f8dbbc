#include "mesh_ops/features/atlas/erase_texels.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "mesh_ops/index/footprint.h"

namespace rebake {

namespace {

struct TexelAt {
  int x, y;
};

// The point of the triangle nearest to `at`, as corner weights.
Vec3 nearest_weights(const std::array<Vec2, 3>& p, const Vec2& at) {
  const Vec3 w = barycentric(p, at);
  if (w.minCoeff() >= 0) return w;
  Vec3 best(1, 0, 0);
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vec2 &a = p[static_cast<std::size_t>(k)], along = p[static_cast<std::size_t>(next)] - a;
    const double t = along.isZero(0) ? 0 : std::clamp((at - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    const double distance = (a + along * t - at).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best.setZero();
    best[k] = 1 - t;
    best[next] += t;
  }
  return best;
}

// Visits the opaque texels that the triangle may overlap.
template <class Visit>
void for_each_opaque_texel_touched(const FeatureTexture& texels, const std::array<Vec2, 3>& p, Visit visit) {
  const auto texel = [](double v, int size) { return static_cast<int>(std::clamp(std::floor(v), 0.0, size - 1.0)); };
  const Vec2 low = p[0].cwiseMin(p[1]).cwiseMin(p[2]), high = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
  for (int y = texel(low.y(), texels.height()); y <= texel(high.y(), texels.height()); ++y)
    for (int x = texel(low.x(), texels.width()); x <= texel(high.x(), texels.width()); ++x) {
      if (!texels.opaque(x, y)) continue;
      const Vec2 centre(x + 0.5, y + 0.5);
      const Vec3 w = nearest_weights(p, centre);
      // The nearest point, clamped to the texture like a sample, must lie in the texel's square.
      const Vec2 place = (p[0] * w[0] + p[1] * w[1] + p[2] * w[2])
                             .cwiseMax(Vec2(0, 0))
                             .cwiseMin(Vec2(texels.width(), texels.height()));
      if ((place - centre).cwiseAbs().maxCoeff() <= 0.5 + 1e-9) visit(x, y, w);
    }
}

}  // namespace

Erased erase_texels(const BakedObject& object, const std::function<bool(const Vec3&)>& inside,
                    const std::function<bool(const std::array<Vec3, 3>&)>& may_touch) {
  Erased result;
  for (const TextureSet& set : object.sets) {
    tbb::enumerable_thread_specific<std::vector<TexelAt>> found;
    tbb::parallel_for(std::size_t{0}, set.soup.triangle_count(), [&](std::size_t f) {
      const Face& face = set.soup.faces()[f];
      const std::vector<Vec3>& p = set.soup.positions();
      if (!may_touch({p[face[0]], p[face[1]], p[face[2]]})) return;
      std::vector<TexelAt>& mine = found.local();
      for_each_opaque_texel_touched(*set.texels, texel_corners(set, f), [&](int x, int y, const Vec3& w) {
        if (inside(p[face[0]] * w[0] + p[face[1]] * w[1] + p[face[2]] * w[2])) mine.push_back({x, y});
      });
    });
    FeatureTexture::Change change(*set.texels);
    for (const std::vector<TexelAt>& part : found)
      for (const TexelAt& at : part) {
        Texel& texel = change.at(at.x, at.y);
        if (texel.opaque()) ++result.texels;
        texel.feat0[0] = 0;
      }
    result.sets.push_back({set.soup, change.touched() ? change.finish() : set.texels});
  }
  return result;
}

}  // namespace rebake
