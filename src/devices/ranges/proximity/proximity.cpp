#include "devices/ranges/proximity/proximity.h"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>

#include "base/math.h"
#include "base/prefetch.h"
#include "physics/parallel.h"

namespace sandlot::proximity {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();

/// From distances along the rays to the ring's readings, with errors. Only data of this ring is touched.
void finish(Ring& ring, std::uint64_t sample, Time since, const Context& context) {
  const Spec& spec = *ring.spec;
  std::vector<float>&ranges = ring.scan->message.ranges, &readings = ring.scan->message.intensities;
  const auto radius_m = static_cast<float>(spec.radius_m);
  const bool anything = std::any_of(ranges.begin(), ranges.end(), [](float r) { return r < inf; });
  if (anything || !spec.noise.stages.empty() || spec.noise.bias.bias_std > 0) {
    for (float& range_m : ranges) range_m = std::max(range_m - radius_m, 0.0f);
    Stream random(context.seed, ring.key, Purpose::noise, sample);
    ring.state.noise.corrupt(spec.noise, since.s(), random, 0, spec.range_m, ranges, spec.errors);
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      readings[i] = reading(spec, ranges[i]);
      ranges[i] += radius_m;
    }
  } else {
    std::fill(readings.begin(), readings.end(), 0.0f);
  }
  ring.scan->publish(context.now);
}

/// Directions of a ring: those of the ring made before this one if they are the same, which in a swarm they
/// are.
std::shared_ptr<const std::vector<Vec3>> directions(std::size_t sensors, double first_rad,
                                                    double spacing_rad) {
  std::vector<Vec3> made(sensors);
  for (std::size_t i = 0; i < sensors; ++i) {
    const auto [s, c] = math::sincos(first_rad + static_cast<double>(i) * spacing_rad);
    made[i] = {c, s, 0};
  }
  static std::mutex mutex;
  static std::weak_ptr<const std::vector<Vec3>> latest;
  const std::lock_guard lock(mutex);
  if (auto known = latest.lock(); known && *known == made) return known;
  auto fresh = std::make_shared<const std::vector<Vec3>>(std::move(made));
  latest = fresh;
  return fresh;
}

}  // namespace

float reading(const Spec& spec, float d_m) {
  if (!(d_m < inf)) return 0;
  const double d = d_m;
  if (spec.response == Response::linear)
    return static_cast<float>(std::clamp(1 - d / spec.range_m, 0.0, 1.0));
  if (d <= spec.saturation_m) return 1;
  const double share = spec.saturation_m / d;
  return static_cast<float>(share * share);
}

Result<Ring> Ring::create(const DeviceBuild& build, SharedSpec<Spec> spec) {
  const double around = spec->spacing_rad > 0 ? spec->spacing_rad : math::tau / spec->sensors;
  if ((spec->sensors - 1) * around > math::tau + 1e-6)
    return build.error("spacing", "the sensors go round more than once",
                       "a spacing of 0 spreads them evenly; " + std::to_string(spec->sensors) +
                           " sensors have at most 360 deg together");
  Ring ring{std::move(spec)};
  ring.key = build.key;
  ring.body = build.body().index;
  ring.X_LS = build.decl.X_LS;
  const auto sensors = static_cast<std::size_t>(ring.spec->sensors);
  ring.directions_S = directions(sensors, ring.spec->first_angle_rad, around);
  Stream random(build.seed, build.key, Purpose::initial, 0);
  ring.state.noise.reset(ring.spec->noise, random);

  ring.scan = build.publish<msg::LaserScan>(0, "proximity");
  msg::LaserScan& message = ring.scan->message;
  message.header.frame_id = build.frame_id();
  message.angle_min = static_cast<float>(ring.spec->first_angle_rad);
  message.angle_increment = static_cast<float>(around);
  message.angle_max = static_cast<float>(ring.spec->first_angle_rad + (ring.spec->sensors - 1) * around);
  message.scan_time = static_cast<float>(ring.spec->rate_hz > 0 ? 1 / ring.spec->rate_hz : build.tick.s());
  message.range_min = static_cast<float>(ring.spec->radius_m);
  message.range_max = static_cast<float>(ring.spec->radius_m + ring.spec->range_m);
  message.ranges.assign(sensors, inf);
  message.intensities.assign(sensors, 0);
  return ring;
}

void Ring::sense(PoolView<Ring> pool, const Context& context) {
  constexpr std::size_t batch = 16;  // few enough to stay on the stack
  parallel_for(pool.due.size(), 4 * batch, [&](std::size_t begin, std::size_t end) {
    std::array<RayJob, batch> jobs;
    std::array<std::uint32_t, batch> bodies;
    std::array<BodyState, batch> states;
    while (begin < end) {
      const std::size_t count = std::min(batch, end - begin);
      for (std::size_t i = 0; i < count; ++i) {
        const Ring& ring = pool.all[pool.due[begin + i]];
        bodies[i] = ring.body;
        prefetch(&ring.scan->message, 1);
      }
      context.engine.states_of({bodies.data(), count}, {states.data(), count});
      for (std::size_t i = 0; i < count; ++i) {
        Ring& ring = pool.all[pool.due[begin + i]];
        // A message may have been restored from a file.
        ring.scan->message.ranges.resize(ring.directions_S->size());
        ring.scan->message.intensities.resize(ring.directions_S->size());
        prefetch(ring.scan->message.ranges.data(), ring.scan->message.ranges.size());
        prefetch(ring.scan->message.intensities.data(), ring.scan->message.intensities.size());
        jobs[i] = {.X_WS = states[i].X_WB * ring.X_LS,
                   .directions = *ring.directions_S,
                   .min_m = ring.spec->radius_m,
                   .max_m = ring.spec->radius_m + ring.spec->range_m,
                   .ignore_body = ring.body,
                   .distance_m = ring.scan->message.ranges};
      }
      context.rays.cast({jobs.data(), count});
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t index = pool.due[begin + i];
        finish(pool.all[index], pool.sample[index], pool.since[index], context);
      }
      begin += count;
    }
  });
}

namespace {
constexpr LevelInfo levels[] = {
    {"proximity", msg::LaserScan::ros_type, "", "Readings and distances of all sensors."},
};
constexpr Preset presets[] = {
    {"ring24",
     "24 sensors with 10 cm of range on a circle of 8.5 cm, as robots of swarm research carry them.",
     "{sensors: 24, radius: 0.085, range: 0.1}"},
};
}  // namespace

constinit const Kind kind = make_kind<Ring>({
    .name = "proximity",
    .help = "Ring of short-range infra-red sensors.",
    .levels = levels,
    .presets = presets,
});

}  // namespace sandlot::proximity
