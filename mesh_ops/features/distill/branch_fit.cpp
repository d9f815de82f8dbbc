#include "mesh_ops/features/distill/branch_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>

#include "mesh_ops/features/distill/smooth_labels.h"
#include "mesh_ops/index/footprint.h"
#include "mesh_ops/index/weld.h"

namespace rebake {

namespace {

// Smoothness cost: squared error in display colours per texel of border between two branches, whose pixels mix. On the
// bent ficus, 0.001 to 0.01 give the same result, 0.03 loses 0.2 dB, and 0 (no smoothness) loses 1.7 dB.
constexpr double mixed_error = 0.01;
// Cost of a branch that a block must not use.
constexpr double never = 1e6;
// Numbers of groups and of directions per block that are sampled to choose its branch.
constexpr std::size_t sampled_groups = 4, sampled_directions = 8;

// Pairs of adjacent blocks, whose texels may be mixed in one pixel, with the cost of different branches.
std::vector<LabelBorder> borders_of(const Composition& composition) {
  // The triangles of all pages: their welded corners, across patches, and the blocks of each.
  BakedObject all;
  all.sets = composition.pages;
  std::vector<std::shared_ptr<const WeldedSet>> welded;
  std::vector<std::size_t> first{0};
  for (const TextureSet& page : all.sets) {
    welded.push_back(std::make_shared<const WeldedSet>(weld_set(page.soup)));
    first.push_back(first.back() + page.soup.triangle_count());
  }
  const std::vector<std::uint32_t> places = weld(all, welded, 0).places;
  std::vector<std::vector<std::uint32_t>> blocks_of(first.back());
  for (std::uint32_t b = 0; b < composition.blocks.size(); ++b) {
    const Composition::Block& block = composition.blocks[b];
    for (std::uint32_t k = 0; k < block.face_count; ++k)
      blocks_of[first[block.page] + composition.faces[block.first_face + k]].push_back(b);
  }
  const auto distance = [&](std::uint32_t block, const Vec2& at) {
    const TexelRect& rect = composition.blocks[block].rect;
    return std::max({rect.left - at.x(), at.x() - rect.right - 1, rect.top - at.y(), at.y() - rect.bottom - 1, 0.0});
  };
  struct Side {
    std::uint32_t from, to, block;
    double texels;
  };
  std::vector<Side> sides;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> lengths;
  for (std::size_t page = 0; page < all.sets.size(); ++page)
    for (std::size_t f = first[page]; f < first[page + 1]; ++f) {
      const std::vector<std::uint32_t>& blocks = blocks_of[f];
      if (blocks.empty()) continue;
      const std::array<Vec2, 3> corners = texel_corners(all.sets[page], f - first[page]);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 &from = corners[k], &to = corners[(k + 1) % 3], middle = (from + to) / 2;
        // The block nearest to the middle of the edge.
        const std::uint32_t block = *std::min_element(
            blocks.begin(), blocks.end(),
            [&](std::uint32_t a, std::uint32_t b) { return distance(a, middle) < distance(b, middle); });
        const auto [low, high] = std::minmax(places[3 * f + k], places[3 * f + (k + 1) % 3]);
        sides.push_back({low, high, block, (to - from).norm()});
      }
      // Blocks of one patch are adjacent if they share a side, not only a corner.
      for (std::size_t i = 0; i < blocks.size(); ++i)
        for (std::size_t j = i + 1; j < blocks.size(); ++j) {
          const TexelRect &a = composition.blocks[blocks[i]].rect, &b = composition.blocks[blocks[j]].rect;
          const int across = std::min(a.right, b.right) - std::max(a.left, b.left) + 1,
                    along = std::min(a.bottom, b.bottom) - std::max(a.top, b.top) + 1;
          if ((across == 0 && along > 0) || (along == 0 && across > 0))
            lengths[std::minmax(blocks[i], blocks[j])] = std::max(across, along);
        }
    }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return std::pair(a.from, a.to) < std::pair(b.from, b.to); });
  for (std::size_t k = 1; k < sides.size(); ++k) {
    const Side &a = sides[k - 1], &b = sides[k];
    if (a.from == b.from && a.to == b.to && a.block != b.block)
      lengths[std::minmax(a.block, b.block)] += (a.texels + b.texels) / 2;
  }
  std::vector<LabelBorder> borders;
  for (const auto& [blocks, texels] : lengths) borders.push_back({blocks.first, blocks.second, mixed_error * texels});
  return borders;
}

}  // namespace

BranchFit::BranchFit(const Composition& composition, const Student& student)
    : composition_(composition), student_(student), branches_of_(composition.teachers.size()) {
  for (std::uint32_t k = 0; k < student.branches.size(); ++k) {
    const Student::Branch& branch = student.branches[k];
    networks_.emplace_back(
        fold_rotation(*composition.teachers[branch.teacher], branch.turn.transpose(), Axes::forward, Axes::forward));
    branches_of_[branch.teacher].push_back(k);
  }
}

