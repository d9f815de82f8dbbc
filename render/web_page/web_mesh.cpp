#include "render/web_page/web_mesh.h"

#include <tbb/parallel_invoke.h>
#include <zlib.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace rebake {

namespace {

constexpr std::uint32_t absent = ~std::uint32_t{0};

// Streams of integers, each stored as differences of successive values: zigzag coded, in four planes of bytes. Nearby
// values and zeros compress well.
class Streams {
 public:
  explicit Streams(nlohmann::json& manifest) : manifest_(manifest) { manifest_ = nlohmann::json::array(); }

  void add(const std::string& name, const std::vector<std::int32_t>& values) {
    manifest_.push_back({{"name", name}, {"count", values.size()}});
    const std::size_t first = bytes_.size(), count = values.size();
    bytes_.resize(first + 4 * count);
    std::uint32_t before = 0;
    for (std::size_t k = 0; k < count; ++k) {
      // Unsigned, because differences may overflow.
      const std::uint32_t difference = static_cast<std::uint32_t>(values[k]) - before;
      const std::uint32_t code = (difference << 1) ^ (0U - (difference >> 31));
      before = static_cast<std::uint32_t>(values[k]);
      for (std::size_t plane = 0; plane < 4; ++plane)
        bytes_[first + plane * count + k] = static_cast<char>(code >> (8 * plane) & 255U);
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  nlohmann::json& manifest_;
  std::string bytes_;
};

// The faces in spatial order, and the vertices in the order in which these use them.
struct Order {
  std::vector<std::uint32_t> vertices;
  std::vector<std::int32_t> corners;
};
Order order_of(const PreparedSurface& surface) {
  Order order;
  std::vector<std::uint32_t> number(surface.vertices.size(), absent);
  for (const std::uint32_t f : *surface.shown.nearby)
    for (const std::uint32_t vertex : (*surface.shown.faces)[f]) {
      if (number[vertex] == absent) {
        number[vertex] = static_cast<std::uint32_t>(order.vertices.size());
        order.vertices.push_back(vertex);
      }
      order.corners.push_back(static_cast<std::int32_t>(number[vertex]));
    }
  return order;
}

std::int32_t on_grid(double value, double step) { return static_cast<std::int32_t>(std::llround(value / step)); }

// A unit quaternion as four 16-bit integers, and whether the matrix is −1 times it: the first bit of `mirrored`.
struct WebRotation {
  std::array<std::int32_t, 4> parts;
  std::int32_t mirrored;
};
WebRotation web_rotation(const Mat3& matrix) {
  const bool mirrored = matrix.determinant() < 0;
  const Eigen::Quaterniond q(mirrored ? Mat3(-matrix) : matrix);
  const double sign = q.w() < 0 ? -1 : 1;
  WebRotation made{};
  const double parts[] = {q.x(), q.y(), q.z(), q.w()};
  for (std::size_t k = 0; k < 4; ++k) made.parts[k] = static_cast<std::int32_t>(std::lround(sign * parts[k] * 32767));
  made.mirrored = mirrored ? 1 : 0;
  return made;
}

using Integers = std::vector<std::int32_t>;

template <class Value>
Integers values_of(const Order& order, const Value& value) {
  Integers values;
  values.reserve(order.vertices.size());
  for (const std::uint32_t v : order.vertices) values.push_back(value(v));
  return values;
}

// Places of the vertices' texels, in 1 / web_texel_steps texels from the corner of their rectangle in the packed
// texture.
void add_texels(Streams& streams, const Order& order, const PreparedSurface& surface) {
  const auto at = [&](std::uint32_t v, int axis) {
    const SurfaceVertex& vertex = surface.vertices[v];
    return static_cast<std::int32_t>(std::lround((vertex.texel[axis] - vertex.first_texel[axis]) * web_texel_steps));
  };
  for (const int axis : {0, 1})
    streams.add(axis == 0 ? "u" : "v", values_of(order, [&](std::uint32_t v) { return at(v, axis); }));
  for (const int axis : {0, 1})
    streams.add(axis == 0 ? "left" : "top",
                values_of(order, [&](std::uint32_t v) { return std::int32_t{surface.vertices[v].place[axis]}; }));
  for (const int axis : {0, 1})
    streams.add(axis == 0 ? "width" : "height", values_of(order, [&](std::uint32_t v) {
                  return surface.vertices[v].last_texel[axis] - surface.vertices[v].first_texel[axis];
                }));
}

// Rotations of a soup's vertices; no rotations are identities.
std::vector<std::pair<std::string, Integers>> rotations_of(const Order& order, const Soup& soup) {
  std::vector<std::pair<std::string, Integers>> parts{{"qx", {}}, {"qy", {}}, {"qz", {}}, {"qw", {}}, {"mirrored", {}}};
  for (const std::uint32_t v : order.vertices) {
    const WebRotation rotation =
        web_rotation(soup.rotations() != nullptr ? (*soup.rotations())[v].matrix() : Mat3::Identity());
    for (std::size_t k = 0; k < 4; ++k) parts[k].second.push_back(rotation.parts[k]);
    parts[4].second.push_back(rotation.mirrored);
  }
  return parts;
}

// Positions relative to an origin, on a grid.
std::vector<std::pair<std::string, Integers>> positions_of(const Order& order, const Soup& soup, const Vec3& origin,
                                                           double step) {
  std::vector<std::pair<std::string, Integers>> parts{{"x", {}}, {"y", {}}, {"z", {}}};
  for (const int axis : {0, 1, 2})
    parts[static_cast<std::size_t>(axis)].second =
        values_of(order, [&](std::uint32_t v) { return on_grid(soup.positions()[v][axis] - origin[axis], step); });
  return parts;
}

// A difference that may overflow.
std::int32_t changed(std::int32_t now, std::int32_t before) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(now) - static_cast<std::uint32_t>(before));
}

Vec3 origin_of(const Soup& soup) { return soup.bounds().isEmpty() ? Vec3(0, 0, 0) : Vec3(soup.bounds().center()); }

}  // namespace

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  constexpr int window_bits_gzip = 15 + 16;
  if (deflateInit2(&stream, 9, Z_DEFLATED, window_bits_gzip, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::vector<char> packed(deflateBound(&stream, bytes.size()));
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int done = deflate(&stream, Z_FINISH);
  const std::size_t size = packed.size() - stream.avail_out;
  deflateEnd(&stream);
  if (done != Z_STREAM_END) throw std::logic_error("gzip did not finish");
  return {packed.data(), size};
}

WebMesh web_mesh(const PreparedSurface& surface, double step, bool rotates, const LightMap* light,
                 nlohmann::json& manifest) {
  const Order order = order_of(surface);
  const Soup& soup = surface.source.soup;
  const Vec3 origin = origin_of(soup);
  Streams streams(manifest["streams"]);
  streams.add("corners", order.corners);
  for (const auto& [name, values] : positions_of(order, soup, origin, step)) streams.add(name, values);
  add_texels(streams, order, surface);
  if (rotates)
    for (const auto& [name, values] : rotations_of(order, soup)) streams.add(name, values);
  if (light != nullptr)
    for (const int axis : {0, 1})
      streams.add(axis == 0 ? "light_x" : "light_y", values_of(order, [&](std::uint32_t v) {
                    return static_cast<std::int32_t>(std::lround(light->chart->places[v][axis] * 256));
                  }));
  WebMesh mesh;
  mesh.triangles = surface.shown.faces->size();
  mesh.vertices = order.vertices.size();
  mesh.bytes = gzipped(streams.bytes());
  manifest["vertices"] = mesh.vertices;
  manifest["triangles"] = mesh.triangles;
  manifest["step"] = step;
  manifest["texelSteps"] = web_texel_steps;
  manifest["origin"] = {origin.x(), origin.y(), origin.z()};
  return mesh;
}

std::string web_poses(const PreparedSurface& surface, double step, bool rotates, const std::vector<const Soup*>& poses,
                      nlohmann::json& manifest) {
  const Order order = order_of(surface);
  const Vec3 origin = origin_of(surface.source.soup);
  Streams streams(manifest["streams"]);
  // Each as its difference from the pose before.
  std::vector<std::pair<std::string, Integers>> before;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    std::vector<std::pair<std::string, Integers>> own = positions_of(order, *poses[k], origin, step);
    if (rotates)
      for (auto& part : rotations_of(order, *poses[k])) own.push_back(std::move(part));
    for (std::size_t part = 0; part < own.size(); ++part) {
      Integers changes = own[part].second;
      if (k > 0)
        for (std::size_t v = 0; v < changes.size(); ++v) changes[v] = changed(changes[v], before[part].second[v]);
      streams.add(own[part].first + std::to_string(k), changes);
    }
    before = std::move(own);
  }
  return gzipped(streams.bytes());
}

