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

/// The valid rays whose numbers Embree takes; with others Debian's ends the process. They hit nothing, as those that are not
/// valid. @return whether there are any
inline bool keep_sound(const int* valid, const RTCRay8& ray, int* kept) {
  const lanes::F most = lanes::broadcast(1e18f);
  lanes::I sound = lanes::load<lanes::I>(valid) & (lanes::load<lanes::F>(ray.tfar) >= -most);
  for (const float* const numbers :
       {ray.org_x, ray.org_y, ray.org_z, ray.dir_x, ray.dir_y, ray.dir_z, ray.tnear}) {
    const lanes::F number = lanes::load<lanes::F>(numbers);
    sound &= (number >= -most) & (number <= most);
  }
  lanes::store(kept, sound);
  return lanes::any(sound);
}

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
inline void init_context(QueryContext& context) { rtcInitRayQueryContext(&context); }
inline void intersect8(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays.ray, sound)) return;
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  arguments.context = &context;
  rtcIntersect8(sound, scene, &rays, &arguments);
}
inline void intersect8_coherent(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays.ray, sound)) return;
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.context = &context;
  rtcIntersect8(sound, scene, &rays, &arguments);
}
inline void occluded8(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays, sound)) return;
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
  arguments.context = &context;
  rtcOccluded8(sound, scene, &rays, &arguments);
}
#else
using QueryContext = RTCIntersectContext;
inline void init_context(QueryContext& context) {
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}
inline void intersect8(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays.ray, sound)) return;
  rtcIntersect8(sound, scene, &context, &rays);
}
/// For packets of neighbouring pixels.
inline void intersect8_coherent(const int* valid, RTCScene scene, QueryContext& context, RTCRayHit8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays.ray, sound)) return;
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(sound, scene, &context, &rays);
}
/// Rays that hit have tfar < 0. Never coherent: with that flag Embree 3.13 does not come back from some
/// packets.
inline void occluded8(const int* valid, RTCScene scene, QueryContext& context, RTCRay8& rays) {
  alignas(32) int sound[lanes::width];
  if (!keep_sound(valid, rays, sound)) return;
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  rtcOccluded8(sound, scene, &context, &rays);
}
#endif

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
