#include "mesh_ops/light/lighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "mesh_ops/light/light_receiver.h"
#include "mesh_ops/light/transfer_model.h"

namespace rebake {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

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

Lighting lighting_of(const Scene& scene, const LightingOptions& options, const Progress& progress) {
  Lighting result;
  if (!scene.light) return result;
  const SceneLight& settings = *scene.light;
  const bool estimated = settings.source == SceneLight::Source::estimated;
  std::vector<PlacedNode> objects;
  for (PlacedNode& placed : placed_nodes(scene))
    if (placed.visible && placed.node->object && placed.node->object->triangle_count() > 0)
      objects.push_back(std::move(placed));

  struct Candidate {
    std::size_t decision;
    std::size_t receiver;
    enum class Kind { self, removed, cast, highlights } kind;
    std::size_t caster = 0;
  };
  BakedLights known(settings, options);
  std::vector<LightReceiver> receivers;
  receivers.reserve(objects.size());
  for (std::size_t k = 0; k < objects.size(); ++k) receivers.emplace_back(objects, k, settings, options, known);
  std::vector<Candidate> candidates;
  const auto say = [&](const char* kind, const std::string& whose, double change, std::string why) {
    result.decisions.push_back({kind, fmt::format("{} {}", kind, whose), false, change, 0, std::move(why), ""});
    return result.decisions.size() - 1;
  };
  const auto add_estimate = [&](const char* kind, const std::string& whose, const ChangeEstimate& estimate) {
    const std::size_t line = say(kind, whose, estimate.change, estimate.words());
    result.decisions[line].estimated = true;
    return line;
  };
  const std::vector<MatchedLight> matches = matched_lights(settings, receivers, progress);
  const auto matched = [&](std::size_t k) { return matches[k].light != nullptr; };
  const auto light_for = [&](std::size_t k) {
    return LightReceiver::Shared{matches[k].light.get(), matches[k].to_light};
  };
  // If an object deformed and also lost parts, both shadows are traced together. Maps the self-shadow's decision to the
  // removed shadow's decision, which it follows.
  std::map<std::size_t, std::size_t> follows;
  std::vector<std::shared_ptr<const GlossFit>> gloss(receivers.size());
  std::vector<std::optional<std::size_t>> own_line(receivers.size());
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    LightReceiver& receiver = receivers[k];
    const bool self = settings.self && receiver.moved(), removed = settings.removed && receiver.missing();
    std::optional<std::size_t> own;
    if (!settings.self)
      say("self-shadow", receiver.name(), 0, "disabled in the light settings");
    else if (!self)
      say("self-shadow", receiver.name(), 0, "no triangle moved relative to its object");
    else
      own = removed ? say("self-shadow", receiver.name(), 0, "")
                    : add_estimate("self-shadow", receiver.name(), receiver.sampled_change(true, false, progress));
    own_line[k] = own;
    if (own && !removed) candidates.push_back({*own, k, Candidate::Kind::self});
    if (self && !settings.highlights) say("highlights", receiver.name(), 0, "disabled in the light settings");
    if (self && settings.highlights) {
      gloss[k] = receiver.gloss(light_for(k), progress);
      if (gloss[k])
        candidates.push_back({add_estimate("highlights", receiver.name(), receiver.estimated_gloss_change(*gloss[k])),
                              k, Candidate::Kind::highlights});
      else
        say("highlights", receiver.name(), 0, receiver.no_gloss_reason(light_for(k)));
    }
    if (receiver.missing() && !removed) say("removed shadow", receiver.name(), 0, "disabled in the light settings");
    if (removed) {
      const std::size_t line =
          add_estimate("removed shadow", receiver.name(), receiver.sampled_change(receiver.moved(), true, progress));
      candidates.push_back({line, k, Candidate::Kind::removed});
      if (own) follows[*own] = line;
    }
    for (std::size_t other = 0; other < receivers.size(); ++other) {
      if (other == k || receiver.related(other)) continue;
      const std::string pair = fmt::format("{}→{}", receivers[other].name(), receiver.name());
      if (!settings.cast)
        say("cast shadow", pair, 0, "disabled in the light settings");
      else
        candidates.push_back({say("cast shadow", pair, receiver.cast_bound(other, light_for(k), progress), ""), k,
                              Candidate::Kind::cast, other});
    }
  }
  // The smallest changes are omitted while their sum stays within the budget.
  std::vector<std::size_t> order(candidates.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return result.decisions[candidates[a].decision].change < result.decisions[candidates[b].decision].change;
  });
  for (const std::size_t k : order) {
    LightDecision& decision = result.decisions[candidates[k].decision];
    const double sum = result.left_out + decision.change;
    // In a matched light, an object's own shadows are never omitted.
    const bool in_other_light =
        (candidates[k].kind == Candidate::Kind::self || candidates[k].kind == Candidate::Kind::removed) &&
        matched(candidates[k].receiver);
    decision.runs = options.everything || in_other_light || sum > settings.budget;
    decision.why = fmt::format("{} {:.3g} of 255, {:.3g} omitted before it; budget {:.3g}{}",
                               decision.estimated ? "about" : "at most", decision.change * 255, result.left_out * 255,
                               settings.budget * 255, decision.estimated ? "; estimate: " + decision.why : "");
    if (!decision.runs) result.left_out = sum;
    if (candidates[k].kind == Candidate::Kind::highlights)
      decision.why += fmt::format("; explains {:.0f} % of the view dependence of colours",
                                  100 * gloss[candidates[k].receiver]->explained);
  }
  for (const auto& [line, other] : follows) {
    result.decisions[line].runs = result.decisions[other].runs;
    result.decisions[line].why = "traced together with the removed shadow";
  }
  // Highlights are traced together with the self-shadow: if they run, both run.
  for (const Candidate& candidate : candidates) {
    if (candidate.kind != Candidate::Kind::highlights || !result.decisions[candidate.decision].runs) continue;
    LightDecision& own = result.decisions[*own_line[candidate.receiver]];
    if (own.runs) continue;
    own.runs = true;
    own.why = "traced together with the highlights";
    result.left_out -= own.change;
  }
  const auto gloss_for = [&](std::size_t k) {
    if (!gloss[k] && settings.highlights) gloss[k] = receivers[k].gloss(light_for(k), progress);
    return gloss[k];
  };
  for (std::size_t k = 0; k < receivers.size(); ++k) {
    if (!matched(k) && !matches[k].why.empty()) say("matched light", receivers[k].name(), 0, matches[k].why);
    bool self = false, removed = false, highlights = false;
    std::vector<std::size_t> casters;
    std::vector<std::size_t> running;
    for (const Candidate& candidate : candidates) {
      if (candidate.receiver != k || !result.decisions[candidate.decision].runs) continue;
      running.push_back(candidate.decision);
      self = self || candidate.kind == Candidate::Kind::self;
      removed = removed || candidate.kind == Candidate::Kind::removed;
      highlights = highlights || candidate.kind == Candidate::Kind::highlights;
      if (candidate.kind == Candidate::Kind::cast) casters.push_back(candidate.caster);
    }
    self = self || highlights || (removed && receivers[k].moved());
    const bool turning = options.turning.contains(objects[k].node->id);
    if (running.empty() && !matched(k) && !turning) continue;
    const Clock::time_point start = Clock::now();
    LightReceiver::Change change =
        receivers[k].change(self, removed, casters, light_for(k),
                            highlights || (turning && settings.self) ? gloss_for(k) : nullptr, progress);
    if (turning)
      if (auto turned = receivers[k].turned(change, casters, light_for(k), progress))
        result.turning[objects[k].node->id] = std::move(turned);
    if (running.empty() && !matched(k)) continue;
    if (!highlights) change.mirrors.reset();
    result.maps[objects[k].node->id] = receivers[k].maps(change);
    const double seconds = seconds_since(start);
    result.lights[objects[k].node->id] = receivers[k].light(progress);
    if (matched(k)) {
      say("matched light", receivers[k].name(), 0, matches[k].why);
      result.decisions.back().runs = true;
      running.push_back(result.decisions.size() - 1);
    }
    // An object's effects are traced together, so they share the time.
    for (const std::size_t decision : running) {
      result.decisions[decision].seconds = seconds / static_cast<double>(running.size());
      result.decisions[decision].took =
          running.size() > 1 ? fmt::format("took {:.2f} s for all effects on {}", seconds, receivers[k].name())
                             : fmt::format("took {:.2f} s", seconds);
    }
    if (estimated) {
      say("light estimate", receivers[k].name(), 0,
          fmt::format("explains {:.0f} % of the variance of its colours", 100 * receivers[k].confidence()));
      result.decisions.back().runs = true;
    }
  }
  result.estimated = std::any_of(result.decisions.begin(), result.decisions.end(),
                                 [](const LightDecision& one) { return !one.runs && one.estimated; });
  result.summary = summarised(result.decisions);
  return result;
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
      if (*range <= LearntTransfer::trusted_range)
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
