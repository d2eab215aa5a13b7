#include "devices/laser_scanner/laser_scanner.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/math.h"
#include "devices/parallel.h"
#include "devices/sdf_element.h"

namespace sandlot::laser_scanner {
namespace {

/// The error of a rule between two fields, at the key that breaks it.
Error rule_error(const DeviceBuild& build, const char* key, std::string what, std::string fix) {
  const Node* const node = build.decl.config.find(key);
  return {std::move(what), std::move(fix), node ? node->place() : build.decl.place, std::string("/") + key};
}

/// From distances to what a driver reports, with errors. Only data of this scanner is touched.
void finish(Scanner& scanner, std::uint64_t sample, Time since, const Context& context) {
  const Spec& spec = scanner.spec;
  const auto min_m = static_cast<float>(spec.min_range_m);
  std::vector<float>& ranges = scanner.scan->message.ranges;
  for (float& range_m : ranges)
    if (range_m < min_m) range_m = -std::numeric_limits<float>::infinity();
  Stream random(context.seed, scanner.key, Purpose::noise, sample);
  corrupt_ranges(spec.noise, scanner.state.bias, since.s(), random, spec.min_range_m, spec.max_range_m,
                 ranges);
  scanner.scan->publish(context.now);
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  const Node* const sensor = find(element, "lidar") ? find(element, "lidar") : find(element, "ray");
  if (!sensor) return element.error("a laser scanner needs a <lidar> or <ray> element");
  warn_unknown(*sensor, {"scan", "range", "noise"}, "<lidar>", diagnostics);

  SL_ASSIGN(const auto samples, number(*sensor, "scan/horizontal/samples"));
  SL_ASSIGN(const auto resolution, number(*sensor, "scan/horizontal/resolution"));
  if (samples)
    config.set("beams", scalar(std::floor(*samples * resolution.value_or(1.0)),
                               *find(*sensor, "scan/horizontal/samples")));
  copy(*sensor, "scan/horizontal/min_angle", config, "min_angle");
  copy(*sensor, "scan/horizontal/max_angle", config, "max_angle");
  copy(*sensor, "range/min", config, "min_range");
  copy(*sensor, "range/max", config, "max_range");
  // SDF's default is 0: a scan in every step, which is also what 0 means here.
  config.set("rate", Node::scalar(find(element, "update_rate") ? text(find(element, "update_rate")) : "0",
                                  find(element, "update_rate") ? find(element, "update_rate")->place()
                                                               : element.place()));

  SL_ASSIGN(const auto planes, number(*sensor, "scan/vertical/samples"));
  if (planes && *planes > 1) {
    Error warning = find(*sensor, "scan/vertical/samples")
                        ->error("a laser scanner has one plane only: the horizontal one is used");
    diagnostics.warn(std::move(warning));
  }
  if (const Node* const noise = find(*sensor, "noise")) {
    const Node* const type = find(*noise, "type") ? find(*noise, "type") : find(*noise, "@type");
    SL_ASSIGN(const auto mean, number(*noise, "mean"));
    SL_ASSIGN(const auto stddev, number(*noise, "stddev"));
    if (text(type) == "gaussian") {
      if (mean && *mean != 0)
        diagnostics.warn(
            find(*noise, "mean")
                ->error("a constant error (<mean>) of a laser scanner is not supported and has no effect"));
      if (stddev) {
        Node errors = Node::map(noise->place());
        errors.set("white", scalar(*stddev, *find(*noise, "stddev")));
        config.set("noise", std::move(errors));
      }
    } else if (text(type) != "none" && !text(type).empty()) {
      diagnostics.warn(noise->error("noise of type '" + text(type) + "' is not supported and has no effect"));
    }
  }
  return config;
}

}  // namespace

Result<Scanner> Scanner::create(const DeviceBuild& build, Spec spec) {
  if (spec.max_range_m <= spec.min_range_m)
    return rule_error(build, "max_range", "max_range must be greater than min_range",
                      "min_range is " + number_text(spec.min_range_m) + " m");
  if (spec.max_angle_rad < spec.min_angle_rad)
    return rule_error(build, "max_angle", "max_angle must not be less than min_angle",
                      "angles grow counter-clockwise");
  if (spec.max_angle_rad - spec.min_angle_rad > math::tau + 1e-6)
    return rule_error(build, "max_angle", "the beams cover more than a full turn",
                      "max_angle - min_angle is at most 360 deg");

  Scanner scanner{spec};
  scanner.key = build.key;
  scanner.body = build.body().index;
  scanner.X_LS = build.decl.X_LS;
  const auto beams = static_cast<std::size_t>(spec.beams);
  const double increment = spec.beams > 1 ? (spec.max_angle_rad - spec.min_angle_rad) / (spec.beams - 1) : 0;
  const double first = spec.beams > 1 ? spec.min_angle_rad : 0.5 * (spec.min_angle_rad + spec.max_angle_rad);
  for (std::size_t i = 0; i < beams; ++i) {
    const auto [s, c] = math::sincos(first + static_cast<double>(i) * increment);
    scanner.directions_S.push_back({c, s, 0});
  }
  Stream random(build.seed, build.key, Purpose::initial, 0);
  scanner.state.bias.reset(spec.noise.bias, random);

  scanner.scan = build.publish<msg::LaserScan>(0, "ranges");
  msg::LaserScan& message = scanner.scan->message;
  message.header.frame_id = build.frame_id();
  message.angle_min = static_cast<float>(first);
  message.angle_max = static_cast<float>(first + static_cast<double>(spec.beams - 1) * increment);
  message.angle_increment = static_cast<float>(increment);
  message.scan_time = static_cast<float>(spec.rate_hz > 0 ? 1 / spec.rate_hz : build.tick.s());
  message.range_min = static_cast<float>(spec.min_range_m);
  message.range_max = static_cast<float>(spec.max_range_m);
  message.ranges.assign(beams, std::numeric_limits<float>::infinity());
  return scanner;
}

void Scanner::sense(PoolView<Scanner> pool, const Context& context) {
  const auto states = context.engine.states();
  // Several scanners per batch, so that a caster may sort rays of neighbours; few enough to stay on the stack.
  constexpr std::size_t batch = 16;
  parallel_for(pool.due.size(), batch, [&](std::size_t begin, std::size_t end) {
    std::array<RayJob, batch> jobs;
    while (begin < end) {
      const std::size_t count = std::min(batch, end - begin);
      for (std::size_t i = 0; i < count; ++i) {
        Scanner& scanner = pool.all[pool.due[begin + i]];
        scanner.scan->message.ranges.resize(scanner.directions_S.size());
        jobs[i] = {.X_WS = states[scanner.body].X_WB * scanner.X_LS,
                   .directions = scanner.directions_S,
                   .min_m = 0,
                   .max_m = scanner.spec.max_range_m,
                   .ignore_body = scanner.body,
                   .distance_m = scanner.scan->message.ranges};
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
    {"ranges", msg::LaserScan::ros_type, "", "Distances of all beams."},
};
constexpr const char* sdf_types[] = {"sensor:lidar", "sensor:gpu_lidar", "sensor:ray", "sensor:gpu_ray"};
}  // namespace

constinit const Kind kind = make_kind<Scanner>({
    .name = "laser_scanner",
    .help = "Planar scanning range finder (2D lidar, sonar, infra-red ranger).",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
});

}  // namespace sandlot::laser_scanner
