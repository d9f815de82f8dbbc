// Fusing decoders: network kernels compared with double precision, reproducible bytes, and degenerate teachers.
#include "mesh_ops/features/distill/fuse.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <set>

#include "mesh_ops/base/error.h"
#include "mesh_ops/features/distill/branch_fit.h"
#include "tests/support/made_scenes.h"

namespace rebake::test {
namespace {

std::vector<Lanes> random_lanes(std::size_t count, std::uint64_t seed, double from = 0, double to = 1) {
  SplitMix64 dice(seed);
  std::vector<Lanes> lanes(count);
  for (Lanes& lane : lanes)
    for (float& value : lane.at) value = static_cast<float>(from + (to - from) * dice.share());
  return lanes;
}

// Observations of 16 texels with the given features from 24 random directions, decoded by `teacher`: targets of a fit.
std::vector<ViewSample> view_samples(const FeatureNetwork& teacher, const std::vector<Lanes>& features) {
  SplitMix64 dice(7);
  TexelGroup group;
  group.count = network_lanes;
  std::copy_n(features.begin(), texel_features, group.features);
  std::vector<Vec3> directions;
  for (int k = 0; k < 24; ++k)
    directions.push_back(Vec3(dice.share() - 0.5, dice.share() - 0.5, dice.share() - 0.5).normalized());
  std::vector<Lanes> work(network_kernels().workspace(teacher.view()));
  return view_samples_of(teacher, group, directions, 0, work.data());
}

TEST(NetworkKernels, AgreeWithDoublePrecision) {
  for (const auto& [width0, width1] : {std::pair(16, 16), std::pair(5, 9), std::pair(33, 34)}) {
    const Decoder decoder = made_decoder(3, width0, width1);
    const FeatureNetwork network(decoder);
    const std::vector<Lanes> input = random_lanes(decoder_inputs, 1, -1, 1);
    std::vector<Lanes> output(3), work(network_kernels().workspace(network.view()));
    network_kernels().forward(network.view(), input.data(), output.data(), work.data());
    for (std::size_t l = 0; l < network_lanes; ++l) {
      std::array<double, 8> features;
      for (std::size_t c = 0; c < 8; ++c) features[c] = static_cast<double>(input[c].at[l]);
      const Vec3 fed(input[8].at[l], input[9].at[l], input[10].at[l]);
      const Color exact = decode(decoder, features, fed);
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(output[c].at[l], exact[static_cast<Eigen::Index>(c)], 2e-6);
    }
    EXPECT_TRUE(decode(network.to_decoder(), {}, {0, 0, 1}).isApprox(decode(decoder, {}, {0, 0, 1}), 1e-6));
  }
}

TEST(NetworkKernels, GradientsMatchFiniteDifferences) {
  const Decoder decoder = made_decoder(5, 7, 6);
  FeatureNetwork network(decoder);
  const std::vector<Lanes> input = random_lanes(decoder_inputs, 2), slopes = random_lanes(3, 3, -1, 1);
  std::vector<Lanes> output(3), gradient(network.values.size()), input_slopes(decoder_inputs),
      work(network_kernels().workspace(network.view()));
  network_kernels().forward(network.view(), input.data(), output.data(), work.data());
  network_kernels().backward(network.view(), input.data(), output.data(), slopes.data(), gradient.data(),
                             input_slopes.data(), work.data());
  // The loss is Σ slopes · outputs; compared with central differences of the decoder in double precision.
  const auto loss = [&](const Decoder& d, std::size_t l, std::size_t moved, double by) {
    std::array<double, 11> x;
    for (std::size_t i = 0; i < 11; ++i) x[i] = static_cast<double>(input[i].at[l]) + (i == moved ? by : 0);
    const Color out = decode(d, {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]}, {x[8], x[9], x[10]});
    return slopes[0].at[l] * out[0] + slopes[1].at[l] * out[1] + slopes[2].at[l] * out[2];
  };
  constexpr double h = 1e-6;
  for (std::size_t l = 0; l < network_lanes; ++l) {
    for (std::size_t i = 0; i < 11; ++i)
      EXPECT_NEAR(input_slopes[i].at[l], (loss(decoder, l, i, h) - loss(decoder, l, i, -h)) / (2 * h), 1e-5);
    for (const auto& [i, j] : {std::pair(0, 2), std::pair(10, 6)}) {
      Decoder up = decoder, down = decoder;
      up.weights0(i, j) += h;
      down.weights0(i, j) -= h;
      EXPECT_NEAR(gradient[static_cast<std::size_t>(j * 12 + i + 1)].at[l],
                  (loss(up, l, 99, 0) - loss(down, l, 99, 0)) / (2 * h), 1e-5);
    }
    Decoder up = decoder, down = decoder;
    up.bias2[1] += h;
    down.bias2[1] -= h;
    EXPECT_NEAR(gradient[7 * 12 + 6 * 8 + 7].at[l], (loss(up, l, 99, 0) - loss(down, l, 99, 0)) / (2 * h), 1e-5);
  }
}

TEST(NetworkKernels, GiveTheSameBitsOnEveryProcessor) {
  const FeatureNetwork network(made_decoder(2, 18, 13));
  const auto seen = view_samples(network, random_lanes(texel_features, 4));
  const auto levels = feature_levels(8, AlphaCode::halved);
  std::vector<std::vector<Lanes>> results;
  for (const NetworkKernels* kernels : all_network_kernels()) {
    std::vector<Lanes> work(kernels->workspace(network.view())), features = random_lanes(texel_features, 5);
    features.resize(texel_features + 1 + network.values.size());
    kernels->fit_texels(network.view(), seen.data(), seen.size(), {4, levels.data(), true}, features.data(),
                        &features[texel_features], work.data());
    const std::vector<Lanes> input = random_lanes(decoder_inputs, 6), slopes = random_lanes(3, 3);
    Lanes output[3];
    kernels->forward(network.view(), input.data(), output, work.data());
    kernels->backward(network.view(), input.data(), output, slopes.data(), &features[texel_features + 1], nullptr,
                      work.data());
    results.push_back(features);
  }
  for (const auto& result : results)
    EXPECT_EQ(std::memcmp(result.data(), results.front().data(), result.size() * sizeof(Lanes)), 0);
}

TEST(NetworkKernels, FitFeaturesToColours) {
  const FeatureNetwork network(made_decoder(2));
  const std::vector<Lanes> truth = random_lanes(texel_features, 4, 0.1, 0.9);
  auto seen = view_samples(network, truth);
  // Keeps observations of single texels only: means of four texels depend on neighbouring lanes.
  std::erase_if(seen, [](const ViewSample& view_sample) { return view_sample.mix != 0; });
  std::vector<Lanes> work(network_kernels().workspace(network.view())), features = random_lanes(texel_features, 5);
  Lanes before, fitted, rounded, searched;
  const auto fit = [&](const TexelFit& how, std::vector<Lanes> from, Lanes& error) {
    network_kernels().fit_texels(network.view(), seen.data(), seen.size(), how, from.data(), &error, work.data());
    return from;
  };
  const auto levels = feature_levels(8, AlphaCode::halved);
  fit({}, features, before);
  features = fit({12, nullptr, false}, features, fitted);
  const auto near = fit({0, levels.data(), false}, features, rounded),
             best = fit({0, levels.data(), true}, features, searched);
  float sums[2] = {};
  for (std::size_t l = 0; l < network_lanes; ++l) {
    sums[0] += before.at[l];
    sums[1] += fitted.at[l];
    EXPECT_LE(fitted.at[l], before.at[l]);
    EXPECT_LE(searched.at[l], rounded.at[l]);
    for (std::size_t c = 0; c < texel_features; ++c) {
      const double byte = 255 * static_cast<double>(best[c].at[l]);
      EXPECT_NEAR(byte, std::round(byte), 1e-3);
      // Alpha decodes to odd 255ths in split folders.
      EXPECT_TRUE(c % 4 != 3 || std::lround(byte) % 2 == 1);
    }
    EXPECT_GE(std::lround(255 * best[0].at[l]), 1);
  }
  EXPECT_LT(sums[1], 0.02F * sums[0]);  // 17 dB better than the random features at the start
}

// The composition of a scene and its fast fuse: a small sample and few training steps.
struct Result {
  Composition composition;
  Fused fused;
};
Result fused(const Scene& scene, FuseOptions options = {}) {
  options.sample = 512;
  options.training.steps = 60;
  Result result{composed(scene, 4096), {}};
  const VisibleDirections sightlines(scene);
  result.fused = fuse(result.composition, sightlines, plan_fuse(result.composition, sightlines, options), options);
  return result;
}

Scene with(Scene scene, std::shared_ptr<const BakedObject> object, const Affine& to_parent = Affine::Identity()) {
  Node node;
  node.name = "node";
  node.object = std::move(object);
  node.to_parent = to_parent;
  return with_added(scene, std::move(node), NodeId::none, 99);
}

MadeObject small(unsigned seed) {
  MadeObject made;
  made.columns = 6;
  made.rows = 3;
  made.seed = seed;
  return made;
}

Affine moved(double x) { return Affine(Eigen::Translation3d(x, 0, 0)); }

void expect_valid(const Result& result) {
  const BakedObject& object = *result.fused.object;
  const Decoder& d = *object.decoder;
  EXPECT_TRUE(d.weights0.allFinite() && d.weights1.allFinite() && d.weights2.allFinite() && d.bias0.allFinite() &&
              d.bias1.allFinite() && d.bias2.allFinite());
  EXPECT_TRUE(std::isfinite(result.fused.report.whole.psnr_db));
  ASSERT_EQ(object.sets.size(), result.composition.pages.size());
  for (std::size_t k = 0; k < object.sets.size(); ++k) {
    const FeatureTexture &after = *object.sets[k].texels, &before = *result.composition.pages[k].texels;
    const TexelReader texels(after);
    for (int y = 0; y < after.height(); ++y)
      for (int x = 0; x < after.width(); ++x) {
        ASSERT_EQ(after.opaque(x, y), before.opaque(x, y));
        ASSERT_TRUE(after.alpha_code() == AlphaCode::plain || texels.at(x, y).feat0[3] >= 128);
      }
  }
}

TEST(Fuse, GivesTheSameBytesAtAnyNumberOfThreads) {
  const Scene scene = with(with({}, made_object(small(1))), made_object(small(2)), moved(2.5));
  for (const int width : {16, 48}) {
    FuseOptions options;
    options.width = width;
    std::vector<Fused> results;
    for (const std::size_t threads : {1U, 3U}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(fused(scene, options).fused);
    }
    EXPECT_TRUE(*results[0].object->decoder == *results[1].object->decoder);
    const FeatureTexture &a = *results[0].object->sets[0].texels, &b = *results[1].object->sets[0].texels;
    const TexelReader texels_a(a), texels_b(b);
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) ASSERT_EQ(texels_a.at(x, y), texels_b.at(x, y));
  }
}

