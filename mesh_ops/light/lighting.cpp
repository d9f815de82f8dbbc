#include "mesh_ops/light/lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>

#include "mesh_ops/base/duration.h"
#include "mesh_ops/light/learned/transfer_model.h"
#include "mesh_ops/light/light_receiver.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;

// The common light that an object is placed in (SceneLight::match).
struct MatchedLight {
  std::shared_ptr<const Light> light;  // null: the object keeps its own light
  Mat3 to_light = Mat3::Identity();    // rotates world directions into the light's space
  std::string why;
};
std::vector<MatchedLight> matched_lights(const SceneLight& settings, std::vector<LightReceiver>& receivers,
                                         const Progress& progress) {
  std::vector<MatchedLight> result(receivers.size());
  if (!settings.match || receivers.empty()) return result;
  LightReceiver& first = receivers.front();
  if (settings.source != SceneLight::Source::estimated) {
    // A given light is fixed in world space.
    for (MatchedLight& match : result) match = {first.light(progress), Mat3::Identity(), "the given light"};
    return result;
  }
  const Radiance common = first.light(progress)->mean_irradiance();
  for (std::size_t k = 1; k < receivers.size(); ++k) {
    // Colours determine the distribution of a light, but not its brightness and tint, which are ambiguous with albedo.
    // Those are not matched.
    const Radiance own = receivers[k].light(progress)->mean_irradiance();
    if (!((common.array() > 0).all() && (own.array() > 0).all())) {
      result[k].why = "could not estimate light in all three channels from the colours of " +
                      (own.minCoeff() > 0 ? first : receivers[k]).name();
      continue;
    }
    result[k] = {std::make_shared<const Light>(first.light(progress)->scaled(own.cwiseQuotient(common))),
                 first.turn().transpose(),
                 fmt::format("distribution of light from {}, with its own brightness and tint", first.name())};
  }
  return result;
}

}  // namespace

std::shared_ptr<const LightMap> Lighting::map_of(NodeId node, std::size_t number, const TextureSet& set) const {
  const auto found = maps.find(node);
  if (found == maps.end() || number >= found->second.size()) return nullptr;
  const std::shared_ptr<const LightMap>& map = found->second[number];
  return map && map->chart->uvs == set.soup.shared_uvs() ? map : nullptr;
}

namespace {

// Decides and traces the light effects of a scene: add_candidates() per object, then choose(), then trace() per object.
class SceneLighting {
 public:
  SceneLighting(const Scene& scene, const LightingOptions& options, const Progress& progress)
      : settings_(*scene.light),
        options_(options),
        progress_(progress),
        objects_(lit_objects(scene)),
        known_(settings_, options) {
    receivers_.reserve(objects_.size());
    for (std::size_t k = 0; k < objects_.size(); ++k) receivers_.emplace_back(objects_, k, settings_, options, known_);
    matches_ = matched_lights(settings_, receivers_, progress);
    gloss_.resize(receivers_.size());
    own_line_.resize(receivers_.size());
  }

  Lighting run() {
    for (std::size_t k = 0; k < receivers_.size(); ++k) {
      add_own_candidates(k);
      add_cast_shadows(k);
    }
    choose();
    for (std::size_t k = 0; k < receivers_.size(); ++k) trace(k);
    result_.estimated = std::any_of(result_.decisions.begin(), result_.decisions.end(),
                                    [](const LightDecision& one) { return !one.runs && one.estimated; });
    result_.summary = summarised(result_.decisions);
    return std::move(result_);
  }

 private:
  // An effect on one object that may run.
  struct Candidate {
    std::size_t decision;
    std::size_t receiver;
    enum class Kind { self, removed, cast, highlights } kind;
    std::size_t caster = 0;
  };

  static std::vector<PlacedNode> lit_objects(const Scene& scene) {
    std::vector<PlacedNode> objects;
    for (PlacedNode& placed : placed_nodes(scene))
      if (placed.visible && placed.node->object && placed.node->object->triangle_count() > 0)
        objects.push_back(std::move(placed));
    return objects;
  }

  std::size_t say(const char* kind, const std::string& whose, double change, std::string why) {
    result_.decisions.push_back({kind, fmt::format("{} {}", kind, whose), false, change, 0, std::move(why), ""});
    return result_.decisions.size() - 1;
  }
  std::size_t add_estimate(const char* kind, const std::string& whose, const ChangeEstimate& estimate) {
    const std::size_t line = say(kind, whose, estimate.change, estimate.words());
    result_.decisions[line].estimated = true;
    return line;
  }
  bool matched(std::size_t k) const { return matches_[k].light != nullptr; }
  LightReceiver::Shared light_for(std::size_t k) const { return {matches_[k].light.get(), matches_[k].to_light}; }

