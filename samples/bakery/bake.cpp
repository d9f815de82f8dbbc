#include "samples/bakery/bake.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "mesh_ops/training/fit.h"

namespace rebake::bakery {

namespace {

struct TexelSite {
  std::size_t patch;
  double u, v;
  int x, y;
};

double six_decimals(double value) { return std::round(value * 1e6) / 1e6; }

// A cell of a patch that has opaque texels.
struct Quad {
  std::size_t patch;
  int column, row;
  std::vector<TexelSite> texels;
};

std::vector<Quad> quads_of(const Model& model, int cell) {
  std::vector<Quad> quads;
  for (std::size_t p = 0; p < model.patches.size(); ++p) {
    const Patch& patch = model.patches[p];
    for (int row = 0; row < patch.rows; ++row)
      for (int column = 0; column < patch.columns; ++column) {
        Quad quad{p, column, row, {}};
        for (int j = 0; j < cell; ++j)
          for (int i = 0; i < cell; ++i) {
            const double u = (column + i / (cell - 1.0)) / patch.columns, v = (row + j / (cell - 1.0)) / patch.rows;
            if (patch.opaque(u, v)) quad.texels.push_back({p, u, v, i, j});
          }
        if (!quad.texels.empty()) quads.push_back(std::move(quad));
      }
  }
  return quads;
}

// What the decoder and the features are fitted to: colours of all texels, seen by the same eyes.
FitProblem fit_problem(const Model& model, const RadianceField& field, const std::vector<TexelSite>& sites,
                       std::size_t observations) {
  FitProblem problem{sites.size(), observations, {}, {}, {}};
  problem.hints.resize(sites.size());
  problem.fed_directions.resize(sites.size() * observations);
  problem.colors.resize(sites.size() * observations);
  const Mat3 axes = axes_matrix(model.axes);
  std::vector<Vec3> eyes;
  for (std::size_t k = 0; k < observations; ++k)
    eyes.push_back(model
                       .camera((static_cast<double>(k) + 0.5) / static_cast<double>(observations),
                               std::fmod(static_cast<double>(k) * 0.6180339887498949, 1.0))
                       .eye);
  tbb::parallel_for(std::size_t{0}, sites.size(), [&](std::size_t t) {
    const TexelSite& site = sites[t];
    const Vec3 point = model.patches[site.patch].point(site.u, site.v);
    // Hint: the view direction that sees the sun reflected. Highlights are at fed directions near it, which few neurons
    // can detect.
    const Vec3 normal = field.normal(site.patch, site.u, site.v), sun = model.sun.normalized();
    const Vec3 mirrored = axes * (sun - 2 * normal.dot(sun) * normal);
    for (std::size_t c = 0; c < 3; ++c)
      problem.hints[t][c] = static_cast<float>(0.5 + 0.5 * mirrored[static_cast<Eigen::Index>(c)]);
    for (std::size_t c = 0; c < 2; ++c)
      problem.hints[t][3 + c] = static_cast<float>(field.openness(site.patch, site.u, site.v)[c]);
    // All texels are observed by the same eyes, so that errors of neighbours are similar and do not look like grain.
    std::vector<Vec3> directions;
    for (const Vec3& eye : eyes)
      if (field.visible(eye, site.patch, site.u, site.v)) directions.push_back((point - eye).normalized());
    if (directions.empty())
      for (const Vec3& eye : eyes) directions.push_back((point - eye).normalized());
    for (std::size_t k = 0; k < observations; ++k) {
      const Vec3& direction = directions[k % directions.size()];
      const Color color = field.color(site.patch, site.u, site.v, direction);
      const Vec3 fed = axes * direction;
      for (std::size_t c = 0; c < 3; ++c) {
        problem.fed_directions[t * observations + k][c] = static_cast<float>(fed[static_cast<Eigen::Index>(c)]);
        problem.colors[t * observations + k][c] = static_cast<float>(color[static_cast<Eigen::Index>(c)]);
      }
    }
  });
  return problem;
}

}  // namespace

std::shared_ptr<const BakedObject> bake(const Model& model, const RadianceField& field, const BakeOptions& options,
                                        const Progress& progress) {
  const int cell = options.texels_per_side;
  const std::vector<Quad> quads = quads_of(model, cell);
  const int per_row = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(quads.size())))));
  const int width = per_row * cell, height = (static_cast<int>(quads.size()) + per_row - 1) / per_row * cell;

  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  std::vector<TexelSite> sites;
  for (std::size_t q = 0; q < quads.size(); ++q) {
    const Quad& quad = quads[q];
    const Patch& patch = model.patches[quad.patch];
    const int left = static_cast<int>(q) % per_row * cell, top = static_cast<int>(q) / per_row * cell;
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (int corner = 0; corner < 4; ++corner) {
      const int i = corner % 2, j = corner / 2;
      const Vec3 p = patch.point((quad.column + i) / static_cast<double>(patch.columns),
                                 (quad.row + j) / static_cast<double>(patch.rows));
      positions.emplace_back(six_decimals(p.x()), six_decimals(p.y()), six_decimals(p.z()));
      uvs.emplace_back(six_decimals((left + 0.5 + i * (cell - 1)) / width),
                       six_decimals(1 - (top + 0.5 + j * (cell - 1)) / height));
    }
    faces.push_back({first, first + 1, first + 3});
    faces.push_back({first, first + 3, first + 2});
    for (TexelSite site : quad.texels) {
      site.x += left;
      site.y += top;
      sites.push_back(site);
    }
  }

  const FitProblem problem = fit_problem(model, field, sites, static_cast<std::size_t>(options.observations));
  const FitResult fitted = fit(problem, {.epochs = options.epochs}, progress);

  std::vector<Texel> texels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                            empty_texel(AlphaCode::halved));
  for (std::size_t t = 0; t < sites.size(); ++t) {
    Texel& texel = texels[static_cast<std::size_t>(sites[t].y) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(sites[t].x)];
    for (std::size_t c = 0; c < 4; ++c) {
      texel.feat0[c] = fitted.features[t][c];
      texel.feat1[c] = fitted.features[t][c + 4];
    }
  }
  auto object = std::make_shared<BakedObject>();
  object->sets.push_back({Soup(std::move(positions), std::move(uvs), std::move(faces)),
                          std::make_shared<const FeatureTexture>(
                              FeatureTexture::from_rows(width, height, AlphaCode::halved, [&](int y, Texel* row) {
                                std::copy_n(texels.begin() + static_cast<std::ptrdiff_t>(y) * width, width, row);
                              }))});
  object->decoder = std::make_shared<const Decoder>(fitted.decoder);
  object->axes = model.axes;
  object->layout = model.layout;
  return object;
}

}  // namespace rebake::bakery
