#include "mesh_ops/light/transport/site_bundles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>

namespace rebake {

namespace {

std::vector<SiteBundles::Side> sides_of(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                                        std::size_t sets, std::vector<std::size_t>& first) {
  std::vector<SiteBundles::Side> sides;
  for (std::size_t set = 0; set < sets; ++set) {
    first.push_back(sides.size());
    for (std::size_t i = set; i < sites.size(); i += sets)
      for (std::uint8_t side = 0; side < 2; ++side)
        if ((wanted.empty() || (wanted[i] >> side & 1) != 0) && sites[i].normal.squaredNorm() > 0.5)
          sides.push_back({static_cast<std::uint32_t>(i), side, side == 0 ? sites[i].normal : Vec3(-sites[i].normal)});
  }
  first.push_back(sides.size());
  return sides;
}

}  // namespace

std::vector<Vec3> SiteBundles::starts_of(std::span<const LightSite> sites, const std::vector<Side>& sides) {
  std::vector<Vec3> starts;
  starts.reserve(sides.size());
  for (const Side& one : sides)
    starts.push_back(sites[one.site].position + sites[one.site].offset[one.side] * one.normal);
  return starts;
}

SiteBundles::SiteBundles(std::span<const LightSite> sites, std::span<const std::uint8_t> wanted,
                         const SceneRays& around, std::size_t sets)
    : sides_(sides_of(sites, wanted, sets, first_)), rays_(around, starts_of(sites, sides_)) {}

void SiteBundles::send(std::size_t set, std::span<const Vec3> directions, Ways ways, const MayPass& may_pass,
                       const Progress& progress, std::string_view what, double from, double to,
                       const std::function<void(std::size_t side, const Batch& batch)>& visit) const {
  // Rays per batch (the bits of Batch::passes), sides per visiting task, and sides per tracing task: a few megabytes of
  // scratch per thread.
  constexpr std::size_t most = 64, sides_at_once = 256, chunk = std::size_t{1} << 17;
  const std::size_t begin = first_[set], size = first_[set + 1] - begin, chunks = (size + chunk - 1) / chunk;
  std::vector<std::vector<std::uint8_t>> hidden(std::min(most, directions.size()));
  std::atomic<std::size_t> done = 0;
  for (std::size_t first = 0; first < directions.size(); first += most) {
    const std::size_t count = std::min(most, directions.size() - first);
    for (std::size_t k = 0; k < count; ++k) hidden[k].assign(size, 0);
    tbb::parallel_for(std::size_t{0}, count * chunks, [&](std::size_t task) {
      progress.at(what,
                  from + (to - from) * static_cast<double>(done++) / static_cast<double>(directions.size() * chunks));
      const std::size_t k = task / chunks, start = task % chunks * chunk, end = std::min(size, start + chunk);
      const Vec3& direction = directions[first + k];
      std::vector<std::int8_t> asked(end - start);
      for (std::size_t i = start; i < end; ++i) {
        const double above = sides_[begin + i].normal.dot(direction);
        if (above == 0 || (above < 0 && ways == Ways::forward) || (may_pass && !may_pass(begin + i, first + k)))
          hidden[k][i] = 1;
        else
          asked[i - start] = above > 0 ? 1 : -1;
      }
      rays_.shade(direction, begin + start, asked, std::span(hidden[k]).subspan(start, end - start));
    });
    tbb::parallel_for(std::size_t{0}, (size + sides_at_once - 1) / sides_at_once, [&](std::size_t block) {
      const std::size_t end = std::min(size, (block + 1) * sides_at_once);
      for (std::size_t i = block * sides_at_once; i < end; ++i) {
        Batch batch{first, count, 0};
        for (std::size_t k = 0; k < count; ++k) batch.passes |= std::uint64_t{hidden[k][i] == 0} << k;
        visit(begin + i, batch);
      }
    });
  }
  progress.at(what, to);
}

}  // namespace rebake