  // Effects of an object's own edits.
  void add_own_candidates(std::size_t k) {
    LightReceiver& receiver = receivers_[k];
    const bool self = settings_.self && receiver.moved(), removed = settings_.removed && receiver.missing();
    std::optional<std::size_t> own;
    if (!settings_.self)
      say("self-shadow", receiver.name(), 0, "disabled in the light settings");
    else if (!self)
      say("self-shadow", receiver.name(), 0, "no triangle moved relative to its object");
    else
      own = removed ? say("self-shadow", receiver.name(), 0, "")
                    : add_estimate("self-shadow", receiver.name(), receiver.sampled_change(true, false, progress_));
    own_line_[k] = own;
    if (own && !removed) candidates_.push_back({*own, k, Candidate::Kind::self});
    if (self && !settings_.highlights) say("highlights", receiver.name(), 0, "disabled in the light settings");
    if (self && settings_.highlights) {
      gloss_[k] = receiver.gloss(light_for(k), progress_);
      if (gloss_[k])
        candidates_.push_back({add_estimate("highlights", receiver.name(), receiver.estimated_gloss_change(*gloss_[k])),
                               k, Candidate::Kind::highlights});
      else
        say("highlights", receiver.name(), 0, receiver.no_gloss_reason(light_for(k)));
    }
    if (receiver.missing() && !removed) say("removed shadow", receiver.name(), 0, "disabled in the light settings");
    if (!removed) return;
    const std::size_t line =
        add_estimate("removed shadow", receiver.name(), receiver.sampled_change(receiver.moved(), true, progress_));
    candidates_.push_back({line, k, Candidate::Kind::removed});
    if (own) follows_[*own] = line;
  }

  void add_cast_shadows(std::size_t k) {
    LightReceiver& receiver = receivers_[k];
    for (std::size_t other = 0; other < receivers_.size(); ++other) {
      if (other == k || receiver.related(other)) continue;
      const std::string pair = fmt::format("{}→{}", receivers_[other].name(), receiver.name());
      if (!settings_.cast)
        say("cast shadow", pair, 0, "disabled in the light settings");
      else
        candidates_.push_back({say("cast shadow", pair, receiver.cast_bound(other, light_for(k), progress_), ""), k,
                               Candidate::Kind::cast, other});
    }
  }

  // The smallest changes are omitted while their sum stays within the budget.
  void choose() {
    std::vector<std::size_t> order(candidates_.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return result_.decisions[candidates_[a].decision].change < result_.decisions[candidates_[b].decision].change;
    });
    for (const std::size_t k : order) decide(candidates_[k]);
    for (const auto& [line, other] : follows_) {
      result_.decisions[line].runs = result_.decisions[other].runs;
      result_.decisions[line].why = "traced together with the removed shadow";
    }
    // Highlights are traced together with the self-shadow: if they run, both run.
    for (const Candidate& candidate : candidates_) {
      if (candidate.kind != Candidate::Kind::highlights || !result_.decisions[candidate.decision].runs) continue;
      LightDecision& own = result_.decisions[*own_line_[candidate.receiver]];
      if (own.runs) continue;
      own.runs = true;
      own.why = "traced together with the highlights";
      result_.left_out -= own.change;
    }
  }

  void decide(const Candidate& candidate) {
    LightDecision& decision = result_.decisions[candidate.decision];
    const double sum = result_.left_out + decision.change;
    // In a matched light, an object's own shadows are never omitted.
    const bool in_other_light =
        (candidate.kind == Candidate::Kind::self || candidate.kind == Candidate::Kind::removed) &&
        matched(candidate.receiver);
    decision.runs = options_.everything || in_other_light || sum > settings_.budget;
    decision.why = fmt::format("{} {:.3g} of 255, {:.3g} omitted before it; budget {:.3g}{}",
                               decision.estimated ? "about" : "at most", decision.change * 255, result_.left_out * 255,
                               settings_.budget * 255, decision.estimated ? "; estimate: " + decision.why : "");
    if (!decision.runs) result_.left_out = sum;
    if (candidate.kind == Candidate::Kind::highlights)
      decision.why += fmt::format("; explains {:.0f} % of the view dependence of colours",
                                  100 * gloss_[candidate.receiver]->explained);
  }

  std::shared_ptr<const GlossFit> gloss_for(std::size_t k) {
    if (!gloss_[k] && settings_.highlights) gloss_[k] = receivers_[k].gloss(light_for(k), progress_);
    return gloss_[k];
  }

  // The effects on one object that run.
  struct Running {
    bool self = false, removed = false, highlights = false;
    std::vector<std::size_t> casters;
    std::vector<std::size_t> decisions;
  };
  Running running_on(std::size_t k) const {
    Running running;
    for (const Candidate& candidate : candidates_) {
      if (candidate.receiver != k || !result_.decisions[candidate.decision].runs) continue;
      running.decisions.push_back(candidate.decision);
      running.self = running.self || candidate.kind == Candidate::Kind::self;
      running.removed = running.removed || candidate.kind == Candidate::Kind::removed;
      running.highlights = running.highlights || candidate.kind == Candidate::Kind::highlights;
      if (candidate.kind == Candidate::Kind::cast) running.casters.push_back(candidate.caster);
    }
    running.self = running.self || running.highlights || (running.removed && receivers_[k].moved());
    return running;
  }

