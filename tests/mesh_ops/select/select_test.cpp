// Basics of selection: welding, connected components, traits, picture masks, visibility.
#include <gtest/gtest.h>

#include <numbers>

#include <cmath>
#include <random>

#include "mesh_ops/index/index.h"
#include "mesh_ops/select/duplicates.h"
#include "mesh_ops/select/morphology.h"
#include "mesh_ops/select/picture.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

// A strip of unit squares in the plane z = 0, two triangles each, `apart` away from each other. Each square has its own
// 16×16 texels and its own corners. `opaque(square, x, y)` selects the opaque texels.
BakedObject strip(int squares, double apart, const std::function<bool(int, int, int)>& opaque) {
  std::vector<Vec3> positions;
  std::vector<Vec2> uvs;
  std::vector<Face> faces;
  for (int s = 0; s < squares; ++s) {
    const auto base = static_cast<std::uint32_t>(positions.size());
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
      positions.emplace_back(s * (1 + apart) + x, y, 0);
      uvs.emplace_back((s + x) / static_cast<double>(squares), y);
    }
    faces.push_back({base, base + 1, base + 2});
    faces.push_back({base, base + 2, base + 3});
  }
  BakedObject object;
  object.decoder = std::make_shared<const Decoder>(made_decoder(1));
  object.sets.push_back({Soup(positions, uvs, faces), std::make_shared<const FeatureTexture>(FeatureTexture::from_rows(
                                                          squares * 16, 16, AlphaCode::halved, [&](int y, Texel* row) {
                                                            for (int x = 0; x < squares * 16; ++x) {
                                                              row[x] = empty_texel(AlphaCode::halved);
                                                              if (opaque(x / 16, x % 16, y)) row[x].feat0[0] = 200;
                                                            }
                                                          }))});
  return object;
}

bool everywhere(int, int, int) { return true; }

TEST(Select, WeldsEqualAndNearCorners) {
  EXPECT_EQ(corners_of(strip(3, 0, everywhere), 0)->place_count, 8U);
  EXPECT_EQ(corners_of(strip(3, 1e-3, everywhere), 0)->place_count, 12U);
  EXPECT_EQ(corners_of(strip(3, 1e-3, everywhere), 2e-3)->place_count, 8U);
  EXPECT_EQ(corners_of(strip(3, 1e-3, everywhere), 5e-4)->place_count, 12U);
}

TEST(Select, WeldingMatchesAllPairs) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  std::vector<Vec3> positions;
  for (int i = 0; i < 300; ++i) positions.emplace_back(coordinate(random), coordinate(random), coordinate(random));
  std::vector<Face> faces;
  for (std::uint32_t i = 0; i < 300; i += 3) faces.push_back({i, i + 1, i + 2});
  BakedObject object = strip(1, 0, everywhere);
  object.sets[0].soup = Soup(positions, std::vector<Vec2>(300, Vec2(0.5, 0.5)), faces);
  for (const double tolerance : {0.01, 0.1, 0.2}) {
    const WeldedCorners welded = *corners_of(object, tolerance);
    std::vector<std::uint32_t> group(300);
    for (std::uint32_t i = 0; i < 300; ++i) group[i] = i;
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t i = 0; i < 300; ++i)
        for (std::size_t j = 0; j < i; ++j)
          if ((positions[i] - positions[j]).norm() <= tolerance && group[i] != group[j]) {
            group[i] = group[j] = std::min(group[i], group[j]);
            changed = true;
          }
    }
    for (std::size_t i = 0; i < 300; ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_EQ(welded.places[i] == welded.places[j], group[i] == group[j]) << i << " " << j << " " << tolerance;
  }
}

std::size_t parts_of(const BakedObject& object, const Connectivity& joining = {}) {
  return components_of(object, joining)->triangles_in.size();
}

TEST(Select, ComponentsConnectAcrossOpaqueTexelsOnly) {
  EXPECT_EQ(parts_of(strip(3, 0, everywhere)), 1U);
  // A transparent column at the left of each square cuts the strip, though all corners are shared.
  EXPECT_EQ(parts_of(strip(3, 0, [](int, int x, int) { return x > 0; })), 3U);
  // Opaque in the upper half on one side and in the lower half on the other: no opaque texels meet at the edge.
  EXPECT_EQ(parts_of(strip(2, 0, [](int s, int, int y) { return s == 0 ? y < 8 : y >= 8; })), 2U);
  // One texel is enough.
  EXPECT_EQ(parts_of(strip(2, 0, [](int s, int, int y) { return s == 0 || y == 5; })), 1U);
}

