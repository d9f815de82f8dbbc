#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <map>

#include <fmt/format.h>
#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/features/distill/fuse.h"
#include "mesh_ops/features/distill/fuse_errors.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

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

// The teacher with most texels, or with Keep::node the one with most unbent triangles of that node; only of those that
// MobileNeRF can store. Nullopt if there are none, which with Keep::node throws FieldError.
std::optional<std::size_t> base_of(const Composition& composition, const FuseOptions& options) {
  std::vector<std::uint64_t> texels(composition.teachers.size());
  const bool one = options.keep == FuseOptions::Keep::node;
  // Shared texels count for the first copy only, so the teachers of a node are ranked by triangles.
  if (one)
    for (const Composition::Part& part : composition.parts)
      if (part.node == options.keep_node && !part.bent) texels[part.teacher] += part.triangles;
  if (!one)
    for (const Composition::Block& block : composition.blocks)
      texels[composition.parts[block.part].teacher] += block.opaque;
  for (std::size_t k = 0; k < texels.size(); ++k)
    if (composition.teachers[k]->rule != ColorRule::network) texels[k] = 0;
  const auto most = std::max_element(texels.begin(), texels.end());
  if (*most == 0 && one)
    throw FieldError("keep",
                     "must be auto, none, or the name of a visible MobileNeRF object that has unbent triangles");
  if (*most == 0) return std::nullopt;
  return static_cast<std::size_t>(most - texels.begin());
}

int width_of(const Student& student) {
  return static_cast<int>(std::max(student.decoder.hidden0, student.decoder.hidden1));
}

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
    if (base_) base_width_ = std::max(composition.teachers[*base_]->hidden0(), composition.teachers[*base_]->hidden1());
    all_are_networks_ = std::ranges::all_of(composition.teachers,
                                            [](const auto& teacher) { return teacher->rule == ColorRule::network; });
    check_methods();
    sample_ = sampled(composition, sightlines, options.sample, training_.seed, progress);
  }

  FusePlan run() {
    // Side-by-side students are built first, because they are quickest.
    try_side_by_side(1, 1);
    const Clock::time_point begun = Clock::now();
    if ((wants(FuseMethod::keep) || wants(FuseMethod::train)) && (candidates().empty() || !late()))
      kept_ = keeping(composition_, sample_, *base_, training_, progress_);
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
    if (!base_ && (way == FuseMethod::keep || way == FuseMethod::train)) return false;
    if (!all_are_networks_ && way == FuseMethod::side_by_side) return false;
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
      throw all_are_networks_
          ? FieldError("keep", "contradicts the chosen fusing method")
          : FieldError("way", "does not suit objects of other formats than MobileNeRF: choose new, or leave it out");
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
  std::optional<std::size_t> base_;
  bool all_are_networks_ = true;  // whether all decoders follow ColorRule::network
  int base_width_ = 0;
  TexelSample sample_;
  std::optional<Student> kept_;
};

}  // namespace

FusePlan plan_fuse(const Composition& composition, const VisibleDirections& sightlines, const FuseOptions& options,
                   const Progress& progress) {
  check(options);
  return FusePlanner(composition, sightlines, options, progress).run();
}

}  // namespace rebake