TEST(Fuse, OneDecoderInOneOrientationIsExact) {
  const auto object = made_object(small(1));
  const Affine turn(Eigen::AngleAxisd(1, Vec3::UnitX()));
  EXPECT_TRUE(composed(with(with({}, object, turn), object, moved(3) * turn), 4096).exact());
  EXPECT_FALSE(composed(with(with({}, object), object, moved(3) * turn), 4096).exact());
}

TEST(Fuse, CopiesShareTheirTexels) {
  const auto object = made_object(small(1));
  const Scene copies = with(with(with({}, object), object, moved(3)), made_object(small(2)), moved(6));
  const Scene once = with(with({}, object), made_object(small(2)), moved(6));
  EXPECT_EQ(composed(copies, 4096).opaque_texels, composed(once, 4096).opaque_texels);
  expect_valid(fused(copies));
}

TEST(Fuse, PreservesTexelsOfTheKeptNode) {
  const auto object = made_object(small(1));
  const Scene scene = with(with({}, object), made_object(small(2)), moved(2.5));
  FuseOptions options;
  options.keep = FuseOptions::Keep::node;
  options.keep_node = scene.roots[0]->id;
  const Result result = fused(scene, options);
  EXPECT_TRUE(*result.fused.object->decoder == *object->decoder);
  const auto plain = result.composition.pages[0].texels;
  const auto halved_texture = with_alpha_code(plain, AlphaCode::halved);
  const TexelReader halved(*halved_texture), after(*result.fused.object->sets[0].texels);
  std::size_t kept = 0, changed = 0;
  for (const Composition::Block& block : result.composition.blocks)
    for (const TexelSite& site : sites_of(result.composition, block)) {
      const bool same = after.at(site.x, site.y) == halved.at(site.x, site.y);
      if (result.composition.parts[block.part].node == options.keep_node) {
        ASSERT_TRUE(same);
        ++kept;
      } else {
        changed += same ? 0 : 1;
      }
    }
  EXPECT_GT(kept, 1000U);
  EXPECT_GT(changed, 1000U);
  EXPECT_EQ(result.fused.report.parts[0].errors.psnr_db, 100);
}

