#pragma once
/// Embree 3 and 4 behind the few names that differ: one source builds with either.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "optics/solid.h"

namespace sandlot::embree {

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
using Flags = RTCRayQueryFlags;
inline constexpr Flags incoherent = RTC_RAY_QUERY_FLAG_INCOHERENT, coherent = RTC_RAY_QUERY_FLAG_COHERENT;
inline void init_context(QueryContext& context) { rtcInitRayQueryContext(&context); }
inline void ask(const int* valid, RTCScene scene, QueryContext& context, Flags flags, RTCRayHit8& rays) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = flags;
  arguments.context = &context;
  rtcIntersect8(valid, scene, &rays, &arguments);
}
inline void ask(const int* valid, RTCScene scene, QueryContext& context, Flags flags, RTCRay8& rays) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = flags;
  arguments.context = &context;
  rtcOccluded8(valid, scene, &rays, &arguments);
}
#else
using QueryContext = RTCIntersectContext;
using Flags = RTCIntersectContextFlags;
inline constexpr Flags incoherent = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT,
                       coherent = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
inline void init_context(QueryContext& context) { rtcInitIntersectContext(&context); }
inline void ask(const int* valid, RTCScene scene, QueryContext& context, Flags flags, RTCRayHit8& rays) {
  context.flags = flags;
  rtcIntersect8(valid, scene, &context, &rays);
}
inline void ask(const int* valid, RTCScene scene, QueryContext& context, Flags flags, RTCRay8& rays) {
  context.flags = flags;
  rtcOccluded8(valid, scene, &context, &rays);
}
#endif

/// Debian's Embree ends the process where a number of an origin or a direction is none or beyond 1.8e18.
inline constexpr float most = 1e18f;

/// Absolute values, to be added and held against `most`: a sum with something that is no number is none.
inline lanes::F size(lanes::F x) { return lanes::F(lanes::I(x) & 0x7fffffff); }

/// The valid rays that Embree can take. The others hit nothing.
inline lanes::I sound(const int* valid, const RTCRay8& ray) {
  const auto size_of = [](const float* numbers) { return size(lanes::load<lanes::F>(numbers)); };
  // In pairs: the sums wait for each other less.
  const lanes::F sum = ((size_of(ray.org_x) + size_of(ray.org_y)) +
                        (size_of(ray.org_z) + size_of(ray.tnear))) +
                       ((size_of(ray.dir_x) + size_of(ray.dir_y)) + size_of(ray.dir_z));
  return lanes::load<lanes::I>(valid) & (sum <= most) & (lanes::load<lanes::F>(ray.tfar) >= -most);
}

template <class Packet>
void ask_sound(lanes::I sound, RTCScene scene, QueryContext& context, Flags flags, Packet& rays) {
  if (!lanes::any(sound)) return;
  alignas(32) int valid[lanes::width];
  lanes::store(valid, sound);
  ask(valid, scene, context, flags, rays);
}

inline void intersect8(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  ask_sound(sound(valid, rays.ray), scene, context, incoherent, rays);
}
/// For packets of neighbouring pixels.
inline void intersect8_coherent(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  ask_sound(sound(valid, rays.ray), scene, context, coherent, rays);
}
/// Rays that hit have tfar < 0. Never coherent: with that flag Embree 3.13 does not come back from some
/// packets.
inline void occluded8(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& rays) {
  ask_sound(sound(valid, rays), scene, context, incoherent, rays);
}

/// The widest instruction set that most machines have: one isa for all of them means one answer.
inline const char* choose_isa() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
      __builtin_cpu_supports("bmi2"))
    return "avx2";
#endif
  return "sse4.2";
}

/// The device of this process, pinned to choose_isa(): all scenes are made in it, from any thread. To start one takes Embree
/// 50 us, as long as to build a small world around it. It is never released: a world may live until the process ends.
RTCDevice device();

/// Bounds of a user geometry, enlarged by a margin on all sides.
inline void fill_bounds(const optics::Bounds& box, double margin_m, RTCBounds& out) {
  out.lower_x = static_cast<float>(box.lower[0] - margin_m);
  out.lower_y = static_cast<float>(box.lower[1] - margin_m);
  out.lower_z = static_cast<float>(box.lower[2] - margin_m);
  out.upper_x = static_cast<float>(box.upper[0] + margin_m);
  out.upper_y = static_cast<float>(box.upper[1] + margin_m);
  out.upper_z = static_cast<float>(box.upper[2] + margin_m);
}

/// Denormal numbers count as zero while this lives. Embree recommends it, and it must not leak: physics and
/// noise on the same thread keep IEEE arithmetic.
class FlushDenormals {
 public:
#if defined(__SSE__)
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }  // FTZ | DAZ
  ~FlushDenormals() { _mm_setcsr(saved_); }
#else
  FlushDenormals() {}
  ~FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE__)
  unsigned saved_;
#endif
};

}  // namespace sandlot::embree
