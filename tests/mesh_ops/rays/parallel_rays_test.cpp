// ParallelRays gives the same results as single rays.
#include "mesh_ops/rays/parallel_rays.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::uint8_t> hidden_from(const ParallelRays& rays, const Vec3& direction,
                                      const std::vector<std::int8_t>& ways) {
  std::vector<std::uint8_t> hidden(ways.size(), 0);
  rays.shade(direction, 0, ways, hidden);
  return hidden;
}

// Results may differ only if a ray passes close to an edge: rays next to it then give both results.
TEST(ParallelRays, MatchSingleRays) {
  const auto object = made_object({.columns = 24, .rows = 12});
  const auto tree = std::make_shared<const RayTree>(*object);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto some = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (const double scale : {1.0, 1e-6, 1e6}) {
    SCOPED_TRACE(scale);
    std::vector<SceneRays::Instance> instances;
    for (int k = 0; k < 5; ++k) {
      // Some mirrored or scaled non-uniformly; some with a limited reach.
      Affine place = Affine::Identity();
      place.translate(scale * 2 * some()).rotate(Eigen::AngleAxisd(3 * unit(random), some().normalized()));
      place.scale(scale * Vec3(k % 2 == 0 ? -1 : 1, std::pow(3, unit(random)), 0.5));
      instances.push_back({tree, place, object->bounds().diagonal().norm(),
                           k % 3 == 0 ? 1.5 * scale : std::numeric_limits<double>::infinity()});
    }
    const SceneRays around(instances);
    std::vector<Vec3> origins;
    std::vector<std::int8_t> ways;
    for (int k = 0; k < 3000; ++k) {
      origins.push_back(scale * (k % 10 == 0 ? 50 : 2.5) * some());
      ways.push_back(static_cast<std::int8_t>(k % 7 == 0 ? 0 : k % 2 == 0 ? 1 : -1));
    }
    origins[5] = Vec3(0, quiet_nan, 0);
    const ParallelRays rays(around, origins);
    int shaded = 0, at_borders = 0, asked = 0;
    for (int turn = 0; turn < 12; ++turn) {
      const Vec3 direction = turn == 0 ? Vec3(Vec3::UnitY()) : some().normalized();
      std::vector<std::uint8_t> hidden(ways.size(), 0);
      // In one call, or in two.
      const std::size_t half = turn % 2 == 0 ? 0 : 1111;
      rays.shade(direction, 0, std::span(ways).first(half), std::span(hidden).first(half));
      rays.shade(direction, half, std::span(ways).subspan(half), std::span(hidden).subspan(half));
      for (std::size_t k = 0; k < origins.size(); ++k) {
        const Vec3 way = ways[k] * direction;
        if (ways[k] == 0 || !origins[k].allFinite()) {
          EXPECT_EQ(hidden[k], 0) << "disabled in the light settings";
          continue;
        }
        ++asked;
        shaded += hidden[k];
        if ((hidden[k] != 0) == around.shaded(origins[k], way)) continue;
        ++at_borders;
        bool any = false, all = true;
        for (int near = 0; near < 64; ++near) {
          const bool one = around.shaded(origins[k] + 1e-5 * scale * some(), way);
          any |= one;
          all &= one;
        }
        EXPECT_TRUE(any && !all) << "origin " << origins[k].transpose() << " way " << way.transpose();
      }
    }
    EXPECT_GT(shaded, asked / 8);
    EXPECT_LT(shaded, asked * 9 / 10);
    EXPECT_LT(at_borders, asked / 2000);
  }
}

TEST(ParallelRays, FewRaysAreTracedSingly) {
  const auto object = made_object({.columns = 24, .rows = 12});
  const SceneRays around(
      {{std::make_shared<const RayTree>(*object), Affine::Identity(), object->bounds().diagonal().norm()}});
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Vec3> origins;
  for (int k = 0; k < 12; ++k) origins.emplace_back(unit(random), unit(random), unit(random));
  const ParallelRays rays(around, origins);
  int shaded = 0;
  for (int turn = 0; turn < 60; ++turn) {
    const Vec3 direction = Vec3(unit(random), unit(random), unit(random)).normalized();
    const auto hidden = hidden_from(rays, direction, std::vector<std::int8_t>(origins.size(), -1));
    for (std::size_t k = 0; k < origins.size(); ++k) {
      EXPECT_EQ(hidden[k] != 0, around.shaded(origins[k], -direction));
      shaded += hidden[k];
    }
  }
  EXPECT_GT(shaded, 100);
}