TEST(Fuse, ReportsLossOfHalvedAlphas) {
  MadeObject plain = small(1);
  plain.code = AlphaCode::plain;
  const Scene scene = with(with({}, made_object(plain)), made_object(small(2)), moved(2.5));
  FuseOptions options;
  options.keep = FuseOptions::Keep::node;
  options.keep_node = scene.roots[0]->id;
  const FuseReport halved = fused(scene, options).fused.report;
  EXPECT_FALSE(halved.parts[0].kept);
  EXPECT_GT(halved.parts[0].errors.psnr_db, 45);
  EXPECT_LT(halved.parts[0].errors.psnr_db, 100);
  options.layout = Layout::unsplit;
  EXPECT_TRUE(fused(scene, options).fused.report.parts[0].kept);
}

TEST(Fuse, TrainsDecodersOfAnyWidth) {
  auto wide = std::make_shared<BakedObject>(*made_object(small(2)));
  wide->decoder = std::make_shared<const Decoder>(made_decoder(4, 40, 30));
  FuseOptions options;
  options.way = FuseMethod::train;
  EXPECT_EQ(fused(with(with({}, wide), wide, moved(3) * Eigen::AngleAxisd(1, Vec3::UnitX())), options)
                .fused.object->decoder->hidden0(),
            40);
}

