#include "mesh_ops/features/distill/fuse.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/features/distill/branch_fit.h"
#include "mesh_ops/features/distill/fuse_errors.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

// Histogram of the texels' errors, in bins of 0.1 dB PSNR.
struct Histogram {
  static constexpr std::size_t bins = 1001;
  std::vector<std::uint64_t> count = std::vector<std::uint64_t>(bins);
  std::uint64_t texels = 0;
  double squares = 0;
  void add(double mean_square) {
    ++texels;
    squares += mean_square;
    ++count[static_cast<std::size_t>(std::clamp(psnr_of(mean_square) * 10, 0.0, bins - 1.0))];
  }
  void add_exact(std::uint64_t some) {
    texels += some;
    count.back() += some;
  }
  void add(const Histogram& other) {
    texels += other.texels;
    squares += other.squares;
    for (std::size_t k = 0; k < bins; ++k) count[k] += other.count[k];
  }
  TexelErrors errors() const {
    TexelErrors result;
    result.texels = texels;
    if (texels == 0) return result;
    result.psnr_db = psnr_of(squares / static_cast<double>(texels));
    std::uint64_t below = 0;
    for (std::size_t k = 0; k < bins && below * 100 <= texels; ++k) {
      below += count[k];
      result.worst_psnr_db = static_cast<double>(k) / 10;
    }
    return result;
  }
};

struct FittedBlock {
  std::vector<TexelSite> sites;
  std::vector<std::array<std::uint8_t, texel_features>> bytes;
  std::vector<float> errors;  // mean squared error per texel
};

FittedBlock fitted(const Composition& composition, const VisibleDirections& sightlines, const Student& student,
                   const std::vector<FeatureNetwork>& teachers, const BranchFit& branches, std::size_t number,
                   const std::optional<std::uint32_t>& branch, const TexelFit& fit) {
  const Composition::Block& block = composition.blocks[number];
  const Composition::Part& part = composition.parts[block.part];
  const FeatureNetwork& teacher = teachers[part.teacher];
  const NetworkKernels& kernels = network_kernels();
  FittedBlock result;
  result.sites = sites_of(composition, block);
  const std::vector<TexelGroup> groups = groups_of(composition, block, result.sites);
  const std::vector<Vec3> directions = sightlines.directions(result.sites, fitted_directions, 2 * number),
                          others = sightlines.directions(result.sites, held_out_view_directions, 2 * number + 1);
  std::vector<Lanes> work(workspace_of(student, teachers));
  result.bytes.resize(result.sites.size());
  result.errors.resize(result.sites.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const TexelGroup& group = groups[g];
    const auto seen = view_samples_of(teacher, group, directions, number + g, work.data());
    Lanes features[texel_features], error;
    if (branch) {
      branches.fit(*branch, part, group, seen, fit, features, &error, work.data());
    } else {
      initial_guess(student, teacher, part, group, seen, features, work.data());
      TexelFit own = fit;
      if (needs_only_rounding(student, part)) own.iterations = 0;
      kernels.fit_texels(student.decoder.view(), seen.data(), seen.size(), own, features, &error, work.data());
    }
    for (std::size_t l = 0; l < group.count; ++l) {
      auto& bytes = result.bytes[group.site[l]];
      for (std::size_t c = 0; c < texel_features; ++c)
        bytes[c] = static_cast<std::uint8_t>(std::lround(255 * features[c].at[l]));
    }
    const auto held_out = view_samples_of(teacher, group, others, number + g, work.data());
    kernels.fit_texels(student.decoder.view(), held_out.data(), held_out.size(), {}, features, &error, work.data());
    for (std::size_t l = 0; l < group.count; ++l)
      result.errors[group.site[l]] = static_cast<float>(static_cast<double>(error.at[l]) / weight_of(held_out));
  }
  return result;
}

}  // namespace