// A subset of the triangles of an object with two texture sets, called from many threads, with points clustered in a
// small part of their bounding box.
TEST(ParallelRays, SubsetsThreadsAndClusteredPoints) {
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 24, .rows = 12}));
  object->sets.push_back(made_object({.columns = 24, .rows = 12, .radius = 0.6})->sets[0]);
  std::vector<std::uint32_t> some;
  for (std::uint32_t f = 0; f < object->triangle_count(); ++f)
    if (f % 3 != 1) some.push_back(f);
  const auto tree = std::make_shared<const RayTree>(std::make_shared<const RayTriangles>(*object, some), *object);
  const SceneRays around({{tree, Affine::Identity(), object->bounds().diagonal().norm()}});
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vec = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (const double crowded : {1.0, 1e-4}) {
    std::vector<Vec3> origins;
    for (int k = 0; k < 4000; ++k) origins.push_back(k < 4 ? vec() : Vec3(Vec3(0.3, 0.1, 0.2) + crowded * vec()));
    const ParallelRays rays(around, origins);
    std::vector<Vec3> directions;
    for (int k = 0; k < 16; ++k) directions.push_back(vec().normalized());
    const std::vector<std::int8_t> ways(origins.size(), 1);
    std::vector<std::vector<std::uint8_t>> hidden(directions.size());
    tbb::parallel_for(std::size_t{0}, directions.size(),
                      [&](std::size_t k) { hidden[k] = hidden_from(rays, directions[k], ways); });
    std::size_t others = 0, shaded = 0;
    for (std::size_t k = 0; k < directions.size(); ++k)
      for (std::size_t i = 0; i < origins.size(); ++i) {
        others += (hidden[k][i] != 0) != around.shaded(origins[i], directions[k]) ? 1 : 0;
        shaded += hidden[k][i];
      }
    EXPECT_LT(others, directions.size() * origins.size() / 2000);
    EXPECT_GT(shaded, directions.size() * origins.size() / 10);
    EXPECT_LT(shaded, directions.size() * origins.size() * 9 / 10);
  }
}

// No ray leaves a closed surface, not even through edges and corners.
TEST(ParallelRays, NothingLeaksThroughSharedEdges) {
  for (const int rows : {8, 60}) {
    const auto object = made_object({.columns = 2 * rows, .rows = rows, .cell = 5, .holes = false});
    const Soup& soup = object->sets[0].soup;
    const SceneRays around(
        {{std::make_shared<const RayTree>(*object), Affine::Identity(), object->bounds().diagonal().norm()}});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1), along(0, 1);
    for (int turn = 0; turn < 8; ++turn) {
      const Vec3 direction =
          turn == 0 ? Vec3(Vec3::UnitX()) : Vec3(unit(random), unit(random), unit(random)).normalized();
      std::vector<Vec3> origins;
      std::vector<std::int8_t> ways;
      while (origins.size() < 20000) {
        const Face& face = soup.faces()[random() % soup.triangle_count()];
        const std::size_t k = random() % 3;
        const Vec3 &a = soup.positions()[face[k]], &b = soup.positions()[face[(k + 1) % 3]];
        const Vec3 at = a + (random() % 4 == 0 ? 0 : along(random)) * (b - a);
        const double towards = at.normalized().dot(direction);
        if (std::abs(towards) < 0.3) continue;
        ways.push_back(towards > 0 ? 1 : -1);
        origins.push_back(at - 0.4 * ways.back() * direction);
      }
      const auto hidden = hidden_from(ParallelRays(around, origins), direction, ways);
      EXPECT_EQ(std::count(hidden.begin(), hidden.end(), 0), 0) << rows << " rows, " << direction.transpose();
    }
  }
}

