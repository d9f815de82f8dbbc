#pragma once

#include <map>
#include <optional>
#include <string>

#include "mesh_ops/base/result_cache.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// A cache of results in memory that counts how many were found.
struct CountingResults final : ResultCache {
  std::map<std::string, std::string> held;
  int found = 0;
  std::optional<std::string> find(const std::string& key) override {
    const auto it = held.find(key);
    if (it == held.end()) return std::nullopt;
    ++found;
    return it->second;
  }
  void keep(const std::string& key, std::string_view bytes) override { held[key] = bytes; }
};

/// One object: a box over a ground plane, on which its shadow under a uniform sky is baked.
Scene table();
/// The scene after a light edit with a uniform source.
Scene with_light(const Scene& scene);

/// The decision with this name; null if there is none.
const LightDecision* decision_named(const Lighting& lighting, const std::string& name);
bool runs(const Lighting& lighting, const std::string& name);

}  // namespace rebake::test
