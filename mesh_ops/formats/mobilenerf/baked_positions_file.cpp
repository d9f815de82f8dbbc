#include "mesh_ops/formats/mobilenerf/baked_positions_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "mesh_ops/formats/mobilenerf/sidecar_file.h"

namespace rebake {

namespace {

constexpr std::uint32_t positions_version = 1;
constexpr std::size_t displacement_size = 3 * 4;

using Displacements = std::vector<Eigen::Vector3f>;
using Bodies = std::vector<std::uint16_t>;

const Displacements* displacements_of(const Soup& soup) {
  return soup.vertex_attributes().find<Eigen::Vector3f>(Soup::displacement);
}
const Bodies* bodies_of(const Soup& soup) { return soup.face_attributes().find<std::uint16_t>(BakedObject::body); }

// Clamps to the range of finite floats; NaN and −0 become 0, which is neutral.
float finite(float value) {
  constexpr float most = std::numeric_limits<float>::max();
  return std::isnan(value) ? 0 : std::clamp(value, -most, most) + 0.0F;
}

std::string places_of(const Soup& soup) {
  const Displacements* displaced = displacements_of(soup);
  std::string values;
  values.reserve(soup.positions().size() * displacement_size);
  for (std::size_t v = 0; v < soup.positions().size(); ++v)
    for (int c = 0; c < 3; ++c)
      put_u32(values, std::bit_cast<std::uint32_t>(displaced != nullptr ? finite((*displaced)[v][c]) : 0.0F));
  std::string out = corner_values(soup.faces(), values, displacement_size, std::string(displacement_size, '\0'));
  const Bodies* bodies = bodies_of(soup);
  const auto body = [&](std::size_t face) { return bodies != nullptr ? (*bodies)[face] : std::uint16_t{0}; };
  for (std::size_t first = 0, last = 0; first < soup.triangle_count(); first = last) {
    for (last = first; last < soup.triangle_count() && body(last) == body(first);) ++last;
    put_varint(out, last - first);
    put_varint(out, body(first));
  }
  return out;
}

std::shared_ptr<const Attribute> read_displacements(SidecarReader& reader, const Soup& soup) {
  const std::size_t vertices = soup.positions().size();
  const std::string values =
      read_corner_values(reader, soup.faces(), vertices, displacement_size, std::string(displacement_size, '\0'));
  SidecarReader numbers(values, reader.name());
  Displacements displaced(vertices);
  for (Eigen::Vector3f& d : displaced) {
    for (int c = 0; c < 3; ++c) d[c] = std::bit_cast<float>(numbers.take_u32());
    if (!d.allFinite()) throw DamagedSet{"has a displacement that is not finite"};
  }
  return Values<Eigen::Vector3f>::of(std::move(displaced));
}

std::shared_ptr<const Attribute> read_bodies(SidecarReader& reader, const Soup& soup, std::size_t bodies) {
  Bodies numbers;
  numbers.reserve(soup.triangle_count());
  while (numbers.size() < soup.triangle_count()) {
    const std::uint64_t count = reader.take_varint(), body = reader.take_varint();
    if (count == 0 || count > soup.triangle_count() - numbers.size())
      throw DamagedSet{"has body numbers of faces that do not exist"};
    if (body >= bodies) throw DamagedSet{"refers to a body that does not exist"};
    numbers.insert(numbers.end(), count, static_cast<std::uint16_t>(body));
  }
  return Values<std::uint16_t>::of(std::move(numbers));
}

}  // namespace

bool any_baked_positions(const std::vector<TextureSet>& sets) {
  return std::any_of(sets.begin(), sets.end(), [](const TextureSet& set) {
    return displacements_of(set.soup) != nullptr || bodies_of(set.soup) != nullptr;
  });
}

std::string write_baked_positions(const std::vector<TextureSet>& sets) {
  SidecarWriter file(positions_mark, positions_version);
  for (std::size_t s = 0; s < sets.size(); ++s)
    if (displacements_of(sets[s].soup) != nullptr || bodies_of(sets[s].soup) != nullptr)
      file.add(static_cast<std::uint32_t>(s), sets[s].soup.triangle_count(), places_of(sets[s].soup));
  return file.bytes();
}

void read_baked_positions(std::string_view bytes, const std::filesystem::path& name, std::size_t bodies,
                          std::vector<TextureSet>& sets) {
  read_sidecar(bytes, name, positions_mark, positions_version, "baked positions", sets,
               [&](SidecarReader& reader, TextureSet& set) {
                 const Soup& soup = set.soup;
                 auto displaced = read_displacements(reader, soup);
                 auto numbers = read_bodies(reader, soup, bodies);
                 set.soup = Soup(soup.shared_positions(), soup.shared_uvs(), soup.shared_faces(),
                                 soup.vertex_attributes().with(Soup::displacement, std::move(displaced)),
                                 soup.face_attributes().with(BakedObject::body, std::move(numbers)));
               });
}

}  // namespace rebake