TEST(Select, ToleranceAndGapJoinSeparateParts) {
  EXPECT_EQ(parts_of(strip(3, 0.01, everywhere)), 3U);
  EXPECT_EQ(parts_of(strip(3, 0.01, everywhere), {.tolerance = 0.02, .gap = 0}), 1U);
  EXPECT_EQ(parts_of(strip(3, 0.05, everywhere), {.tolerance = 0, .gap = 0.049}), 3U);
  EXPECT_EQ(parts_of(strip(3, 0.05, everywhere), {.tolerance = 0, .gap = 0.051}), 1U);
}

// Two squares whose nearest corners are 0.1 apart, for several offsets of their UVs from texel centres.
TEST(Select, GapIsMeasuredBetweenTriangles) {
  for (const double inset : {0.0, 0.4, 0.5, 0.6, 1.0}) {
    BakedObject object = strip(1, 0, everywhere);
    const double side = object.sets[0].texels->width(), low = (3 + inset) / side, high = (12 - inset) / side;
    constexpr double diagonal = 0.1 / std::numbers::sqrt2;
    std::vector<Vec3> positions;
    std::vector<Vec2> uvs;
    std::vector<Face> faces;
    for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1 + diagonal, 1 + diagonal, 0)}) {
      const auto base = static_cast<std::uint32_t>(positions.size());
      for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
        positions.emplace_back(at + Vec3(corner.x(), corner.y(), 0));
        uvs.emplace_back(corner.x() > 0 ? high : low, corner.y() > 0 ? high : low);
      }
      faces.push_back({base, base + 1, base + 2});
      faces.push_back({base, base + 2, base + 3});
    }
    object.sets[0].soup = Soup(positions, uvs, faces);
    EXPECT_EQ(parts_of(object, {.tolerance = 0, .gap = 0.09}), 2U) << inset;
    EXPECT_EQ(parts_of(object, {.tolerance = 0, .gap = 0.101}), 1U) << inset;
    EXPECT_EQ(parts_of(object, {.tolerance = 0, .gap = 0.5}), 1U) << inset;
  }
}

TEST(Select, TinyToleranceOrGapJoinsNothing) {
  for (const double tiny : {1e-9, 1e-15, 1e-17, 1e-30, 1e-300}) {
    EXPECT_EQ(parts_of(strip(3, 0.01, everywhere), {.tolerance = tiny, .gap = 0}), 3U) << tiny;
    EXPECT_EQ(parts_of(strip(3, 0.05, everywhere), {.tolerance = 0, .gap = tiny}), 3U) << tiny;
  }
}

TEST(Select, GrowShrinkAndFill) {
  const BakedObject object = strip(5, 0, everywhere);
  TriangleSet middle(10, 0);
  middle[4] = 1;
  const auto corners = corners_of(object);
  // The lower triangle of the middle square shares no corner with the upper one of the square before.
  const TriangleSet more = grown(*corners, middle);
  EXPECT_EQ(more, (TriangleSet{0, 0, 1, 0, 1, 1, 1, 1, 0, 0}));
  EXPECT_EQ(shrunk(*corners, more), middle);
  const TriangleSet all(10, 1);
  EXPECT_EQ(shrunk(*corners, all), all);
  const TriangleSet gap{1, 1, 1, 1, 0, 0, 1, 1, 1, 1};
  EXPECT_EQ(filled(*edges_of(object), gap, 3), all);
  EXPECT_EQ(filled(*edges_of(object), gap, 2), gap) << "the island is not smaller than the limit";
}