// Each hard case beside an ordinary object, at width 16 (trained) and width 80 (both decoders fit side by side).
class FuseHardCases : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Fuse, FuseHardCases, ::testing::Values(16, 80));

TEST_P(FuseHardCases, Decoders) {
  FuseOptions options;
  options.width = GetParam();
  const Decoder ordinary = made_decoder(2);
  Decoder saturated = ordinary, dead = ordinary, constant = ordinary;
  saturated.weights2 *= 1000;
  dead.bias0.setConstant(-1000);
  constant.weights0.setZero();
  for (const Decoder& decoder : {saturated, dead, constant, made_decoder(4, 5, 9), made_decoder(4, 40, 30)}) {
    auto object = std::make_shared<BakedObject>(*made_object(small(2)));
    object->decoder = std::make_shared<const Decoder>(decoder);
    expect_valid(fused(with(with({}, made_object(small(1))), object, moved(2.5)), options));
  }
}

TEST_P(FuseHardCases, Geometry) {
  FuseOptions options;
  options.width = GetParam();
  const auto ordinary = made_object(small(1));
  MadeObject closed = small(3);
  closed.holes = false;
  const auto sphere = made_object(closed);
  const auto changed = [](const BakedObject& object, const std::function<void(Vec3&)>& change) {
    auto result = std::make_shared<BakedObject>(object);
    std::vector<Vec3> positions = object.sets[0].soup.positions();
    for (Vec3& p : positions) change(p);
    result->sets[0].soup = Soup(positions, object.sets[0].soup.uvs(), object.sets[0].soup.faces());
    return std::shared_ptr<const BakedObject>(result);
  };
  const auto inside = changed(*made_object(small(2)), [](Vec3& p) { p *= 0.2; });
  expect_valid(fused(with(with({}, sphere), inside), options));  // hidden from all directions
  const auto needle = changed(*made_object(small(2)), [](Vec3& p) { p = {p.y(), 0, 0}; });
  expect_valid(fused(with(with({}, ordinary), needle, moved(3)), options));  // triangles without area
  const auto point = changed(*made_object(small(2)), [](Vec3& p) { p.setZero(); });
  expect_valid(fused(with(with({}, ordinary), point, moved(3)), options));
  for (const double scale : {1e-6, 1e6})
    expect_valid(fused(with(with({}, ordinary, Affine(Eigen::Scaling(scale))), made_object(small(2)),
                            moved(2.5 * scale) * Eigen::Scaling(scale)),
                       options));
}

