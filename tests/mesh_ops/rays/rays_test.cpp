// Embree gives the same bits with SSE 2 and SSE 4.2, also at edges and corners. Ray trees rely on this.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace rebake::test {
namespace {

using Point = std::array<float, 3>;

// A rough height field of `side`² vertices.
struct Sheet {
  std::vector<Point> places;
  std::vector<unsigned> corners;
};
Sheet rough_sheet(unsigned side) {
  Sheet sheet;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> rough(-0.001F, 0.001F);
  for (unsigned i = 0; i < side; ++i)
    for (unsigned j = 0; j < side; ++j) {
      const float x = static_cast<float>(i) / static_cast<float>(side - 1) - 0.5F,
                  y = static_cast<float>(j) / static_cast<float>(side - 1) - 0.5F;
      sheet.places.push_back({x, y, 0.1F * std::sin(30 * x) * std::sin(27 * y) + rough(random)});
    }
  for (unsigned i = 0; i + 1 < side; ++i)
    for (unsigned j = 0; j + 1 < side; ++j) {
      const unsigned a = i * side + j, b = a + side;
      for (const unsigned corner : {a, b, a + 1, a + 1, b, b + 1}) sheet.corners.push_back(corner);
    }
  return sheet;
}

class Traced {
 public:
  Traced(const char* instructions, const Sheet& sheet)
      : device_(rtcNewDevice(instructions)), scene_(rtcNewScene(device_)) {
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Point),
                                        sheet.places.size()),
                sheet.places.data(), sheet.places.size() * sizeof(Point));
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
                                        sheet.corners.size() / 3),
                sheet.corners.data(), sheet.corners.size() * sizeof(unsigned));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Traced() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Traced(const Traced&) = delete;
  Traced& operator=(const Traced&) = delete;

  struct Found {
    unsigned triangle;
    float t;
    bool blocked;
    bool operator==(const Found&) const = default;
  };
  Found along(const Point& from, const Point& direction) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray.org_x = from[0];
    query.ray.org_y = from[1];
    query.ray.org_z = from[2];
    query.ray.dir_x = direction[0];
    query.ray.dir_y = direction[1];
    query.ray.dir_z = direction[2];
    query.ray.tfar = 2;
    query.ray.mask = ~0U;
    query.hit.geomID = query.hit.primID = RTC_INVALID_GEOMETRY_ID;
    RTCRay shadow = query.ray;
    rtcIntersect1(scene_, &context, &query);
    rtcOccluded1(scene_, &context, &shadow);
    return {query.hit.primID, query.ray.tfar, shadow.tfar < 0};
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

TEST(Rays, InstructionSetsGiveEqualBits) {
#ifdef __x86_64__
  if (!__builtin_cpu_supports("sse4.2")) GTEST_SKIP() << "the processor has no SSE 4.2";
#else
  GTEST_SKIP() << "the processor has a single SIMD instruction set";
#endif
  const Sheet sheet = rough_sheet(80);
  const Traced old("isa=sse2", sheet), now("isa=sse4.2", sheet);
  std::mt19937 random(2);
  std::uniform_real_distribution<float> within(-0.5F, 0.5F);
  int hits = 0;
  for (int k = 0; k < 100000; ++k) {
    const Point from{within(random), within(random), 0.3F};
    Point to{within(random), within(random), -0.3F};
    if (k % 2 == 0) to = sheet.places[random() % sheet.places.size()];
    Point direction{to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const float length = std::hypot(direction[0], direction[1], direction[2]);
    for (float& d : direction) d /= length;
    const Traced::Found found = now.along(from, direction);
    ASSERT_EQ(found, old.along(from, direction)) << k;
    hits += found.blocked ? 1 : 0;
  }
  EXPECT_GT(hits, 90000);
}

}  // namespace
}  // namespace rebake::test