void check(const FuseOptions& options) {
  if (options.width && (*options.width < 4 || *options.width > static_cast<int>(widest_layer)))
    throw FieldError("width", fmt::format("must be auto, or 4 to {}", widest_layer));
  if (!(options.psnr_db > 0 && options.psnr_db <= 100)) throw FieldError("psnr", "must be above 0 and at most 100");
  if (!(options.seconds >= 0) || !std::isfinite(options.seconds)) throw FieldError("seconds", "must be 0 or more");
  if (options.bits < 4 || options.bits > 8) throw FieldError("bits", "must be 4 to 8");
}

namespace {

// Fits the features of all blocks to the chosen student.
class FeatureFitter {
 public:
  FeatureFitter(const Composition& composition, const VisibleDirections& sightlines, const FusePlan& plan,
                const FuseOptions& options, const Progress& progress)
      : composition_(composition),
        sightlines_(sightlines),
        plan_(plan),
        options_(options),
        progress_(progress),
        student_(plan.candidates[plan.chosen].student),
        teachers_(networks_of(composition)),
        code_(options.layout == Layout::unsplit ? AlphaCode::plain : AlphaCode::halved),
        levels_(feature_levels(options.bits, code_)),
        branches_(composition, student_),
        branch_of_(branches_.choose(sightlines, static_cast<std::size_t>(options.iterations), progress)),
        errors_(composition.blocks.size()) {
    for (const TextureSet& page : composition.pages) pages_.emplace_back(*with_alpha_code(page.texels, code_));
    for (std::size_t b = 0; b < composition.blocks.size(); ++b)
      if (!kept(composition.parts[composition.blocks[b].part])) order_.push_back(b);
  }

  // Returns false if the time limit ended the fit.
  bool run() {
    const bool fits = options_.iterations > 0;
    if (fits && (plan_.until || options_.until_psnr)) {
      // First an initial guess of all blocks. Then the worst blocks are fitted first, until the target or the time
      // limit is reached.
      pass({0, levels_.data(), false}, "guessing features", false);
      sort_by_error();
    }
    return pass({static_cast<std::size_t>(options_.iterations), levels_.data(), options_.search && fits},
                "fitting features", fits);
  }

  // Converting plain to halved alpha loses the lowest bit, so these texels are rounded again and measured.
  bool kept(const Composition::Part& part) const {
    return stays(student_, part) && !(part.plain_alpha && code_ == AlphaCode::halved);
  }
  const Student& student() const { return student_; }
  /// Mean squared errors of the fitted texels, per block.
  const std::vector<std::vector<float>>& errors() const { return errors_; }
  /// The pages with the fitted features; only once.
  std::vector<TextureSet> finished() {
    std::vector<TextureSet> sets;
    for (std::size_t page = 0; page < pages_.size(); ++page) {
      const Soup& soup = composition_.pages[page].soup;
      sets.push_back({Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces()), pages_[page]->finish()});
      pages_[page].reset();
    }
    return sets;
  }

 private:
  bool pass(const TexelFit& fit, const char* what, bool may_stop) {
    constexpr std::size_t at_once = 128;
    std::vector<FittedBlock> results;
    for (std::size_t first = 0; first < order_.size(); first += at_once) {
      progress_.at(what, static_cast<double>(first) / static_cast<double>(order_.size()));
      if (may_stop && plan_.until && Clock::now() > *plan_.until) return false;
      const std::size_t some = std::min(at_once, order_.size() - first);
      results.assign(some, {});
      tbb::parallel_for(std::size_t{0}, some, [&](std::size_t k) {
        results[k] = fitted(composition_, sightlines_, student_, teachers_, branches_, order_[first + k],
                            branch_of_[order_[first + k]], fit);
      });
      for (std::size_t k = 0; k < some; ++k) write(order_[first + k], results[k]);
    }
    return true;
  }

  void write(std::size_t block, FittedBlock& result) {
    FeatureTexture::Change& page = *pages_[composition_.blocks[block].page];
    for (std::size_t t = 0; t < result.sites.size(); ++t) {
      Texel& texel = page.at(result.sites[t].x, result.sites[t].y);
      for (std::size_t c = 0; c < texel_features; ++c) {
        const std::uint8_t value = result.bytes[t][c];
        (c < 4 ? texel.feat0 : texel.feat1)[c % 4] =
            c % 4 == 3 && code_ == AlphaCode::halved ? static_cast<std::uint8_t>(128 + value / 2) : value;
      }
    }
    errors_[block] = std::move(result.errors);
  }