TEST(Select, FloodFillStaysInTheAllowedSet) {
  const auto corners = corners_of(strip(5, 0, everywhere));
  TriangleSet from(10, 0);
  from[0] = 1;
  EXPECT_EQ(connected_within(*corners, {1, 1, 1, 1, 0, 0, 1, 1, 1, 1}, from),
            (TriangleSet{1, 1, 1, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(connected_within(*corners, TriangleSet(10, 1), from), TriangleSet(10, 1));
  // The start triangle itself may lie outside the allowed set.
  EXPECT_EQ(connected_within(*corners, {0, 1, 0, 0, 1, 1, 1, 1, 1, 1}, from),
            (TriangleSet{0, 1, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Select, TraitsDescribeOpaqueTexels) {
  const auto object = made_object();
  const auto traits = traits_of(*object);
  const TextureSet& set = object->sets[0];
  for (std::size_t f = 0; f < set.soup.triangle_count(); f += 7) {
    // Brute force: every texel of the texture whose centre is in the triangle.
    std::array<Vec2, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec2& uv = set.soup.uvs()[set.soup.faces()[f][k]];
      p[k] = {uv.x() * set.texels->width(), (1 - uv.y()) * set.texels->height()};
    }
    Eigen::Array<double, 8, 1> sum = Eigen::Array<double, 8, 1>::Zero();
    int all = 0, opaque = 0;
    const TexelReader texels(*set.texels);
    const auto side = [](const Vec2& a, const Vec2& b, const Vec2& c) {
      return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    };
    for (int y = 0; y < set.texels->height(); ++y)
      for (int x = 0; x < set.texels->width(); ++x) {
        const Vec2 c(x + 0.5, y + 0.5);
        const double s0 = side(p[0], p[1], c), s1 = side(p[1], p[2], c), s2 = side(p[2], p[0], c);
        if (std::min({s0, s1, s2}) < 0 && std::max({s0, s1, s2}) > 0) continue;
        ++all;
        const Texel& texel = texels.at(x, y);
        if (!texel.opaque()) continue;
        ++opaque;
        const auto decoded = decode_features(texel, AlphaCode::halved);
        sum += Eigen::Map<const Eigen::Array<double, 8, 1>>(decoded.data());
      }
    const TriangleTraits& t = (*traits)[f];
    // Centres on the diagonal may count for either triangle.
    EXPECT_NEAR(static_cast<double>(t.opacity), static_cast<double>(opaque) / all, 0.06) << f;
    if (opaque == 0) continue;
    std::array<double, 8> mean;
    Color color = Color::Zero();
    for (std::size_t k = 0; k < 8; ++k) mean[k] = static_cast<double>(t.features[k]);
    for (std::size_t k = 0; k < 8; ++k) EXPECT_NEAR(mean[k], sum[static_cast<Eigen::Index>(k)] / opaque, 0.02) << f;
    for (const Vec3& axis : std::vector<Vec3>{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()})
      for (const double sign : {-1.0, 1.0}) color += decode(*object->decoder, mean, sign * axis) / 6;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(static_cast<double>(t.color[static_cast<std::size_t>(k)]), color[k], 1e-5);
  }
}

TEST(Select, PolygonAndBrushFlagThePixelsWhoseCentresAreInside) {
  const std::vector<Vec2> corners{{3.1, 2.2}, {27.3, 5.1}, {15.2, 14.4}, {25.7, 28.1}, {2.3, 25.6}};
  const PixelMask polygon = polygon_mask(corners, 30, 30), brush = brush_mask({{5, 5}, {20, 12}}, 3.5, 30, 30);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) {
      const Vec2 c(x + 0.5, y + 0.5);
      double turns = 0;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vec2 a = corners[k] - c, b = corners[(k + 1) % corners.size()] - c;
        turns += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      }
      EXPECT_EQ(polygon.at(x, y), std::abs(turns) > 3) << x << " " << y;
      const double t = std::clamp((c - Vec2(5, 5)).dot(Vec2(15, 7)) / Vec2(15, 7).squaredNorm(), 0.0, 1.0);
      EXPECT_EQ(brush.at(x, y), (c - Vec2(5, 5) - Vec2(15, 7) * t).norm() <= 3.5) << x << " " << y;
    }
  EXPECT_FALSE(polygon.at(-1, 4));
}

TEST(Select, StrokeIsTheUnionOfItsSegments) {
  std::vector<Vec2> points;
  for (int k = 0; k < 40; ++k) points.emplace_back(30 + 28 * std::cos(k * 0.7), 30 + 35 * std::sin(k * 1.1));
  points.push_back(points.back());
  PixelMask pieces = brush_mask({points[0]}, 2.25, 60, 60);
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const PixelMask piece = brush_mask({points[k], points[k + 1]}, 2.25, 60, 60);
    for (std::size_t i = 0; i < piece.flags.size(); ++i) pieces.flags[i] |= piece.flags[i];
  }
  EXPECT_EQ(brush_mask(points, 2.25, 60, 60).flags, pieces.flags);
}

Picture front_picture() {
  Picture picture;
  picture.camera.eye = {0, 0, 4};
  picture.camera.near_plane = 0.1;
  return picture;
}

TEST(Select, VisibleTrianglesAreOnTheNearSide) {
  const Scene scene = scene_of(made_object({.holes = false}));
  const Projector project(front_picture());
  const PixelMask whole = full_mask(800, 800);
  const auto objects = placed_nodes(scene);
  const TriangleSet seen = visible_triangles(objects, project, whole, 0, 100)[0];
  const TriangleSet under = projected_triangles(*objects[0].node->object, objects[0].to_world, project, whole, 0, 100);
  EXPECT_EQ(count(under), under.size()) << "all of the sphere is in the picture";
  std::size_t f = 0;
  for (const Face& face : objects[0].node->object->sets[0].soup.faces()) {
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t v : face) centre += objects[0].node->object->sets[0].soup.positions()[v] / 3;
    // From distance 4, the visible side of the unit sphere is z > 1/4; the tolerance is one facet's width.
    if (centre.z() > 0.55) {
      EXPECT_EQ(seen[f], 1) << centre.transpose();
    }
    if (centre.z() < -0.05) {
      EXPECT_EQ(seen[f], 0) << centre.transpose();
    }
    ++f;
  }
  const TriangleSet near = visible_triangles(objects, project, whole, 0, 3.2)[0];
  EXPECT_LT(count(near), count(seen));
  EXPECT_GT(count(near), 0U);
}

TEST(Select, ParallelRaysSeeTheNearHalf) {
  const Scene scene = scene_of(made_object({.holes = false}));
  Picture picture = front_picture();
  picture.camera.ortho_height = 2.5;
  const Projector project(picture);
  const auto objects = placed_nodes(scene);
  const TriangleSet seen = visible_triangles(objects, project, full_mask(800, 800), 0, 100)[0];
  const Soup& soup = objects[0].node->object->sets[0].soup;
  for (std::size_t f = 0; f < soup.triangle_count(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t v : soup.faces()[f]) centre += soup.positions()[v] / 3;
    // The tolerance is one facet's width around the equator z = 0.
    if (std::abs(centre.z()) > 0.25) {
      EXPECT_EQ(seen[f] != 0, centre.z() > 0) << centre.transpose();
    }
    // The ray through a point's pixel passes the point within a pixel.
    Projector::At at;
    ASSERT_TRUE(project(centre, at));
    const ViewRay ray = project.ray(at.x, at.y);
    EXPECT_LT((ray.origin + at.depth * ray.direction - centre).norm(), 2.5 / 800);
    const double near = project.camera().near_plane;
    EXPECT_LT((project.start_for(centre) + (at.depth - near) * ray.direction - centre).norm(), 1e-12);
  }
}

TEST(Select, ObjectsOccludeExceptThroughHoles) {
  Node node;
  node.object = made_object({.holes = false});
  Scene scene = scene_of(made_object());
  node.to_parent.translation() = Vec3(0, 0, -3);
  scene = with_added(scene, node, NodeId::none, 9);
  const auto seen = visible_triangles(placed_nodes(scene), Projector(front_picture()), full_mask(800, 800), 0, 100);
  EXPECT_GT(count(seen[1]), 0U) << "through the holes of the sphere in front";
  const auto alone =
      visible_triangles({placed_nodes(scene)[1]}, Projector(front_picture()), full_mask(800, 800), 0, 100);
  EXPECT_LT(count(seen[1]), count(alone[0]));
}

// A brush needs no ray tree of all triangles, and gives the same result with and without one.
TEST(Select, BrushMatchesRaysThroughAllTriangles) {
  struct Case {
    const char* what;
    double scale;
    Vec3 eye;  ///< position, in units of `scale`
    double ortho_height;
    std::vector<Vec2> stroke;
    double radius;
  };
  const std::vector<Vec2> across{Vec2(300, 350), Vec2(420, 460)}, aside{Vec2(5, 400)};
  for (const Case& one :
       {Case{"from outside", 1, {0, 0, 4}, 0, across, 12}, Case{"one pixel", 1, {0, 0, 4}, 0, {Vec2(390, 410)}, 0.8},
        Case{"at the picture's edge", 1, {0.3, 0.2, 1.4}, 0, aside, 30},
        Case{"through the surface", 1, {0, 0, 0.99}, 0, across, 40},
        Case{"from within", 1, {0.1, 0.2, 0}, 0, across, 20}, Case{"parallel", 1, {1, 2, 4}, 2.5, across, 12},
        Case{"huge", 1e6, {0, 0, 4}, 0, across, 12}, Case{"tiny", 1e-6, {0, 0, 4}, 0, across, 12},
        Case{"from afar", 1, {0, 0, 1e6}, 0, across, 12}}) {
    SCOPED_TRACE(one.what);
    Node node;
    node.object = made_object({.columns = 40, .rows = 20});
    node.to_parent = Eigen::Scaling(one.scale * Vec3(-1, 1.2, 0.9));
    const Scene scene = with_added({}, node, NodeId::none, 9);
    Picture picture;
    picture.camera.eye = one.scale * one.eye;
    picture.camera.near_plane = 0.01 * one.scale;
    picture.camera.far_plane = 2 * picture.camera.eye.norm() + 10 * one.scale;
    picture.camera.ortho_height = one.scale * one.ortho_height;
    if (picture.camera.eye.norm() > 1e5 * one.scale) picture.camera.fov_degrees = 0.00015;
    const Projector project(picture);
    const PixelMask mask = brush_mask(one.stroke, one.radius, 800, 800);
    const auto seen = [&] {
      return visible_triangles(placed_nodes(scene), project, mask, 0, picture.camera.far_plane)[0];
    };
    const TriangleSet before = seen();
    EXPECT_EQ(try_rays_of(*node.object), nullptr) << "no ray tree may be built";
    EXPECT_GT(count(before), 0U);
    TriangleSet expected(before.size(), 0);
    const SceneRays all = rays_through(placed_nodes(scene));
    for (int y = 0; y < 800; ++y)
      for (int x = 0; x < 800; ++x)
        if (mask.at(x, y)) {
          const ViewRay ray = project.ray(x, y);
          const auto hit = all.nearest(ray.origin, ray.direction, picture.camera.near_plane, picture.camera.far_plane);
          if (hit) expected[hit->triangle] = 1;
        }
    EXPECT_EQ(before, expected);
    EXPECT_EQ(seen(), expected) << "with a ray tree of all triangles";
  }
}

// False for the degenerate triangles at the poles of a made sphere, which are never visible.
bool has_area(const Soup& soup, std::size_t f) {
  const Face& face = soup.faces()[f];
  const Vec3& first = soup.positions()[face[0]];
  return !(soup.positions()[face[1]] - first).cross(soup.positions()[face[2]] - first).isZero(0);
}

TEST(Select, InnerTrianglesAreInvisibleFromOutside) {
  auto object = std::make_shared<BakedObject>(*made_object({.holes = false}));
  object->sets.push_back(made_object({.radius = 0.5, .holes = false})->sets[0]);
  const TriangleSet unseen = triangles_unseen(*object, viewpoints_around(object->bounds(), 64, 3));
  const std::size_t outer = object->sets[0].soup.triangle_count();
  for (std::size_t f = 0; f < unseen.size(); ++f)
    EXPECT_EQ(unseen[f] != 0, f >= outer || !has_area(object->sets[0].soup, f)) << f;
}

TEST(Select, DegenerateTrianglesAreInvisibleTinyOnesAreVisible) {
  auto object = std::make_shared<BakedObject>(*made_object({.holes = false}));
  const Soup& soup = object->sets[0].soup;
  std::vector<Vec3> positions = soup.positions();
  std::vector<Vec2> uvs = soup.uvs();
  std::vector<Face> faces = soup.faces();
  const Face first = faces[0];
  const auto n = static_cast<std::uint32_t>(positions.size());
  // A degenerate triangle outside the sphere, with the texels of the first triangle.
  for (std::size_t k = 0; k < 3; ++k) {
    positions.emplace_back(1.2, 0.1 * static_cast<double>(k), 0);
    uvs.push_back(uvs[first[k]]);
  }
  // A triangle outside the sphere that covers a part of one texel without its centre.
  const double side = object->sets[0].texels->width(), down = object->sets[0].texels->height();
  const Vec2 middle = (uvs[first[0]] + uvs[first[1]] + uvs[first[2]]) / 3;
  const Vec2 texel(std::floor(middle.x() * side), std::floor(middle.y() * down));
  for (const Vec2& corner : {Vec2(0.1, 0.1), Vec2(0.3, 0.1), Vec2(0.1, 0.3)}) {
    uvs.emplace_back((texel.x() + corner.x()) / side, (texel.y() + corner.y()) / down);
    positions.emplace_back(Vec3(1.2, corner.x(), corner.y()));
  }
  faces.push_back({n, n + 1, n + 2});
  faces.push_back({n + 3, n + 4, n + 5});
  object->sets[0].soup = Soup(positions, uvs, faces);
  const TriangleSet unseen = triangles_unseen(*object, viewpoints_around(object->bounds(), 64, 3));
  EXPECT_NE(unseen[faces.size() - 2], 0);
  EXPECT_EQ(unseen[faces.size() - 1], 0);
}

TEST(Select, ParallelRaysDoNotPassThinShells) {
  // Two concentric shells, 0.02 apart.
  auto object = std::make_shared<BakedObject>(*made_object({.holes = false}));
  object->sets.push_back(made_object({.radius = 0.98, .holes = false})->sets[0]);
  const std::size_t outer = object->sets[0].soup.triangle_count();
  std::vector<Viewpoint> all_round;
  for (const Viewpoint& from : viewpoints_around(object->bounds(), 64, 3))
    all_round.push_back({Vec3::Zero(), from.eye.normalized()});
  const TriangleSet unseen = triangles_unseen(*object, all_round);
  for (std::size_t f = 0; f < unseen.size(); ++f)
    EXPECT_EQ(unseen[f] != 0, f >= outer || !has_area(object->sets[0].soup, f)) << f;
  // From one side, the near half is visible.
  const TriangleSet behind = triangles_unseen(*object, std::vector<Viewpoint>{{Vec3::Zero(), Vec3::UnitZ()}});
  const Soup& soup = object->sets[0].soup;
  for (std::size_t f = 0; f < outer; ++f) {
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t v : soup.faces()[f]) centre += soup.positions()[v] / 3;
    if (std::abs(centre.z()) > 0.3 && has_area(soup, f)) {
      EXPECT_EQ(behind[f] != 0, centre.z() < 0) << centre.transpose();
    }
  }
}

