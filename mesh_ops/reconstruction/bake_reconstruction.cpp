#include "mesh_ops/reconstruction/bake_reconstruction.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "mesh_ops/base/error.h"
#include "mesh_ops/rays/ray_tree.h"

namespace rebake {

namespace {

constexpr int largest_texture = 4096;
constexpr std::size_t quads_at_once = 1024;

// A quad of the grid, or of a side of a nested box, with its corners in the normalised frame.
struct BakedQuad {
  std::array<Vec3, 4> corners;
  int box = -1;  // −1: of the grid
};

// A quad with its opaque texels, row by row.
struct OpaqueQuad : BakedQuad {
  std::vector<bool> opaque;
};

// Where texel (column, row) of a quad lies, in the normalised frame: linear on each of its two triangles.
Vec3 place_of(const std::array<Vec3, 4>& p, double across, double down) {
  return across >= down ? Vec3(p[0] + across * (p[1] - p[0]) + down * (p[3] - p[1]))
                        : Vec3(p[0] + down * (p[2] - p[0]) + across * (p[3] - p[2]));
}

FieldPoint field_point(const Vec3& place) {
  return {static_cast<float>(place.x()), static_cast<float>(place.y()), static_cast<float>(place.z())};
}

// The sides of the nested boxes, in quads of about the texels of the photographs.
void add_box_quads(const Reconstruction& trained, int samples, std::vector<BakedQuad>& quads) {
  const GridSpace& space = trained.grid().space();
  int pixels = 0;
  for (const FitPhotograph& one : trained.views().photographs())
    pixels = std::max(pixels, std::max(one.width, one.height));
  // A side spans about 90 degrees, twice what a photograph does.
  const int per_side = std::clamp(2 * pixels / samples, 4, 64);
  for (int box = 0; box < space.boxes(); ++box) {
    const double radius = space.box_radius(box), step = 2 * radius / per_side;
    for (int side = 0; side < 4; ++side)
      for (int row = 0; row < per_side; ++row)
        for (int column = 0; column < per_side; ++column) {
          BakedQuad quad;
          quad.box = box;
          for (int corner = 0; corner < 4; ++corner) {
            const int right = column + corner % 2, above = row + corner / 2;
            const double along = -radius + step * right, up = -radius + step * above,
                         out = side % 2 == 0 ? radius : -radius;
            quad.corners[static_cast<std::size_t>(corner)] = side < 2 ? Vec3(out, along, up) : Vec3(along, out, up);
          }
          quads.push_back(quad);
        }
  }
}

// The quads between cells that may hold surface.
std::vector<BakedQuad> candidates_of(const Reconstruction& trained) {
  const GridSpace& space = trained.grid().space();
  std::vector<BakedQuad> quads;
  for (std::uint32_t cell = 0; cell < space.cell_count(); ++cell) {
    const std::array<int, 3> first = space.cell_of_number(cell);
    for (int axis = 0; axis < 3; ++axis) {
      const auto cells = GridQuad{axis, first}.cells();
      BakedQuad quad{};
      bool inside = true, near_surface = false;
      for (std::size_t k = 0; k < 4; ++k) {
        inside = inside &&
                 std::all_of(cells[k].begin(), cells[k].end(), [&](int i) { return i >= 1 && i <= space.side() - 2; });
        if (!inside) break;
        const std::uint32_t number = space.cell_number(cells[k][0], cells[k][1], cells[k][2]);
        quad.corners[k] = trained.grid().positions()[number];
        near_surface = near_surface || trained.active()[number] != 0;
      }
      if (inside && near_surface) quads.push_back(quad);
    }
  }
  return quads;
}

// Places of texels in the fields.
class TexelSampler {
 public:
  TexelSampler(const Reconstruction& trained, int samples) : trained_(trained), side_(samples + 1) {}
  int samples() const { return side_ - 1; }
  std::size_t texels_each() const { return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_); }
  /// The place of a texel of a quad. False if it cannot be opaque: in cells without surface.
  bool place(const BakedQuad& quad, std::size_t texel, FieldPoint& point) const {
    const GridSpace& space = trained_.grid().space();
    const std::size_t side = static_cast<std::size_t>(side_), row_number = texel / side;
    const auto column = static_cast<double>(texel % side), row = static_cast<double>(row_number);
    const Vec3 at = place_of(quad.corners, column / (side_ - 1), row / (side_ - 1));
    if (quad.box >= 0) {
      point = field_point(space.box_place(quad.box, at));
      return true;
    }
    const Vec3 cells = space.to_cells(at);
    for (int axis = 0; axis < 3; ++axis)
      if (!(cells[axis] >= 1 && cells[axis] < space.side() - 1)) return false;
    point = field_point(space.field_place(cells));
    return trained_.active()[space.cell_number(static_cast<int>(cells.x()), static_cast<int>(cells.y()),
                                               static_cast<int>(cells.z()))] != 0;
  }