// A flat, finely tessellated patch in any orientation does not occlude points just above it.
TEST(ParallelRays, NoSelfOcclusionJustAboveASurface) {
  constexpr std::uint32_t side = 64;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 2, .holes = false}));
  const Vec2 uv = object->sets[0].soup.uvs()[0];
  for (int turn = 0; turn < 4; ++turn) {
    const Mat3 turned = Eigen::AngleAxisd(3 * unit(random), Vec3(unit(random), unit(random), unit(random)).normalized())
                            .toRotationMatrix();
    std::vector<Vec3> positions;
    std::vector<Face> faces;
    for (std::uint32_t row = 0; row < side; ++row)
      for (std::uint32_t column = 0; column < side; ++column) {
        positions.push_back(turned * Vec3(column / 63.0 - 0.5, 0, row / 63.0 - 0.5));
        if (row + 1 == side || column + 1 == side) continue;
        const std::uint32_t a = row * side + column;
        faces.push_back({a, a + 1, a + side + 1});
        faces.push_back({a, a + side + 1, a + side});
      }
    const std::size_t count = positions.size();
    object->sets[0].soup = Soup(std::make_shared<const std::vector<Vec3>>(std::move(positions)),
                                std::make_shared<const std::vector<Vec2>>(count, uv),
                                std::make_shared<const std::vector<Face>>(std::move(faces)));
    const SceneRays around({{std::make_shared<const RayTree>(*object), Affine::Identity(), 1.5}});
    const Vec3 normal = turned.col(1);
    for (const double offset : {1e-6, 1e-7}) {
      std::vector<Vec3> origins;
      for (int k = 0; k < 4000; ++k)
        origins.push_back(turned * Vec3(0.49 * unit(random), 0, 0.49 * unit(random)) + offset * normal);
      const ParallelRays rays(around, origins);
      std::ptrdiff_t hidden = 0;
      for (int sent = 0; sent < 8; ++sent) {
        Vec3 direction = Vec3(unit(random), unit(random), unit(random)).normalized();
        if (direction.dot(normal) < 0) direction = -direction;
        const auto found = hidden_from(rays, direction, std::vector<std::int8_t>(origins.size(), 1));
        hidden += std::count(found.begin(), found.end(), 1);
      }
      EXPECT_EQ(hidden, 0) << offset;
    }
  }
}

TEST(ParallelRays, DegeneratePointsAndTriangles) {
  // A square of two triangles, a degenerate triangle, and one with a NaN corner.
  auto object = std::make_shared<BakedObject>(*made_object({.columns = 4, .rows = 2, .holes = false}));
  const Soup& soup = object->sets[0].soup;
  std::vector<Vec3> positions{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 2, 0}, {quiet_nan, 2, 0}};
  std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}, {4, 4, 0}, {1, 2, 5}};
  object->sets[0].soup = Soup(std::make_shared<const std::vector<Vec3>>(positions),
                              std::make_shared<const std::vector<Vec2>>(positions.size(), soup.uvs()[0]),
                              std::make_shared<const std::vector<Face>>(faces));
  const SceneRays around({{std::make_shared<const RayTree>(*object), Affine::Identity(), 3.0}});
  const auto hidden = [&](std::vector<Vec3> origins, const Vec3& direction) {
    return hidden_from(ParallelRays(around, origins), direction, std::vector<std::int8_t>(origins.size(), 1));
  };
  const Vec3 up = Vec3::UnitY();
  EXPECT_TRUE(hidden({}, up).empty());
  EXPECT_EQ(hidden(std::vector<Vec3>(40, Vec3(0.1, -1, 0.2)), up), std::vector<std::uint8_t>(40, 1)) << "one place";
  EXPECT_EQ(hidden(std::vector<Vec3>(40, Vec3(0.1, 1, 0.2)), up), std::vector<std::uint8_t>(40, 0));
  std::vector<Vec3> line, tower;
  for (int k = 0; k < 40; ++k) line.emplace_back(-0.9 + 0.045 * k, -1, 0.3);
  for (int k = 0; k < 40; ++k) tower.emplace_back(0.1, k < 20 ? -1 - k : k, 0.3);
  EXPECT_EQ(hidden(line, up), std::vector<std::uint8_t>(40, 1)) << "on one line";
  const auto half = hidden(tower, up);
  for (std::size_t k = 0; k < half.size(); ++k) EXPECT_EQ(half[k], k < 20 ? 1 : 0) << "along the line of sight, " << k;
  EXPECT_EQ(hidden(line, Vec3::UnitX()), std::vector<std::uint8_t>(40, 0)) << "triangles seen edge-on";
  std::vector<Vec3> far(40, Vec3(0.1, -1e7, 0.2));
  EXPECT_EQ(hidden(far, up), std::vector<std::uint8_t>(40, 1)) << "from afar";
}

