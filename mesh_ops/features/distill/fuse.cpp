#include "mesh_ops/features/distill/fuse.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>

#include "mesh_ops/base/error.h"
#include "mesh_ops/features/distill/branch_fit.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr std::size_t fitted_directions = 24, held_out_view_directions = 8;

double psnr_of(double mean_square) { return mean_square > 0 ? std::min(100.0, -10 * std::log10(mean_square)) : 100; }

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

double weight_of(const std::vector<ViewSample>& view_samples) {
  double sum = 0;
  for (const ViewSample& s : view_samples) sum += 3 * static_cast<double>(s.weight);
  return sum;
}

// Mean squared error of a group's texels over some observations.
double error_over(const Student& student, const std::vector<ViewSample>& view_samples, std::size_t texels,
                  Lanes* features, Lanes* work) {
  Lanes error;
  network_kernels().fit_texels(student.decoder.view(), view_samples.data(), view_samples.size(), {}, features, &error,
                               work);
  double sum = 0;
  for (std::size_t l = 0; l < texels; ++l) sum += static_cast<double>(error.at[l]);
  return sum / weight_of(view_samples) / static_cast<double>(texels);
}

struct PsnrEstimate {
  double psnr_db = 100;
  std::string node;  ///< the worst node
};

// Estimates the PSNR of the worst node after fitting, on the sample: of single texels or of texels mixed as in pixels,
// whichever is lower, because pictures show either, depending on distance. Errors are averaged within a node only,
// because a node of few texels may fill a picture. A fit of a side-by-side student also keeps to one branch per block,
// which is ignored here.
PsnrEstimate judged(const Student& student, const Composition& composition, const TexelSample& sample,
                    const FuseOptions& options, const Progress& progress) {
  const std::vector<FeatureNetwork> teachers = networks_of(composition);
  const auto levels = feature_levels(options.bits, AlphaCode::halved);
  struct Errors {
    double alone = 0, mixed = 0;
  };
  std::vector<Errors> errors(sample.pieces.size());
  progress.at("scoring", 0);
  tbb::parallel_for(std::size_t{0}, errors.size(), [&](std::size_t k) {
    const TexelSample::Piece& piece = sample.pieces[k];
    const Composition::Part& part = composition.parts[piece.part];
    if (stays(student, part)) return;
    std::vector<Lanes> work(workspace_of(student, teachers));
    const FeatureNetwork& teacher = teachers[part.teacher];
    const std::vector<Vec3> directions(piece.directions.begin(), piece.directions.begin() + fitted_directions);
    const auto seen = view_samples_of(teacher, piece.group, directions, k, work.data()),
               held_out = view_samples_of(teacher, piece.group, piece.held_out, k, work.data());
    Lanes features[texel_features], error;
    initial_guess(student, teacher, part, piece.group, seen, features, work.data());
    const std::size_t iterations =
        needs_only_rounding(student, part) ? 0 : static_cast<std::size_t>(options.iterations);
    network_kernels().fit_texels(student.decoder.view(), seen.data(), seen.size(),
                                 {iterations, levels.data(), options.search && options.iterations > 0}, features,
                                 &error, work.data());
    std::vector<ViewSample> alone, mixed;
    for (const ViewSample& view_sample : held_out)
      (view_sample.mix == 0 && view_sample.coverage == 1 ? alone : mixed).push_back(view_sample);
    errors[k] = {error_over(student, alone, piece.group.count, features, work.data()),
                 error_over(student, mixed, piece.group.count, features, work.data())};
  });
  // Parts are weighted by their texels, not by their share of the sample.
  std::vector<double> texels(composition.parts.size()), pieces(texels.size());
  std::vector<Errors> sums(texels.size());
  for (const Composition::Block& block : composition.blocks) texels[block.part] += block.opaque;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const std::uint32_t part = sample.pieces[k].part;
    sums[part].alone += errors[k].alone;
    sums[part].mixed += errors[k].mixed;
    ++pieces[part];
  }
  struct NodeQuality {
    Errors errors;
    double texels = 0;
    std::string name;
  };
  std::map<NodeId, NodeQuality> nodes;
  for (std::size_t p = 0; p < texels.size(); ++p) {
    if (pieces[p] == 0) continue;
    NodeQuality& node = nodes[composition.parts[p].node];
    node.errors.alone += texels[p] * sums[p].alone / pieces[p];
    node.errors.mixed += texels[p] * sums[p].mixed / pieces[p];
    node.texels += texels[p];
    node.name = composition.parts[p].name;
  }
  PsnrEstimate worst;
  for (const auto& [id, node] : nodes) {
    const double psnr = psnr_of(std::max(node.errors.alone, node.errors.mixed) / node.texels);
    if (psnr < worst.psnr_db) worst = {psnr, node.name};
  }
  return worst;
}