  // Sorts the blocks by their error, the largest first, and drops those that are good enough.
  void sort_by_error() {
    std::vector<double> mean(errors_.size());
    for (const std::size_t b : order_)
      if (!errors_[b].empty())
        mean[b] = std::accumulate(errors_[b].begin(), errors_[b].end(), 0.0) / static_cast<double>(errors_[b].size());
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t x, std::size_t y) { return mean[x] > mean[y]; });
    if (options_.until_psnr) std::erase_if(order_, [&](std::size_t b) { return psnr_of(mean[b]) >= options_.psnr_db; });
  }

  const Composition& composition_;
  const VisibleDirections& sightlines_;
  const FusePlan& plan_;
  const FuseOptions& options_;
  const Progress& progress_;
  const Student& student_;
  std::vector<FeatureNetwork> teachers_;
  AlphaCode code_;
  decltype(feature_levels(8, AlphaCode::plain)) levels_;
  BranchFit branches_;
  std::vector<std::optional<std::uint32_t>> branch_of_;
  std::vector<std::optional<FeatureTexture::Change>> pages_;
  std::vector<std::size_t> order_;  // the blocks to fit, in fitting order
  std::vector<std::vector<float>> errors_;
};

// Adds the errors of all texels, and per node, separately for kept and fitted texels.
void report_errors(const Composition& composition, const FeatureFitter& fitter, FuseReport& report) {
  Histogram whole;
  std::vector<Histogram> of_part(composition.parts.size());
  for (std::size_t b = 0; b < fitter.errors().size(); ++b) {
    const Composition::Block& block = composition.blocks[b];
    Histogram& histogram = of_part[block.part];
    for (const float error : fitter.errors()[b]) histogram.add(static_cast<double>(error));
    report.fitted_texels += fitter.errors()[b].size();
    if (fitter.kept(composition.parts[block.part])) histogram.add_exact(block.opaque);
  }
  std::vector<std::pair<NodeId, bool>> keys;
  std::vector<Histogram> of_key;
  for (std::size_t p = 0; p < of_part.size(); ++p) {
    const Composition::Part& part = composition.parts[p];
    const std::pair key(part.node, fitter.kept(part));
    const auto at = static_cast<std::size_t>(std::find(keys.begin(), keys.end(), key) - keys.begin());
    if (at == keys.size()) {
      keys.push_back(key);
      of_key.emplace_back();
      report.parts.push_back({part.name, key.second, {}});
    }
    of_key[at].add(of_part[p]);
    whole.add(of_part[p]);
  }
  for (std::size_t k = 0; k < keys.size(); ++k) report.parts[k].errors = of_key[k].errors();
  report.whole = whole.errors();
}

}  // namespace

Fused fuse(const Composition& composition, const VisibleDirections& sightlines, const FusePlan& plan,
           const FuseOptions& options, const Progress& progress) {
  check(options);
  const Clock::time_point start = Clock::now();
  FuseReport report;
  for (const FuseCandidate& candidate : plan.candidates) report.trials.push_back(candidate.trial);
  report.chosen = plan.chosen;
  FeatureFitter fitter(composition, sightlines, plan, options, progress);
  report.in_time = fitter.run();
  report_errors(composition, fitter, report);

  const Student& student = fitter.student();
  auto object = std::make_shared<BakedObject>();
  object->sets = fitter.finished();
  object->axes = composition.forward ? Axes::forward : Axes::y_up;
  object->layout = options.layout;
  object->decoder = std::make_shared<const Decoder>(
      student.keeps ? fold_rotation(*composition.teachers[student.branches.front().teacher],
                                    student.branches.front().turn.transpose(), Axes::forward, object->axes)
                    : fold_rotation(student.decoder.to_decoder(), Mat3::Identity(), Axes::forward, object->axes));
  report.seconds = seconds_since(start);
  return {std::move(object), std::move(report)};
}

}  // namespace rebake