 private:
  const Reconstruction& trained_;
  int side_;
};

std::vector<OpaqueQuad> opaque_quads(const Reconstruction& trained, const TexelSampler& sampler,
                                     const Progress& progress) {
  std::vector<BakedQuad> candidates = candidates_of(trained);
  add_box_quads(trained, sampler.samples(), candidates);
  const std::size_t each = sampler.texels_each();
  std::vector<OpaqueQuad> result;
  for (std::size_t begin = 0; begin < candidates.size(); begin += quads_at_once) {
    progress.at("finding opaque texels", static_cast<double>(begin) / static_cast<double>(candidates.size()));
    const std::size_t count = std::min(quads_at_once, candidates.size() - begin);
    std::vector<std::vector<FieldPoint>> points(count);
    std::vector<std::vector<std::uint32_t>> texels(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t q) {
      FieldPoint point;
      for (std::uint32_t t = 0; t < each; ++t)
        if (sampler.place(candidates[begin + q], t, point)) {
          points[q].push_back(point);
          texels[q].push_back(t);
        }
    });
    std::vector<FieldPoint> all;
    for (const auto& some : points) all.insert(all.end(), some.begin(), some.end());
    std::vector<float> opacities;
    trained.fields().opacity->evaluate(all, opacities);
    std::size_t next = 0;
    for (std::size_t q = 0; q < count; ++q) {
      OpaqueQuad quad{{candidates[begin + q]}, std::vector<bool>(each)};
      bool any = false;
      for (const std::uint32_t t : texels[q]) {
        quad.opaque[t] = opacities[next++] > 0.5F;
        any = any || quad.opaque[t];
      }
      if (any) result.push_back(std::move(quad));
    }
  }
  return result;
}

// Texture sets of quads, in rows of patches. `triangles`: per quad and half, whether it is kept.
std::vector<TextureSet> sets_of(const Reconstruction& trained, const std::vector<OpaqueQuad>& quads,
                                const std::vector<std::array<bool, 2>>& triangles,
                                const std::vector<std::vector<Texel>>& texels, int patch) {
  const std::size_t most_per_row = static_cast<std::size_t>(largest_texture / patch),
                    most = most_per_row * most_per_row;
  const Affine to_scene = trained.plan().to_unit.inverse();
  std::vector<TextureSet> sets;
  for (std::size_t begin = 0; begin < quads.size(); begin += most) {
    const std::size_t count = std::min(most, quads.size() - begin),
                      per_row = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count)))),
                      rows = (count + per_row - 1) / per_row;
    const int width = static_cast<int>(per_row) * patch, height = static_cast<int>(rows) * patch;
    std::vector<Vec3> positions;
    std::vector<Vec2> uvs;
    std::vector<Face> faces;
    for (std::size_t q = 0; q < count; ++q) {
      const std::size_t row = q / per_row;
      const double left = static_cast<double>(q % per_row) * patch, top = static_cast<double>(row) * patch;
      const auto first = static_cast<std::uint32_t>(positions.size());
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const std::size_t down = corner / 2;
        positions.emplace_back(to_scene * quads[begin + q].corners[corner]);
        uvs.emplace_back((left + 0.5 + static_cast<double>(corner % 2) * (patch - 1)) / width,
                         1 - (top + 0.5 + static_cast<double>(down) * (patch - 1)) / height);
      }
      for (std::size_t half = 0; half < 2; ++half)
        if (triangles[begin + q][half]) {
          Face face;
          for (std::size_t k = 0; k < 3; ++k) face[k] = first + static_cast<std::uint32_t>(quad_triangles[half][k]);
          faces.push_back(face);
        }
    }
    const auto texture = FeatureTexture::from_rows(width, height, AlphaCode::halved, [&](int y, Texel* row) {
      std::fill_n(row, width, empty_texel(AlphaCode::halved));
      const auto line = static_cast<std::size_t>(y);
      const auto side = static_cast<std::size_t>(patch);
      for (std::size_t k = 0; k < per_row; ++k) {
        const std::size_t q = line / side * per_row + k;
        if (q < count)
          std::copy_n(texels[begin + q].begin() + static_cast<std::ptrdiff_t>(line % side * side), side,
                      row + k * side);
      }
    });
    sets.push_back({Soup(std::move(positions), std::move(uvs), std::move(faces)),
                    std::make_shared<const FeatureTexture>(texture)});
  }
  return sets;
}