TEST_P(FuseHardCases, OneTexelAndNoTexel) {
  FuseOptions options;
  options.width = GetParam();
  auto one = std::make_shared<BakedObject>(*made_object(small(2)));
  const auto only = [](const FeatureTexture& from, int x, int y) {
    const TexelReader texels(from);
    return std::make_shared<const FeatureTexture>(
        FeatureTexture::from_rows(from.width(), from.height(), from.alpha_code(), [&, x, y](int row, Texel* out) {
          for (int column = 0; column < from.width(); ++column)
            out[column] = column == x && row == y ? texels.at(x, y) : empty_texel(from.alpha_code());
        }));
  };
  const auto texels = one->sets[0].texels;
  one->sets[0].texels = only(*texels, 22, 6);
  ASSERT_TRUE(one->sets[0].texels->opaque(22, 6));
  const Result result = fused(with(with({}, made_object(small(1))), one, moved(2.5)), options);
  expect_valid(result);
  EXPECT_EQ(result.fused.report.parts.back().errors.texels, 1U);
  expect_valid(fused(with(with({}, one), one, moved(3) * Eigen::AngleAxisd(1, Vec3::UnitX())), options));
  one->sets[0].texels = only(*texels, -1, -1);
  EXPECT_THROW(composed(with({}, one), 4096), EditError);
  // Next to another object, a fully transparent one is ignored.
  EXPECT_EQ(
      fused(with(with({}, made_object(small(1))), one, moved(2.5)), options).fused.report.parts.back().errors.texels,
      0U);
}

// A small sphere whose vertices are rotated about z by `radians` per unit of y.
std::shared_ptr<const BakedObject> bent_by(double radians) {
  auto bent = std::make_shared<BakedObject>(*made_object(small(1)));
  const Soup& soup = bent->sets[0].soup;
  bent->sets[0].soup = change_vertices(soup, std::vector<std::uint8_t>(soup.triangle_count(), 1), 0,
                                       [radians](std::uint32_t /*vertex*/, Vec3& p, Mat3& turn) {
                                         turn = Eigen::AngleAxisd(radians * p.y(), Vec3::UnitZ()).toRotationMatrix();
                                         p = turn * p;
                                       });
  return bent;
}

TEST(Fuse, FitsBentTriangles) {
  const auto bent = bent_by(0.8);
  FuseOptions options;
  options.width = 80;
  const Result result = fused(with({}, bent), options);
  ASSERT_TRUE(result.composition.parts[0].bent);
  expect_valid(result);
  options.way = FuseMethod::keep;
  options.iterations = 0;
  options.width.reset();
  const double as_they_were = fused(with({}, bent), options).fused.report.whole.psnr_db;
  // Choosing branches per group of 16 texels would gain 5.8 dB, but with up to five times as many specks in pictures.
  EXPECT_GT(result.fused.report.whole.psnr_db, as_they_were + 4.5);
  EXPECT_FALSE(result.fused.object->any_rotations());
}