// Triangles seen edge-on and points on their extension. SIMD batches also contain points behind a cell's last, which
// must not be marked.
TEST(ParallelRays, KernelsAgreeOnEdgeOnTriangles) {
  std::mt19937 random(6);
  std::uniform_real_distribution<float> unit(-0.5F, 0.5F);
  constexpr std::size_t points = 4096, triangles = 60, cells = 64;
  const std::array<float, 2> line{0.8F, 0.6F};  // direction of the line on which everything is projected
  std::array<std::vector<float>, 9> columns;
  for (std::vector<float>& column : columns)
    column.assign(triangles + PointGrid::room, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t t = 0; t < triangles; ++t) {
    const float middle = unit(random);
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const float place = middle + 0.02F * unit(random);
      columns[3 * corner][t] = place * line[0];
      columns[3 * corner + 1][t] = place * line[1];
      columns[3 * corner + 2][t] = unit(random);
    }
  }
  std::vector<float> places(points);
  std::generate(places.begin(), places.end(), [&] { return unit(random); });
  std::sort(places.begin(), places.end());
  std::array<std::vector<float>, 3> at;
  for (std::vector<float>& column : at)
    column.assign(points + PointGrid::room, std::numeric_limits<float>::quiet_NaN());
  std::vector<std::uint32_t> first(cells + 1, points);
  std::vector<std::uint16_t> columns_of(2048), rows_of(2048, 0);
  for (std::size_t p = 0; p < columns_of.size(); ++p) columns_of[p] = static_cast<std::uint16_t>(p * cells / 2048);
  for (std::size_t i = points; i-- > 0;) {
    at[0][i] = places[i] * line[0];
    at[1][i] = places[i] * line[1];
    at[2][i] = unit(random);
    first[columns_of[static_cast<std::size_t>((at[0][i] + 0.5F) * 2047)]] = static_cast<std::uint32_t>(i);
  }
  for (std::size_t c = cells; c-- > 0;) first[c] = std::min(first[c], first[c + 1]);
  const std::vector<std::int32_t> along(points + PointGrid::room, 0);
  const PointGrid grid{at[0], at[1], at[2], along, first, columns_of, rows_of, cells, 1, -0.5F, -0.5F, 2047, 2047};
  CornerColumns corners{};
  for (std::size_t k = 0; k < 9; ++k) corners[k] = columns[k].data();
  std::vector<std::vector<std::int32_t>> found;
  for (const ParallelKernels* kernels : all_parallel_kernels()) {
    found.emplace_back(points + PointGrid::room, 0);
    kernels->mark_covered(corners, triangles, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, grid,
                          std::numeric_limits<float>::infinity(), {nullptr, nullptr}, found.back().data());
    EXPECT_EQ(found.back(), found.front());
  }
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < points; ++i) {
    bool reached = false;
    for (std::size_t t = 0; t < triangles; ++t) {
      const auto [least, most] = std::minmax({columns[0][t], columns[3][t], columns[6][t]});
      reached |= at[0][i] >= least - 2e-6F && at[0][i] <= most + 2e-6F;
    }
    if (reached) continue;
    ++beyond;
    EXPECT_EQ(found.front()[i], 0) << "point " << i;
  }
  EXPECT_GT(beyond, 100U);
}