TEST(Select, OnlyTheEarlierOfEqualTrianglesIsADuplicate) {
  BakedObject object = strip(2, 0, everywhere);
  const Soup& soup = object.sets[0].soup;
  std::vector<Face> faces = soup.faces();
  faces.push_back({faces[1][2], faces[1][0], faces[1][1]});
  object.sets[0].soup =
      Soup(soup.shared_positions(), soup.shared_uvs(), std::make_shared<const std::vector<Face>>(faces));
  EXPECT_EQ(duplicate_triangles(object), (TriangleSet{0, 1, 0, 0, 0}));
}

TEST(Select, DuplicatesMayBeInSetsWithEqualTexels) {
  BakedObject object = strip(2, 0, everywhere);
  const TextureSet& set = object.sets[0];
  const auto copy = [&](int change) {
    FeatureTexture::Change texels(*set.texels);
    texels.at(0, 0).feat1[0] = static_cast<std::uint8_t>(texels.at(0, 0).feat1[0] + change);
    return TextureSet{set.soup, texels.finish()};
  };
  object.sets = {set, copy(0), copy(1)};
  EXPECT_EQ(duplicate_triangles(object), (TriangleSet{1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(Select, NineMicsHaveAtLeastNineComponents) {
  const auto mic = mic_object();
  if (!mic) GTEST_SKIP() << "REBAKE_TEST_DATA has no mic";
  const auto one = tiled(*mic);
  EXPECT_EQ(one->triangle_count(), 741789U);
  const auto parts = components_of(*one);
  std::size_t largest = 0;
  for (const std::uint32_t size : parts->triangles_in) largest = std::max<std::size_t>(largest, size);
  EXPECT_LE(largest, mic->triangle_count()) << "no component may contain triangles of two mics";
}

}  // namespace
}  // namespace rebake::test