// Cameras on a sphere around the object: 60 per height, at five heights between those of the photographs' cameras.
std::vector<FitPhotograph> views_around(const TrainingViews& views) {
  const std::vector<FitPhotograph>& photographs = views.photographs();
  Vec3 middle = Vec3::Zero();
  for (const FitPhotograph& one : photographs) middle += one.camera.target / static_cast<double>(photographs.size());
  double squares = 0, mean = 0, least = std::numeric_limits<double>::infinity(), most = -least;
  for (const FitPhotograph& one : photographs) {
    const Vec3 from = one.camera.eye - middle;
    squares += from.squaredNorm() / static_cast<double>(photographs.size());
    mean += from.y() / static_cast<double>(photographs.size());
    least = std::min(least, from.y());
    most = std::max(most, from.y());
  }
  const double radius = std::sqrt(squares);
  constexpr int around = 60;
  std::vector<FitPhotograph> result;
  for (const double height :
       {mean, 0.6 * mean + 0.4 * most, 0.2 * mean + 0.8 * most, 0.6 * mean + 0.4 * least, 0.2 * mean + 0.8 * least}) {
    const double y = std::clamp(height, -0.999 * radius, 0.999 * radius), across = std::sqrt(radius * radius - y * y);
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      FitPhotograph view;
      view.camera = photographs[0].camera;
      view.camera.eye = middle + Vec3(across * std::cos(angle), y, across * std::sin(angle));
      view.camera.target = middle;
      view.camera.up = Vec3::UnitY();
      view.width = photographs[0].width;
      view.height = photographs[0].height;
      result.push_back(std::move(view));
    }
  }
  return result;
}

// Flags the triangles that rays through the pixels of a view hit first.
void flag_visible(const RayTree& tree, const FitPhotograph& view, double rows, double nearest,
                  std::vector<std::atomic<bool>>& seen) {
  // Slim triangles must not fall between the rays.
  const double finer = std::max(2.0, std::ceil(rows / view.height));
  const int width = static_cast<int>(view.width * finer), height = static_cast<int>(view.height * finer);
  const Mat3 to_scene = world_to_camera(view.camera).transpose();
  const double focal = height / (2 * std::tan(view.camera.fov_degrees * std::numbers::pi / 360));
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; x += 8) {
      RayTree::Bundle rays{};
      for (int k = 0; k < 8; ++k) {
        const auto lane = static_cast<std::size_t>(k);
        rays.origins[lane] = view.camera.eye;
        rays.directions[lane] = (to_scene * Vec3((std::min(x + k, width - 1) + 0.5 - width / 2.0) / focal,
                                                 -(y + 0.5 - height / 2.0) / focal, -1))
                                    .normalized();
        rays.far[lane] = 1e30;
      }
      tree.nearest(rays, nearest);
      for (std::size_t lane = 0; lane < 8; ++lane)
        if (rays.hit[lane]) seen[rays.triangle[lane]].store(true, std::memory_order_relaxed);
    }
  });
}

