#include "editor/edits/nodes/register.h"

#include <fmt/format.h>

#include <algorithm>

#include "editor/edits/describe_edit.h"
#include "editor/edits/nodes/capture_pair.h"
#include "mesh_ops/registration/trimmed_icp.h"

namespace rebake {

namespace {

constexpr double certain_spread = 0.05;
// Largest scale and rotation in degrees by which surfaces refine pairs: more means that they do not belong together.
constexpr double largest_change = 1.5, largest_turn = 45;
// Residuals, relative to the extent of the points, above which pairs are doubtful.
constexpr double doubtful_residual = 0.05;

std::string words_of(const Similarity& motion) {
  return fmt::format("rotated by {:.4g}°, scaled by {:.6g}, moved by {:.6g}", motion.degrees(), motion.scale,
                     motion.shift.norm());
}

// The motion by the pairs; the identity without pairs.
Similarity motion_by_pairs(const Register& edit, Report& report) {
  if (edit.points.points.empty() && edit.onto.points.empty()) return {};
  const PairFit fit = fit_pairs(edit.points.points, edit.onto.points, edit.scale);
  std::string residuals;
  for (const double residual : fit.residuals)
    residuals += fmt::format("{}{:.4g}", residuals.empty() ? "" : ", ", residual);
  report.lines.push_back(
      fmt::format("pairs: {}; residuals {} (root mean square {:.4g})", words_of(fit.motion), residuals, fit.rms));
  if (fit.rms > doubtful_residual * fit.extent)
    report.lines.push_back(fmt::format("warning: the residuals are {:.0f} % of the points' extent: check the pairs",
                                       100 * fit.rms / fit.extent));
  if (fit.spread < certain_spread)
    report.lines.push_back(
        fmt::format("warning: the points are nearly on a line ({:.2g} of its length across): the "
                    "rotation about it is uncertain",
                    fit.spread));
  return fit.motion;
}

}  // namespace

Outcome apply(const Scene& scene, const Register& edit, const Progress& progress) {
  editable_with_children(scene, edit.node.id);
  if (edit.overlap && !(*edit.overlap >= 0.01 && *edit.overlap <= 1))
    throw FieldError("overlap", "must lie between 0.01 and 1");
  if (edit.samples < 1000 || edit.samples > 1'000'000) throw FieldError("samples", "must lie between 1000 and 1000000");
  if (!edit.refine && edit.points.points.empty()) throw FieldError("points", "must be given, unless refine is true");
  const CapturePair pair = capture_pair(scene, edit.node.id, edit.to);
  Report report;
  Affine motion = motion_by_pairs(edit, report).affine();
  if (edit.refine) {
    SurfaceSamples moved = sampled_surfaces(pair.changed, static_cast<std::size_t>(edit.samples), 1);
    const SurfaceSamples fixed = sampled_surfaces(pair.fixed, 5 * static_cast<std::size_t>(edit.samples), 2);
    for (Vec3& point : moved.points) point = motion * point;
    for (Vec3& normal : moved.normals) normal = (motion.linear() * normal).normalized();
    const IcpResult fit = trimmed_icp(moved, fixed, {edit.scale, edit.overlap}, progress);
    if (!(fit.motion.scale >= 1 / largest_change && fit.motion.scale <= largest_change) ||
        fit.motion.degrees() > largest_turn)
      throw EditError(
          fmt::format("the surfaces do not fit where the pairs bring them (refined, they would be {}): they may "
                      "not overlap, or pairs are wrong; register by better pairs, or with refine false",
                      words_of(fit.motion)));
    motion = fit.motion.affine() * motion;
    report.lines.push_back(fmt::format(
        "surfaces: {}; {:.0f} % overlap, distance {:.4g} (root mean square), {} iterations{}", words_of(fit.motion),
        fit.overlap * 100, fit.rms, fit.iterations, fit.converged ? "" : ", not converged"));
    if (fit.free_directions > 0)
      report.lines.push_back(fmt::format(
          "warning: the overlapping surfaces slide in {} directions, which they do not decide", fit.free_directions));
  }
  if (!motion.matrix().allFinite()) throw EditError("the motion is not finite");
  return {moved_in_world(scene, edit.node.id, motion), std::move(report)};
}

REBAKE_DESCRIBE_EDIT(
    Register,
    "Moves, rotates and scales a node onto another capture of the same place: by pairs of points, then by the opaque "
    "surfaces that overlap (trimmed ICP).",
    (auto& edit, auto& visit) {
      visit("node", edit.node, Need::required, "node that moves");
      visit("to", edit.to, Need::optional, "node that stays; default: all other visible objects");
      visit("points", edit.points, Need::optional, "at least three points of the node; default: it is nearly in place");
      visit("onto", edit.onto, Need::optional, "the same points of the capture that stays");
      visit("scale", edit.scale, Need::optional, "change the size, too");
      visit("refine", edit.refine, Need::optional, "refine by the surfaces");
      visit("overlap", edit.overlap, Need::optional,
            "share of the node's surface that the other capture has, too; default: found");
      visit("samples", edit.samples, Need::optional,
            "points of the node's surface, 1000 to 1000000; five times as many of the other");
    })

}  // namespace rebake