void BranchFit::fit_own(std::uint32_t branch, const TexelGroup& group, const std::vector<ViewSample>& view_samples,
                        std::size_t iterations, Lanes* features, Lanes* error, Lanes* work) const {
  std::copy_n(group.features, texel_features, features);
  network_kernels().fit_texels(networks_[branch].view(), view_samples.data(), view_samples.size(), {iterations},
                               features, error, work);
}

void BranchFit::fit(std::uint32_t branch, const Composition::Part& part, const TexelGroup& group,
                    const std::vector<ViewSample>& view_samples, const TexelFit& how, Lanes* features, Lanes* error,
                    Lanes* work) const {
  const bool exact = needs_only_rounding(student_, part);
  // Fitted in the branch's own features, which are always stored within its sector.
  fit_own(branch, group, view_samples, exact ? 0 : how.iterations, features, error, work);
  encode_for(student_.branches[branch], features);
  TexelFit rounding = how;
  rounding.iterations = 0;
  rounding.not_searched = exact ? 0 : student_.selectors;
  network_kernels().fit_texels(student_.decoder.view(), view_samples.data(), view_samples.size(), rounding, features,
                               error, work);
}

std::vector<std::optional<std::uint32_t>> BranchFit::choose(const VisibleDirections& sightlines, std::size_t iterations,
                                                            const Progress& progress) const {
  std::vector<std::optional<std::uint32_t>> result(composition_.blocks.size());
  // Only side-by-side students have separate branches.
  if (student_.encoder) return result;
  const auto branches_of = [&](const Composition::Block& block) -> const std::vector<std::uint32_t>& {
    return branches_of_[composition_.parts[block.part].teacher];
  };
  std::vector<std::vector<double>> costs(composition_.blocks.size(),
                                         std::vector<double>(student_.branches.size(), never));
  std::atomic<bool> any_choice = false;
  const std::vector<FeatureNetwork> teachers = networks_of(composition_);
  const auto cost_of = [&](std::size_t b) {
    const Composition::Block& block = composition_.blocks[b];
    const Composition::Part& part = composition_.parts[block.part];
    const std::vector<std::uint32_t>& branches = branches_of(block);
    if (branches.empty()) {
      // The teacher has no branch: any branch will do, and neighbours are not influenced.
      costs[b].assign(student_.branches.size(), 0);
      return;
    }
    if (branches.size() < 2 || needs_only_rounding(student_, part)) {
      costs[b][branches.front()] = 0;
      return;
    }
    any_choice = true;
    const std::vector<TexelSite> sites = sites_of(composition_, block);
    const std::vector<TexelGroup> groups = groups_of(composition_, block, sites);
    const std::vector<Vec3> directions = sightlines.directions(sites, sampled_directions, 2 * b);
    std::vector<Lanes> work(workspace_of(student_, teachers));
    for (const std::uint32_t branch : branches) costs[b][branch] = 0;
    const std::size_t looked_at = std::min(groups.size(), sampled_groups);
    for (std::size_t k = 0; k < looked_at; ++k) {
      const TexelGroup& group = groups[(2 * k + 1) * groups.size() / (2 * looked_at)];
      const auto seen = view_samples_of(teachers[part.teacher], group, directions, b, work.data());
      double weight = 0;
      for (const ViewSample& view_sample : seen) weight += 3 * static_cast<double>(view_sample.weight);
      for (const std::uint32_t branch : branches) {
        Lanes features[texel_features], error;
        fit_own(branch, group, seen, iterations, features, &error, work.data());
        for (std::size_t l = 0; l < group.count; ++l)
          costs[b][branch] += static_cast<double>(error.at[l]) / weight / static_cast<double>(group.count) *
                              block.opaque / static_cast<double>(looked_at);
      }
    }
  };
  // Number of blocks between checks for cancellation.
  constexpr std::size_t at_once = 128;
  for (std::size_t first = 0; first < costs.size(); first += at_once) {
    progress.at("choosing branches", static_cast<double>(first) / static_cast<double>(costs.size()));
    tbb::parallel_for(first, std::min(first + at_once, costs.size()), cost_of);
  }
  std::vector<std::uint32_t> labels(costs.size());
  if (any_choice)
    labels = smooth_labels(costs, borders_of(composition_));
  else
    for (std::size_t b = 0; b < labels.size(); ++b)
      if (!branches_of(composition_.blocks[b]).empty()) labels[b] = branches_of(composition_.blocks[b]).front();
  for (std::size_t b = 0; b < labels.size(); ++b)
    if (!branches_of(composition_.blocks[b]).empty()) result[b] = labels[b];
  return result;
}

}  // namespace rebake
