#include "mesh_ops/light/learned/dprt_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "mesh_ops/base/error.h"
#include "mesh_ops/base/hash.h"

namespace rebake {

namespace {

constexpr const char* network_kind = "rebake DPRT network 1";
constexpr int most_side = 2048, most_channels = 128;

// The numbers of the ranges in the order of the file.
constexpr std::size_t range_numbers = 4 + 2 * sh::count;

}  // namespace

DprtNetwork::DprtNetwork(Unet net, const Ranges& ranges) : net_(std::move(net)), ranges_(ranges) {
  bool fits = ranges.center.allFinite() && std::isfinite(ranges.reach) && ranges.reach > 0;
  for (std::size_t c = 0; c < sh::count; ++c)
    fits = fits && std::isfinite(ranges.low[c]) && std::isfinite(ranges.high[c]) && ranges.low[c] <= ranges.high[c];
  if (!fits) throw std::invalid_argument("the ranges of a network are empty or not finite");
}

std::vector<float> DprtNetwork::image_of(const std::vector<LightSite>& sites, const Ranges& ranges) {
  const std::size_t texels = sites.size();
  std::vector<float> planes(unet_inputs * texels);
  for (std::size_t t = 0; t < texels; ++t) {
    const Vec3 place = (sites[t].position - ranges.center) / ranges.reach;
    for (std::size_t c = 0; c < 3; ++c) {
      planes[c * texels + t] = static_cast<float>(place[static_cast<Eigen::Index>(c)]);
      planes[(3 + c) * texels + t] = static_cast<float>(sites[t].normal[static_cast<Eigen::Index>(c)]);
    }
  }
  return planes;
}

std::vector<float> DprtNetwork::predict(const std::vector<LightSite>& sites) const {
  const auto texels = static_cast<std::size_t>(net_.side()) * static_cast<std::size_t>(net_.side());
  if (sites.size() != texels) throw std::invalid_argument("the sites do not match the network's image");
  std::vector<float> result = net_.run(image_of(sites, ranges_));
  for (std::size_t c = 0; c < sh::count; ++c)
    for (std::size_t t = 0; t < texels; ++t) {
      float& value = result[c * texels + t];
      value = ranges_.low[c] + value * (ranges_.high[c] - ranges_.low[c]);
    }
  return result;
}

std::string DprtNetwork::bytes() const {
  const nlohmann::json head = {{"kind", network_kind}, {"side", net_.side()}, {"channels", net_.channels()}};
  std::string result = head.dump() + "\n";
  std::vector<float> numbers;
  for (const double c : ranges_.center) numbers.push_back(static_cast<float>(c));
  numbers.push_back(static_cast<float>(ranges_.reach));
  numbers.insert(numbers.end(), ranges_.low.begin(), ranges_.low.end());
  numbers.insert(numbers.end(), ranges_.high.begin(), ranges_.high.end());
  numbers.insert(numbers.end(), net_.weights().begin(), net_.weights().end());
  result.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float));
  const std::uint64_t hash = content_hash(result);
  result.append(reinterpret_cast<const char*>(&hash), sizeof hash);
  return result;
}

DprtNetwork DprtNetwork::parsed(std::string_view bytes) {
  const std::size_t line = bytes.substr(0, 1024).find('\n');
  const nlohmann::json head =
      line == std::string_view::npos ? nlohmann::json() : nlohmann::json::parse(bytes.substr(0, line), nullptr, false);
  if (!head.is_object() || head.value("kind", nlohmann::json()) != network_kind)
    throw Error("the file is no network of deep precomputed radiance transfer");
  const auto number = [&](const char* key, int most) {
    const auto found = head.find(key);
    if (found == head.end() || !found->is_number_integer() || *found < 1 || *found > most)
      throw Error(fmt::format("\"{}\" must be a number from 1 to {}", key, most));
    return found->get<int>();
  };
  const int side = number("side", most_side), channels = number("channels", most_channels);
  if (channels % 8 != 0) throw Error("\"channels\" must be a multiple of 8");
  const std::size_t weights = unet_weight_count(UnetForm::concatenated, channels), first = line + 1;
  const std::size_t size = first + (range_numbers + weights) * sizeof(float) + sizeof(std::uint64_t);
  if (bytes.size() != size)
    throw Error(fmt::format("the file has {} bytes instead of {}; copy it again", bytes.size(), size));
  std::uint64_t hash = 0;
  std::memcpy(&hash, bytes.data() + size - sizeof hash, sizeof hash);
  if (content_hash(bytes.substr(0, size - sizeof hash)) != hash) throw Error("the file is damaged; copy it again");
  std::vector<float> numbers(range_numbers + weights);
  std::memcpy(numbers.data(), bytes.data() + first, numbers.size() * sizeof(float));
  Ranges ranges;
  const float* next = numbers.data();
  for (double& c : ranges.center) c = static_cast<double>(*next++);
  ranges.reach = static_cast<double>(*next++);
  std::copy_n(next, sh::count, ranges.low.begin());
  std::copy_n(next + sh::count, sh::count, ranges.high.begin());
  next += 2 * sh::count;
  try {
    return {Unet(UnetForm::concatenated, side, channels, std::vector<float>(next, next + weights)), ranges};
  } catch (const std::invalid_argument& fault) {
    throw Error(fault.what());
  }
}

}  // namespace rebake