  void trace(std::size_t k) {
    if (!matched(k) && !matches_[k].why.empty()) say("matched light", receivers_[k].name(), 0, matches_[k].why);
    Running running = running_on(k);
    const NodeId node = objects_[k].node->id;
    const bool turning = options_.turning.contains(node);
    if (running.decisions.empty() && !matched(k) && !turning) return;
    const Clock::time_point start = Clock::now();
    LightReceiver::Change change =
        receivers_[k].change(running.self, running.removed, running.casters, light_for(k),
                             running.highlights || (turning && settings_.self) ? gloss_for(k) : nullptr, progress_);
    if (turning)
      if (auto turned = receivers_[k].turned(change, running.casters, light_for(k), progress_))
        result_.turning[node] = std::move(turned);
    if (running.decisions.empty() && !matched(k)) return;
    if (!running.highlights) change.mirrors.reset();
    result_.maps[node] = receivers_[k].maps(change);
    const double seconds = seconds_since(start);
    result_.lights[node] = receivers_[k].light(progress_);
    report(k, std::move(running.decisions), seconds);
  }

  // Adds times to the decisions of an object's traced effects.
  void report(std::size_t k, std::vector<std::size_t> running, double seconds) {
    if (matched(k)) {
      running.push_back(say("matched light", receivers_[k].name(), 0, matches_[k].why));
      result_.decisions.back().runs = true;
    }
    // An object's effects are traced together, so they share the time.
    for (const std::size_t decision : running) {
      result_.decisions[decision].seconds = seconds / static_cast<double>(running.size());
      result_.decisions[decision].took =
          running.size() > 1 ? fmt::format("took {:.2f} s for all effects on {}", seconds, receivers_[k].name())
                             : fmt::format("took {:.2f} s", seconds);
    }
    if (settings_.source != SceneLight::Source::estimated) return;
    say("light estimate", receivers_[k].name(), 0,
        fmt::format("explains {:.0f} % of the variance of its colours", 100 * receivers_[k].confidence()));
    result_.decisions.back().runs = true;
  }

  const SceneLight& settings_;
  const LightingOptions& options_;
  const Progress& progress_;
  Lighting result_;
  std::vector<PlacedNode> objects_;
  BakedLights known_;
  std::vector<LightReceiver> receivers_;
  std::vector<MatchedLight> matches_;
  std::vector<Candidate> candidates_;
  std::vector<std::shared_ptr<const GlossFit>> gloss_;
  std::vector<std::optional<std::size_t>> own_line_;
  // If an object deformed and also lost parts, both shadows are traced together: self-shadow's decision → removed
  // shadow's decision, which it follows.
  std::map<std::size_t, std::size_t> follows_;
};

}  // namespace

Lighting lighting_of(const Scene& scene, const LightingOptions& options, const Progress& progress) {
  if (!scene.light) return {};
  return SceneLighting(scene, options, progress).run();
}

std::optional<Lighting> dragged_lighting(const Scene& start_scene, const Lighting& start, const Scene& scene) {
  if (!scene.light || !start_scene.light || !(*scene.light == *start_scene.light)) return std::nullopt;
  const std::vector<PlacedNode> before = placed_nodes(start_scene), now = placed_nodes(scene);
  if (before.size() != now.size()) return std::nullopt;
  Lighting result = start;
  for (std::size_t k = 0; k < now.size(); ++k) {
    const PlacedNode &a = before[k], &b = now[k];
    if (a.node->id != b.node->id || a.visible != b.visible || a.to_world.matrix() != b.to_world.matrix())
      return std::nullopt;
    if (a.node->object == b.node->object || !b.visible) continue;
    const auto turning = start.turning.find(b.node->id);
    if (turning == start.turning.end() || !b.node->object || !turning->second->fits(*b.node->object))
      return std::nullopt;
    const Clock::time_point began = Clock::now();
    result.maps[b.node->id] = turning->second->maps(*b.node->object);
    const double seconds = seconds_since(began);
    std::string why = "preview: rotated with the moving triangles";
    if (const std::optional<double> range = turning->second->range_of(*b.node->object); range) {
      if (*range <= LearnedTransfer::trusted_range)
        why += ", corrected by the trained model";
      else
        why += fmt::format("; trained model not used: the pose is at {:.1f} times the range of its training poses",
                           *range);
    }
    result.lights.try_emplace(b.node->id, turning->second->start().lights.front().light);
    const std::string name = "self-shadow " + b.node->name;
    // Replaces the decision from the start of the drag.
    std::erase_if(result.decisions, [&](const LightDecision& decision) { return decision.name == name; });
    result.decisions.push_back(
        {"self-shadow", name, true, 0, seconds, why, fmt::format("took {:.0f} ms", 1000 * seconds)});
  }
  result.summary = summarised(result.decisions);
  return result;
}

}  // namespace rebake
