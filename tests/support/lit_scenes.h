#pragma once

#include <map>
#include <optional>
#include <string>

#include "mesh_ops/base/results.h"
#include "mesh_ops/light/lighting.h"
#include "mesh_ops/scene/scene.h"

namespace rebake::test {

/// Results that are kept as long as it lives.
struct Remembered final : Results {
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

/// A box over a ground, which it shades under a uniform sky: one object.
Scene table();
/// In uniform light, by the edit.
Scene with_light(const Scene& scene);

/// What was decided under this name; null where nothing was.
const LightDecision* decided(const Lighting& lighting, const std::string& name);
bool runs(const Lighting& lighting, const std::string& name);

}  // namespace rebake::test