// A pixel that mixes texels of two branches shows a wrong colour. So all texels of a block use one branch, and no fit
// moves a texel out of it.
TEST(Fuse, TexelsOfABlockStayInOneBranch) {
  const auto bent = bent_by(2);
  const Scene scene = with({}, bent);
  FuseOptions options;
  options.way = FuseMethod::side_by_side;
  options.sample = 512;
  const Composition composition = composed(scene, 4096);
  const VisibleDirections sightlines(scene);
  const FusePlan plan = plan_fuse(composition, sightlines, options);
  const Student& student = plan.candidates[plan.chosen].student;
  ASSERT_GT(student.branches.size(), 1U);
  const auto branches =
      BranchFit(composition, student).choose(sightlines, static_cast<std::size_t>(options.iterations), {});
  const std::shared_ptr<const BakedObject> object = fuse(composition, sightlines, plan, options).object;
  std::set<std::uint32_t> used;
  for (std::size_t b = 0; b < composition.blocks.size(); ++b) {
    const Composition::Block& block = composition.blocks[b];
    ASSERT_TRUE(branches[b].has_value());
    used.insert(*branches[b]);
    const Student::Branch& branch = student.branches[*branches[b]];
    const FeatureTexture& texture = *object->sets[block.page].texels;
    const TexelReader texels(texture);
    for (const TexelSite& site : sites_of(composition, block)) {
      const auto stored = decode_features(texels.at(site.x, site.y), texture.alpha_code());
      Eigen::Matrix<double, 8, 1> features;
      for (std::size_t c = 0; c < texel_features; ++c) features[static_cast<Eigen::Index>(c)] = stored[c];
      const Eigen::Matrix<double, 8, 1> own = branch.encode.inverse() * (features - branch.offset);
      for (std::size_t c = 0; c < texel_features; ++c) {
        if ((student.selectors >> c & 1) == 0) continue;
        // Tolerance for the rounding to bytes, which the inverse of the encoding magnifies.
        EXPECT_GT(own[static_cast<Eigen::Index>(c)], -0.05);
        EXPECT_LT(own[static_cast<Eigen::Index>(c)], 1.05);
      }
    }
  }
  EXPECT_GT(used.size(), 1U) << "several branches must be used";
}

TEST(Fuse, RejectsContradictoryOptions) {
  const Scene scene = with(with({}, made_object(small(1))), made_object(small(2)), moved(2.5));
  for (const int width : {3, 257, -1}) {
    FuseOptions options;
    options.width = width;
    EXPECT_THROW(fused(scene, options), FieldError);
  }
  FuseOptions options;
  options.keep = FuseOptions::Keep::node;
  options.keep_node = NodeId{77};
  EXPECT_THROW(fused(scene, options), FieldError);
  EXPECT_THROW(composed({}, 4096), EditError);
  options.keep_node = scene.roots[0]->id;
  options.width = 8;  // narrower than the decoder to keep
  EXPECT_THROW(fused(scene, options), FieldError);
  options.width.reset();
  options.way = FuseMethod::scratch;  // contradicts keep_node
  EXPECT_THROW(fused(scene, options), FieldError);
}

TEST(Fuse, CanBeCancelled) {
  const Scene scene = with(with({}, made_object(small(1))), made_object(small(2)), moved(2.5));
  std::atomic<bool> stop = false;
  const Progress progress([&](std::string_view what, double) { stop = what == "training"; }, &stop);
  const Composition composition = composed(scene, 4096);
  EXPECT_THROW(plan_fuse(composition, VisibleDirections(scene), {}, progress), Cancelled);
}

TEST(Fuse, ObeysTimeLimit) {
  const Scene scene = with(with({}, made_object({.seed = 1})), made_object({.seed = 2}), moved(2.5));
  FuseOptions options;
  options.width = 16;
  options.seconds = 1e-3;
  const Result result = fused(scene, options);
  EXPECT_FALSE(result.fused.report.in_time);
  expect_valid(result);
  // Methods without training are tried even so.
  options.width.reset();
  EXPECT_GT(fused(scene, options).fused.report.whole.psnr_db, 35);
  options.width = 16;
  // Fitting stops when psnr_db is reached.
  options.seconds = 0;
  options.until_psnr = true;
  options.psnr_db = 5;
  const double guessed = fused(scene, options).fused.report.whole.psnr_db;
  options.psnr_db = 100;
  EXPECT_GT(fused(scene, options).fused.report.whole.psnr_db, guessed + 1);
}

}  // namespace
}  // namespace rebake::test