WebTexels web_texels(const PreparedSurface& surface, WebImageCoding coding) {
  const TexelPacking& packing = *surface.packing;
  const TexelReader texels(*surface.source.texels);
  std::vector<Texel> filled;
  fill_packed_rows(packing, texels, 0, packing.height, filled);
  std::array<std::vector<std::uint8_t>, 2> bytes;
  for (auto& image : bytes) image.reserve(4 * filled.size());
  for (const Texel& texel : filled) {
    const Texel shown = texel.opaque() ? texel : Texel{};
    bytes[0].insert(bytes[0].end(), shown.feat0.begin(), shown.feat0.end());
    bytes[1].insert(bytes[1].end(), shown.feat1.begin(), shown.feat1.end());
  }
  WebTexels made{{}, {}, packing.width, packing.height};
  tbb::parallel_invoke([&] { made.image0 = web_image(packing.width, packing.height, bytes[0], coding); },
                       [&] { made.image1 = web_image(packing.width, packing.height, bytes[1], coding); });
  return made;
}

namespace {

void put_half(std::string& bytes, float value) {
  const std::uint16_t bits = Eigen::half(value).x;
  bytes += static_cast<char>(bits & 255U);
  bytes += static_cast<char>(bits >> 8U);
}

}  // namespace

std::string web_light_texels(const LightChart& chart, const std::vector<Eigen::Vector3f>& values) {
  std::string bytes;
  for (std::size_t k = 0; k < chart.texel_count(); ++k)
    for (int c = 0; c < 4; ++c) put_half(bytes, c < 3 ? values[k][c] : 1.0F);
  return gzipped(bytes);
}

std::string web_gloss_normals(const std::vector<Eigen::Vector4f>& normals) {
  std::string bytes;
  for (const Eigen::Vector4f& normal : normals)
    for (int c = 0; c < 4; ++c) put_half(bytes, normal[c]);
  return gzipped(bytes);
}

std::string web_gloss_suns(const GlossMap& map) {
  std::string bytes;
  for (std::size_t k = 0; k < map.before.suns.size(); ++k) {
    put_half(bytes, map.before.suns[k]);
    put_half(bytes, map.after.suns[k]);
  }
  return gzipped(bytes);
}

}  // namespace rebake
