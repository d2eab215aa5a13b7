#include "optics/embree.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <iterator>
#include <limits>

namespace sandlot::embree {
namespace {

/// A thousand small triangles on the plane x = 1, so that Embree builds a tree.
struct Wall {
  Wall() : scene(rtcNewScene(device())) {
    constexpr int side = 24;
    const RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* point = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), (side + 1) * (side + 1)));
    for (int i = 0; i <= side; ++i)
      for (int j = 0; j <= side; ++j) {
        *point++ = 1;
        *point++ = static_cast<float>(i) - side / 2.0f;
        *point++ = static_cast<float>(j) - side / 2.0f;
      }
    auto* corner = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), 2 * side * side));
    for (unsigned i = 0; i < side; ++i)
      for (unsigned j = 0; j < side; ++j) {
        const unsigned a = i * (side + 1) + j, b = a + side + 1;
        for (const unsigned k : {a, a + 1, b, b, a + 1, b + 1}) *corner++ = k;
      }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    // As everywhere here, the calling thread builds alone: the thread sanitizer cannot see how Embree's share work.
    tbb::task_arena(1).execute([this] { rtcCommitScene(scene); });
  }
  ~Wall() { rtcReleaseScene(scene); }
  Wall(const Wall&) = delete;
  Wall& operator=(const Wall&) = delete;

  RTCScene scene;
};

/// Eight rays along x from beside the origin.
RTCRay8 eight_rays() {
  RTCRay8 rays{};
  for (int i = 0; i < 8; ++i) {
    rays.org_y[i] = 0.3f + 0.2f * static_cast<float>(i), rays.org_z[i] = 0.4f;
    rays.dir_x[i] = 1;
    rays.tfar[i] = 100;
    rays.mask[i] = ~0u;
  }
  return rays;
}

using RayField = float (RTCRay8::*)[8];
constexpr RayField fields[] = {&RTCRay8::org_x, &RTCRay8::org_y, &RTCRay8::org_z, &RTCRay8::dir_x,
                               &RTCRay8::dir_y, &RTCRay8::dir_z, &RTCRay8::tnear};
constexpr float inf = std::numeric_limits<float>::infinity();
constexpr float unsound[] = {2e18f, -2e18f, inf, -inf, std::numeric_limits<float>::quiet_NaN()};

TEST(Embree, RaysItCannotTakeHitNothingAndTheirNeighboursHit) {
  const Wall wall;
  alignas(32) const int all[8] = {-1, -1, -1, -1, -1, -1, -1, -1};
  for (std::size_t f = 0; f < std::size(fields); ++f)
    for (const float value : unsound)
      for (const unsigned which : {0x01u, 0x88u, 0xffu}) {
        SCOPED_TRACE(testing::Message() << "field " << f << ", " << value << ", lanes " << which);
        alignas(64) RTCRayHit8 first{};
        first.ray = eight_rays();
        for (int i = 0; i < 8; ++i) {
          first.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
          if (which >> i & 1) (first.ray.*fields[f])[i] = value;
        }
        alignas(64) RTCRayHit8 second = first;
        alignas(64) RTCRay8 third = first.ray;
        QueryContext context;
        init_context(context);
        intersect8(all, wall.scene, context, first);
        intersect8_coherent(all, wall.scene, context, second);
        occluded8(all, wall.scene, context, third);
        for (int i = 0; i < 8; ++i) {
          const bool spoilt = which >> i & 1;
          EXPECT_FLOAT_EQ(first.ray.tfar[i], spoilt ? 100 : 1);
          EXPECT_FLOAT_EQ(second.ray.tfar[i], spoilt ? 100 : 1);
          EXPECT_EQ(third.tfar[i] < 0, !spoilt);
        }
      }
}

}  // namespace
}  // namespace sandlot::embree