// All kernels give the same bits. They agree with double precision, unless a point lies within float rounding of an
// edge or of the triangle's plane.
TEST(ParallelRays, KernelsAgreeBitwiseAndWithDouble) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-0.5F, 0.5F);
  constexpr std::size_t points = 700, triangles = 203;
  std::array<std::vector<float>, 9> columns;
  for (std::size_t k = 0; k < 9; ++k) {
    columns[k].assign(triangles + PointGrid::room, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t t = 0; t < triangles; ++t)
      columns[k][t] = k < 3 ? unit(random) : columns[k - 3][t] + 0.4F * unit(random);
  }
  std::array<std::vector<float>, 3> at;
  for (std::vector<float>& column : at) {
    column.assign(points + PointGrid::room, std::numeric_limits<float>::quiet_NaN());
    std::generate_n(column.begin(), points, [&] { return unit(random); });
  }
  std::vector<std::int32_t> along(points + PointGrid::room, 0);
  for (std::size_t i = 0; i < points; ++i) along[i] = i % 3 == 0 ? -1 : 0;
  // One cell holds all points.
  const std::vector<std::uint32_t> first{0, points};
  const std::vector<std::uint16_t> cell(2048, 0);
  const PointGrid grid{at[0], at[1], at[2], along, first, cell, cell, 1, 1, -0.5F, -0.5F, 2047, 2047};
  const LineAxes axes{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CornerColumns corners{};
  for (std::size_t k = 0; k < 9; ++k) corners[k] = columns[k].data();
  for (const float reach : {std::numeric_limits<float>::infinity(), 0.2F})
    for (const bool solid : {true, false}) {
      const OpacityQuery opaque{nullptr, solid ? nullptr : +[](const void*, std::uint32_t t, float, float b2) {
                                  return t % 2 == 0 && b2 < 0.5F;
                                }};
      std::vector<std::vector<std::int32_t>> found;
      for (const ParallelKernels* kernels : all_parallel_kernels()) {
        found.emplace_back(points + PointGrid::room, 0);
        kernels->mark_covered(corners, triangles, axes, grid, reach, opaque, found.back().data());
      }
      for (const std::vector<std::int32_t>& one : found) EXPECT_EQ(one, found.front());
      int hidden = 0, sure = 0;
      for (std::size_t i = 0; i < points; ++i) {
        bool is = false, close = false;
        for (std::size_t t = 0; t < triangles; ++t) {
          const auto d = [&](std::size_t corner, std::size_t axis) {
            return static_cast<double>(columns[3 * corner + axis][t]) - static_cast<double>(at[axis][i]);
          };
          const auto twice = [&](std::size_t p, std::size_t q) { return d(p, 0) * d(q, 1) - d(q, 0) * d(p, 1); };
          const double a = twice(1, 2), b = twice(2, 0), c = twice(0, 1), area = a + b + c;
          const double height = (a * d(0, 2) + b * d(1, 2) + c * d(2, 2)) / area * (along[i] == 0 ? 1 : -1);
          const double within = std::min({a / area, b / area, c / area});
          constexpr double rounding = 1e-4;  // float rounding for slivers with an aspect ratio of 1000
          if (std::abs(within) < rounding && std::abs(height) < 1) close = true;
          if (within > -rounding &&
              (std::abs(height) < rounding || std::abs(height - static_cast<double>(reach)) < rounding))
            close = true;
          if (!solid && std::abs(c / area - 0.5) < rounding) close = true;
          is |= within >= 0 && height > 0 && height <= static_cast<double>(reach) &&
                (solid || (t % 2 == 0 && c / area < 0.5));
        }
        hidden += found.front()[i] != 0 ? 1 : 0;
        if (close) continue;
        ++sure;
        EXPECT_EQ(found.front()[i] != 0, is) << "point " << i;
      }
      EXPECT_GT(sure, static_cast<int>(points) / 2);
      EXPECT_GT(hidden, 20);
    }
}

}  // namespace
}  // namespace rebake::test