// Per quad: which halves are visible.
std::vector<std::array<bool, 2>> visible_halves(const Reconstruction& trained, const std::vector<OpaqueQuad>& quads,
                                                const BakeReconstructionOptions& options, const Progress& progress) {
  const int patch = options.samples + 1;
  const std::vector<std::array<bool, 2>> all(quads.size(), {true, true});
  std::vector<std::vector<Texel>> texels(quads.size());
  for (std::size_t q = 0; q < quads.size(); ++q)
    for (const bool opaque : quads[q].opaque) {
      Texel texel = empty_texel(AlphaCode::halved);
      texel.feat0[0] = opaque ? 255 : 0;
      texels[q].push_back(texel);
    }
  BakedObject object;
  object.sets = sets_of(trained, quads, all, texels, patch);
  const RayTree tree(object);
  std::vector<std::atomic<bool>> seen(2 * quads.size());
  std::vector<FitPhotograph> around;
  if (options.views_around && trained.plan().kind == CaptureKind::object) around = views_around(trained.views());
  const std::vector<FitPhotograph>& photographs = trained.views().photographs();
  const std::size_t total = photographs.size() + around.size();
  constexpr double rows = 512, rows_around = 256;
  // As in training.
  const double nearest = trained.grid().space().nearest() / trained.plan().to_unit.linear().col(0).norm();
  for (std::size_t k = 0; k < total; ++k) {
    progress.at("finding visible triangles", static_cast<double>(k) / static_cast<double>(total));
    if (k < photographs.size())
      flag_visible(tree, photographs[k], rows, nearest, seen);
    else
      flag_visible(tree, around[k - photographs.size()], rows_around, nearest, seen);
  }
  std::vector<std::array<bool, 2>> visible(quads.size());
  for (std::size_t q = 0; q < quads.size(); ++q) visible[q] = {seen[2 * q].load(), seen[2 * q + 1].load()};
  return visible;
}

// Bytes of a texel, as the published exporter writes them into split folders.
Texel texel_of(const float* features) {
  const auto byte = [&](std::size_t k) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(features[k], 0.0F, 1.0F)));
  };
  const auto halved = [&](std::size_t k) { return static_cast<std::uint8_t>(128 + byte(k) / 2); };
  return {{std::max<std::uint8_t>(1, byte(0)), byte(1), byte(2), halved(3)}, {byte(4), byte(5), byte(6), halved(7)}};
}

std::vector<std::vector<Texel>> texels_of(const Reconstruction& trained, const std::vector<OpaqueQuad>& quads,
                                          const TexelSampler& sampler, std::size_t& opaque, const Progress& progress) {
  std::vector<std::vector<Texel>> result(quads.size(),
                                         std::vector<Texel>(sampler.texels_each(), empty_texel(AlphaCode::halved)));
  for (std::size_t begin = 0; begin < quads.size(); begin += quads_at_once) {
    progress.at("baking features", static_cast<double>(begin) / static_cast<double>(quads.size()));
    std::vector<FieldPoint> points;
    std::vector<Texel*> places;
    for (std::size_t q = begin; q < std::min(quads.size(), begin + quads_at_once); ++q)
      for (std::size_t t = 0; t < sampler.texels_each(); ++t)
        if (FieldPoint point; quads[q].opaque[t] && sampler.place(quads[q], t, point)) {
          points.push_back(point);
          places.push_back(&result[q][t]);
        }
    std::vector<float> features;
    trained.fields().features->evaluate(points, features);
    for (std::size_t k = 0; k < places.size(); ++k) *places[k] = texel_of(&features[k * texel_features]);
    opaque += places.size();
  }
  return result;
}

}  // namespace

std::shared_ptr<const BakedObject> bake(const Reconstruction& trained, const BakeReconstructionOptions& options,
                                        BakeReconstructionCounts& counts, const Progress& progress) {
  const TexelSampler sampler(trained, options.samples);
  std::vector<OpaqueQuad> quads = opaque_quads(trained, sampler, progress);
  counts = {quads.size(), quads.size(), 0};
  if (quads.empty())
    throw Error("nothing is opaque: train longer, or check that the cameras belong to the photographs");
  std::vector<std::array<bool, 2>> halves(quads.size(), {true, true});
  if (options.visible_only) {
    halves = visible_halves(trained, quads, options, progress);
    std::size_t kept = 0;
    for (std::size_t q = 0; q < quads.size(); ++q)
      if (halves[q][0] || halves[q][1]) {
        if (kept != q) quads[kept] = std::move(quads[q]);
        halves[kept++] = halves[q];
      }
    quads.resize(kept);
    halves.resize(kept);
    if (quads.empty()) throw Error("no photograph sees anything of the trained scene: train longer");
  }
  counts.visible_quads = quads.size();
  const auto texels = texels_of(trained, quads, sampler, counts.opaque_texels, progress);
  auto object = std::make_shared<BakedObject>();
  object->sets = sets_of(trained, quads, halves, texels, options.samples + 1);
  object->decoder = std::make_shared<const Decoder>(trained.decoder().to_decoder());
  object->axes = trained_axes;
  object->layout = Layout::split;
  return object;
}

}  // namespace rebake