// The teacher with most texels, or with Keep::node the one with most unbent triangles of that node. Throws FieldError
// if there are none.
std::size_t base_of(const Composition& composition, const FuseOptions& options) {
  std::vector<std::uint64_t> texels(composition.teachers.size());
  const bool one = options.keep == FuseOptions::Keep::node;
  // Shared texels count for the first copy only, so the teachers of a node are ranked by triangles.
  if (one)
    for (const Composition::Part& part : composition.parts)
      if (part.node == options.keep_node && !part.bent) texels[part.teacher] += part.triangles;
  if (!one)
    for (const Composition::Block& block : composition.blocks)
      texels[composition.parts[block.part].teacher] += block.opaque;
  const auto most = std::max_element(texels.begin(), texels.end());
  if (*most == 0)
    throw FieldError("keep", "must be auto, none, or the name of a visible object that has unbent triangles");
  return static_cast<std::size_t>(most - texels.begin());
}

int width_of(const Student& student) {
  return static_cast<int>(std::max(student.decoder.hidden0, student.decoder.hidden1));
}

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

// Trains candidates until one reaches the target or time is up, and chooses one.
class FusePlanner {
 public:
  FusePlanner(const Composition& composition, const VisibleDirections& sightlines, const FuseOptions& options,
              const Progress& progress)
      : composition_(composition), options_(options), progress_(progress), training_(options.training) {
    const Clock::time_point start = Clock::now();
    if (options.seconds > 0) {
      plan_.until = start + duration(options.seconds);
      // A third of the time is for training decoders: the fit of features gains more from the rest.
      training_.until = start + duration(options.seconds / 3);
    }
    base_ = base_of(composition, options);
    base_width_ = std::max(composition.teachers[base_]->hidden0(), composition.teachers[base_]->hidden1());
    check_methods();
    sample_ = sampled(composition, sightlines, options.sample, training_.seed, progress);
  }

  FusePlan run() {
    // Side-by-side students are built first, because they are quickest.
    try_side_by_side(1, 1);
    const Clock::time_point begun = Clock::now();
    if ((wants(FuseMethod::keep) || wants(FuseMethod::train)) && (candidates().empty() || !late()))
      kept_ = keeping(composition_, sample_, base_, training_, progress_);
    if (kept_ && wants(FuseMethod::keep) && (!options_.width || base_width_ <= *options_.width))
      consider(*kept_, FuseMethod::keep, begun);
    const bool kept_is_enough =
        !candidates().empty() && candidates().back().trial.way == FuseMethod::keep && reaches(candidates().back());
    try_side_by_side(2, max_branches - 1);
    train_by_width(kept_is_enough);
    if (candidates().empty())
      throw FieldError("width", fmt::format("is {}, but the decoder that training starts from has width {}",
                                            *options_.width, base_width_));
    choose();
    return std::move(plan_);
  }

 private:
  static Clock::duration duration(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }
  std::vector<FuseCandidate>& candidates() { return plan_.candidates; }
  bool late() const { return training_.until && Clock::now() > *training_.until; }
  bool wants(FuseMethod way) const {
    if (options_.keep == FuseOptions::Keep::node && way != FuseMethod::keep) return false;
    if (options_.keep == FuseOptions::Keep::none && way == FuseMethod::keep) return false;
    return !options_.way || *options_.way == way;
  }
  bool reaches(const FuseCandidate& c) const { return c.trial.psnr_db >= options_.psnr_db; }
  bool any_reaches() const {
    return std::ranges::any_of(plan_.candidates, [&](const FuseCandidate& c) { return reaches(c); });
  }

  // Throws FieldError for options that contradict each other.
  void check_methods() const {
    if (!wants(FuseMethod::keep) && !wants(FuseMethod::train) && !wants(FuseMethod::scratch) &&
        !wants(FuseMethod::side_by_side))
      throw FieldError("keep", "contradicts the chosen fusing method");
    const bool must_keep = options_.keep == FuseOptions::Keep::node || options_.way == FuseMethod::keep;
    if (must_keep && options_.width && *options_.width < base_width_)
      throw FieldError("width", fmt::format("is {}, but the kept decoder has width {}", *options_.width, base_width_));
  }

