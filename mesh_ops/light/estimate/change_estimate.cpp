#include "mesh_ops/light/estimate/change_estimate.h"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "mesh_ops/index/numbering.h"

namespace rebake {

double ChangeEstimate::share_beyond() const {
  if (places >= of) return 0;
  return places == 0 ? 1 : 1 - std::pow(1 - confidence, 1 / static_cast<double>(places));
}

std::string ChangeEstimate::words() const {
  if (places >= of) return fmt::format("sampled all {} places", of);
  return fmt::format(
      "sampled {} of {} places: with {:.0f} % confidence, at most {:.2g} % of them change by more than half of "
      "that",
      places, of, confidence * 100, share_beyond() * 100);
}

std::vector<std::size_t> sample_places(const std::vector<std::uint8_t>& places, std::size_t most) {
  std::vector<std::size_t> all;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k] != 0) all.push_back(k);
  if (all.size() <= most) return all;
  std::set<std::size_t> picked;
  for (std::size_t k = all.size() - most; k < all.size(); ++k) {
    constexpr std::uint64_t seed = 0x6c;
    const std::size_t any = mixed(k, seed, all.size()) % (k + 1);
    picked.insert(picked.contains(any) ? k : any);
  }
  std::vector<std::size_t> result;
  for (const std::size_t k : picked) result.push_back(all[k]);
  return result;
}

}  // namespace rebake
