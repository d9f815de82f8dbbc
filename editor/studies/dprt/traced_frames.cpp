#include "editor/studies/dprt/traced_frames.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <fstream>

#include "editor/studies/posed_body.h"
#include "mesh_ops/base/duration.h"
#include "mesh_ops/base/error.h"
#include "mesh_ops/base/files.h"
#include "mesh_ops/base/hash.h"
#include "mesh_ops/light/learned/disk_chart.h"

namespace rebake {

namespace fs = std::filesystem;

namespace {

// A file of traced frames: the hash of their positions, then one block of floats per frame. It is not
// portable and may end within a block.
class TraceCache {
 public:
  TraceCache(const fs::path& file, std::uint64_t hash, std::size_t block) : file_(file), block_(block) {
    if (file_.empty()) return;
    // Links to other files are replaced by a copy, so that those are not written to.
    if (std::error_code error;
        fs::is_symlink(file_, error) || (fs::exists(file_, error) && fs::hard_link_count(file_, error) > 1)) {
      const std::string bytes = fs::is_regular_file(file_, error) ? read_file(file_) : "";
      fs::remove(file_);
      write_file_atomically(file_, bytes, {});
    }
    std::ifstream in(file_, std::ios::binary);
    std::uint64_t known = 0;
    if (in.read(reinterpret_cast<char*>(&known), sizeof known) && known == hash) {
      std::vector<float> frame(block);
      while (in.read(reinterpret_cast<char*>(frame.data()), bytes())) frames_.push_back(frame);
      in.close();
      fs::resize_file(file_, sizeof hash + frames_.size() * static_cast<std::size_t>(bytes()));
    } else {
      in.close();
      fs::remove(file_);
      std::ofstream out(file_, std::ios::binary);
      out.write(reinterpret_cast<const char*>(&hash), sizeof hash);
    }
    out_.open(file_, std::ios::binary | std::ios::app);
    if (!out_) throw FileError(file_, "cannot be written");
  }
  std::vector<std::vector<float>> take_frames() { return std::move(frames_); }
  void add(const std::vector<float>& frame) {
    if (file_.empty()) return;
    out_.write(reinterpret_cast<const char*>(frame.data()), bytes());
    if (!out_.flush()) throw FileError(file_, "cannot be written; is the disk full?");
  }

 private:
  std::streamsize bytes() const { return static_cast<std::streamsize>(block_ * sizeof(float)); }
  fs::path file_;
  std::size_t block_;
  std::vector<std::vector<float>> frames_;
  std::ofstream out_;
};

std::uint64_t hash_of(const TracedFrames& traced, int rays) {
  std::string bytes = fmt::format("{} {} {} {} ", traced.side, rays, truth_rays_per_ray, traced.frames.size());
  const auto add = [&](const auto& values) {
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
  };
  add(traced.rest.vertices);
  std::uint64_t hash = content_hash(bytes);
  for (const std::vector<Vec3>& frame : traced.frames) {
    bytes = fmt::format("{} ", hash);
    add(frame);
    hash = content_hash(bytes);
  }
  return hash;
}

}  // namespace

std::vector<Vec3> texel_positions(const GeometryImage& image, const std::vector<Vec3>& vertices) {
  std::vector<Vec3> result;
  for (const GeometryImage::Texel& texel : image.texels()) {
    Vec3 place = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      place += static_cast<double>(texel.weights[static_cast<Eigen::Index>(k)]) * vertices[texel.vertices[k]];
    result.push_back(place);
  }
  return result;
}

FrameSites sites_of(const ProxyMesh& rest, const std::vector<Vec3>& frame) {
  const ProxyMesh posed{frame, rest.faces};
  FrameSites result{vertex_rotations(rest, posed), {}};
  result.sites = vertex_sites(rest, posed, result.turns);
  return result;
}

std::vector<float> traced_planes(const ProxyMesh& rest, const std::vector<Vec3>& frame, int rays) {
  const Transfer traced = traced_pose(rest, {frame, rest.faces}, rays).transfer;
  std::vector<float> planes(sh::count * frame.size());
  for (std::size_t t = 0; t < frame.size(); ++t)
    for (std::size_t c = 0; c < sh::count; ++c)
      planes[c * frame.size() + t] = static_cast<float>(traced.sites[t][static_cast<Eigen::Index>(c)]);
  return planes;
}

TracedFrames traced_frames(const AnimatedObject& object, int side, int rays, const fs::path& cache,
                           const Progress& progress) {
  TracedFrames result;
  result.side = side;
  const DiskChart chart = disk_chart(object.rest);
  const GeometryImage image(chart, side);
  result.mean_value = chart.mean_value;
  result.undersampled = image.undersampled(object.rest);
  result.rest = {texel_positions(image, object.rest.vertices), grid_chart(side).faces};
  for (const std::vector<Vec3>& frame : object.frames) result.frames.push_back(texel_positions(image, frame));
  result.hash = hash_of(result, rays);
  // Traces of other data have other names.
  fs::path file = cache;
  if (!file.empty()) file += fmt::format("-{:016x}.traces", result.hash);
  TraceCache kept(file, result.hash, sh::count * image.texels().size());
  result.transfer = kept.take_frames();
  const auto start = std::chrono::steady_clock::now();
  const std::size_t first = result.transfer.size();
  for (std::size_t k = first; k < result.frames.size(); ++k) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const std::size_t done = k - first;
    progress.at(fmt::format("tracing {} frames{}", result.frames.size(),
                            done > 10 ? about + remaining_text(seconds / static_cast<double>(done) *
                                                               static_cast<double>(result.frames.size() - k))
                                      : ""),
                static_cast<double>(k) / static_cast<double>(result.frames.size()));
    result.transfer.push_back(
        traced_planes(result.rest, result.frames[k], is_held_out(k) ? truth_rays_per_ray * rays : rays));
    kept.add(result.transfer.back());
  }
  return result;
}

}  // namespace rebake