  // Adds a candidate. Returns its estimated PSNR.
  double consider(Student student, FuseMethod way, Clock::time_point begun) {
    FuseTrial trial{width_of(student), way, 0, {}, 0, 0};
    const Clock::time_point trained = Clock::now();
    const auto fitted = std::ranges::count_if(sample_.pieces, [&](const TexelSample::Piece& piece) {
      return !stays(student, composition_.parts[piece.part]);
    });
    double texels = 0;
    for (const Composition::Block& block : composition_.blocks)
      if (!stays(student, composition_.parts[block.part])) texels += block.opaque;
    const PsnrEstimate judgement = judged(student, composition_, sample_, options_, progress_);
    trial.psnr_db = judgement.psnr_db;
    trial.worst_node = judgement.node;
    if (fitted > 0) trial.fit_seconds = seconds_since(trained) / static_cast<double>(fitted) / network_lanes * texels;
    trial.seconds = seconds_since(begun);
    candidates().push_back({std::move(student), trial});
    return trial.psnr_db;
  }

  // More rotations of bent parts are added only until the target is reached.
  void try_side_by_side(std::size_t first, std::size_t last) {
    for (std::size_t bent_turns = first; bent_turns <= last && wants(FuseMethod::side_by_side) && !any_reaches();
         ++bent_turns) {
      const Clock::time_point begun = Clock::now();
      Student student = side_by_side(composition_, sample_, bent_turns);
      const int width = width_of(student);
      if (options_.width && width > *options_.width) {
        if (options_.way == FuseMethod::side_by_side && candidates().empty())
          throw FieldError("width",
                           fmt::format("is {}, but the decoders side by side have width {}", *options_.width, width));
        return;
      }
      const std::size_t branches = student.branches.size();
      if (bent_turns == 1 || candidates().empty() || branches > candidates().back().student.branches.size())
        consider(std::move(student), FuseMethod::side_by_side, begun);
    }
  }

  void train_by_width(bool kept_is_enough) {
    // Doubling the width gains about 2 dB. Once a candidate reaches the target, further widths are tried only while the
    // last one was within 6 dB of it.
    constexpr double hopeless = 6;
    double last = options_.psnr_db;
    std::vector<int> widths{16, 24, 32};
    if (options_.width)
      widths = {*options_.width};
    else if (options_.way == FuseMethod::train && base_width_ > widths.back())
      widths = {base_width_};
    for (const int width : widths) {
      const bool narrower_may_do = !options_.width && !kept_is_enough && last >= options_.psnr_db - hopeless;
      if (!candidates().empty() && (late() || (any_reaches() && !narrower_may_do))) break;
      last = train(width);
      if (last >= options_.psnr_db) break;
    }
  }

  // Adds the trained candidates of one width. Returns the best PSNR; 0 if none was trained.
  double train(int width) {
    const auto wide = static_cast<std::size_t>(width);
    double best = 0;
    if (kept_ && wants(FuseMethod::train) && base_width_ <= width) {
      const Clock::time_point begun = Clock::now();
      best = consider(fine_tuned(*kept_, composition_, sample_, wide, training_, progress_), FuseMethod::train, begun);
    }
    // Training from scratch is skipped for a single teacher, whose decoder already suits all texels.
    if (wants(FuseMethod::scratch) && (composition_.teachers.size() > 1 || candidates().empty() || options_.way)) {
      const Clock::time_point begun = Clock::now();
      best = std::max(
          best, consider(from_scratch(composition_, sample_, wide, training_, progress_), FuseMethod::scratch, begun));
    }
    return best;
  }

  void choose() {
    // Unless `until_psnr` is set, a candidate of 50 dB is preferred even if it is wider.
    constexpr double as_good_as_exact = 50;
    const auto excels = [&](const FuseCandidate& c) {
      return !options_.until_psnr && c.trial.psnr_db >= std::max(as_good_as_exact, options_.psnr_db);
    };
    // Prefers the narrowest that is good enough, else the best.
    const auto better = [&](const FuseCandidate& a, const FuseCandidate& b) {
      if (!options_.width) {
        if (excels(a) != excels(b)) return excels(a);
        if (reaches(a) != reaches(b)) return reaches(a);
        if (reaches(a) && a.trial.width != b.trial.width) return a.trial.width < b.trial.width;
      }
      return a.trial.psnr_db > b.trial.psnr_db;
    };
    plan_.chosen = static_cast<std::size_t>(std::min_element(candidates().begin(), candidates().end(), better) -
                                            candidates().begin());
  }

  const Composition& composition_;
  const FuseOptions& options_;
  const Progress& progress_;
  TrainingOptions training_;
  FusePlan plan_;
  std::size_t base_ = 0;
  int base_width_ = 0;
  TexelSample sample_;
  std::optional<Student> kept_;
};

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

FusePlan plan_fuse(const Composition& composition, const VisibleDirections& sightlines, const FuseOptions& options,
                   const Progress& progress) {
  check(options);
  return FusePlanner(composition, sightlines, options, progress).run();
}

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
