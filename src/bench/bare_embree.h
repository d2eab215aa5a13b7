#pragma once
/// The loop that P5 compares with: one Embree scene of analytic solids in world coordinates, ray packets
/// prepared beforehand, nothing but tracing and reading distances.
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "base/check.h"
#include "optics/embree.h"
#include "optics/ray_scene.h"
#include "optics/solid.h"

namespace sandlot::bench {

class BareEmbree {
 public:
  BareEmbree(std::span<const SceneShape> shapes, const SceneFrame& frame, const char* isa)
      : device_(rtcNewDevice((std::string("isa=") + isa).c_str())), scene_(rtcNewScene(device_)) {
    for (const SceneShape& shape : shapes) {
      if (std::holds_alternative<Plane>(shape.shape)) continue;  // horizontal fans never meet the ground
      solids_.push_back(optics::make_solid(shape.shape, shape.body));
      solids_.back().place(frame.X_WG[shape.group] * shape.X_GC);
    }
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(solids_.size()));
    rtcSetGeometryUserData(geometry, solids_.data());
    rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~BareEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareEmbree(const BareEmbree&) = delete;
  BareEmbree& operator=(const BareEmbree&) = delete;

  void prepare(std::span<const RayJob> jobs) {
    packets_.clear();
    fans_.clear();
    rays_ = 0;
    for (const RayJob& job : jobs) {
      fans_.push_back({job, packets_.size()});
      for (std::size_t first = 0; first < job.directions.size(); first += width) {
        Packet& p = packets_.emplace_back();
        p.count = std::min(job.directions.size() - first, std::size_t{width});
        p.max_m = static_cast<float>(job.max_m);
        for (std::size_t i = 0; i < width; ++i) {
          const Vec3 d = rotate(job.X_WS.q, job.directions[first + (i < p.count ? i : 0)]);
          p.valid[i] = i < p.count ? -1 : 0;
          p.rays.ray.org_x[i] = static_cast<float>(job.X_WS.p.x);
          p.rays.ray.org_y[i] = static_cast<float>(job.X_WS.p.y);
          p.rays.ray.org_z[i] = static_cast<float>(job.X_WS.p.z);
          p.rays.ray.dir_x[i] = static_cast<float>(d.x);
          p.rays.ray.dir_y[i] = static_cast<float>(d.y);
          p.rays.ray.dir_z[i] = static_cast<float>(d.z);
          p.rays.ray.tnear[i] = static_cast<float>(job.min_m);
          p.rays.ray.time[i] = 0;
          p.rays.ray.mask[i] = ~0u;
          p.rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        rays_ += p.count;
      }
    }
    distances_.resize(rays_);
  }

  void trace() {
    const embree::FlushDenormals flush;
    std::size_t out = 0;
    Query query;
    embree::init_context(query);
    for (std::size_t f = 0; f < fans_.size(); ++f) {
      const std::size_t end = f + 1 < fans_.size() ? fans_[f + 1].first_packet : packets_.size();
      for (std::size_t i = 0; i < 3; ++i) query.origin[i] = fans_[f].job.X_WS.p[i];
      for (std::size_t k = fans_[f].first_packet; k < end; ++k) {
        Packet& p = packets_[k];
        for (std::size_t i = 0; i < width; ++i) {
          p.rays.ray.tfar[i] = p.max_m;
          p.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        embree::intersect8(p.valid, scene_, query, p.rays);
        for (std::size_t i = 0; i < p.count; ++i)
          distances_[out++] = p.rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID
                                  ? std::numeric_limits<float>::infinity()
                                  : p.rays.ray.tfar[i];
      }
    }
  }
  std::span<const float> distances() const { return distances_; }

 private:
  struct Query : embree::QueryContext {
    double origin[3];
  };
  // Packets of eight: with AVX2 Embree splits sixteen into two of them, which costs it a tenth.
  static constexpr std::size_t width = 8;
  struct alignas(64) Packet {
    int valid[width];
    RTCRayHit8 rays;
    std::size_t count;
    float max_m;
  };
  struct Fan {
    RayJob job;
    std::size_t first_packet;
  };
  static void bounds(const RTCBoundsFunctionArguments* a) {
    const optics::Bounds b = optics::bounds(static_cast<const optics::Solid*>(a->geometryUserPtr)[a->primID]);
    RTCBounds& out = *a->bounds_o;
    out.lower_x = static_cast<float>(b.lower[0]) - 1e-5f;
    out.lower_y = static_cast<float>(b.lower[1]) - 1e-5f;
    out.lower_z = static_cast<float>(b.lower[2]) - 1e-5f;
    out.upper_x = static_cast<float>(b.upper[0]) + 1e-5f;
    out.upper_y = static_cast<float>(b.upper[1]) + 1e-5f;
    out.upper_z = static_cast<float>(b.upper[2]) + 1e-5f;
  }
  static void intersect(const RTCIntersectFunctionNArguments* a) {
    using lanes::F;
    using lanes::I;
    const auto& solid = static_cast<const optics::Solid*>(a->geometryUserPtr)[a->primID];
    const unsigned n = a->N;
    auto* const base = reinterpret_cast<float*>(a->rayhit);
    for (unsigned first = 0; first < n; first += lanes::width) {
      const unsigned count = std::min(n - first, unsigned{lanes::width});
      const auto at = [&](unsigned field) { return base + field * n + first; };
      const optics::Rays8 rays{lanes::load<F>(at(4), count), lanes::load<F>(at(5), count),
                               lanes::load<F>(at(6), count), lanes::load<F>(at(3), count)};
      const F t = optics::distance_to(solid, static_cast<const Query*>(a->context)->origin, rays);
      const F tfar = lanes::load<F>(at(8), count);
      const I take = lanes::load<I>(a->valid + first, count) & (t >= rays.near) & (t < tfar);
      lanes::store(at(8), lanes::select(take, t, tfar), count);
      lanes::store(at(18), lanes::select(take, lanes::broadcast(0), lanes::load<I>(at(18), count)), count);
    }
  }

  RTCDevice device_;
  RTCScene scene_;
  std::vector<optics::Solid> solids_;
  std::vector<Packet> packets_;
  std::vector<Fan> fans_;
  std::vector<float> distances_;
  std::size_t rays_ = 0;
};

}  // namespace sandlot::bench
