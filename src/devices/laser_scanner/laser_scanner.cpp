#include "devices/laser_scanner/laser_scanner.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/math.h"
#include "devices/cast_due.h"
#include "devices/sdf_noise.h"

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
  scanner.state.noise.corrupt(spec.noise, since.s(), random, spec.min_range_m, spec.max_range_m, ranges,
                              spec.errors);
  scanner.scan->publish(context.now);
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  const Node* const sensor = lidar(element);
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
  copy_rate(element, "update_rate", config);
  if (const Node* const noise = find(*sensor, "noise")) {
    SL_ASSIGN(Node errors, range_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set("noise", std::move(errors));
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
  scanner.state.noise.reset(spec.noise, random);

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
  const auto distances_of = [](Scanner& scanner) -> std::span<float> {
    scanner.scan->message.ranges.resize(scanner.directions_S.size());
    return scanner.scan->message.ranges;
  };
  cast_due(pool, context, distances_of, finish);
}

namespace {
constexpr LevelInfo levels[] = {
    {"ranges", msg::LaserScan::ros_type, "", "Distances of all beams."},
};
constexpr const char* sdf_types[] = {"sensor:lidar", "sensor:gpu_lidar", "sensor:ray", "sensor:gpu_ray"};
constexpr Preset presets[] = {
    {"sick_lms200",
     "SICK LMS200, millimetre mode: 180 deg in steps of 1 deg, 8 m, 75 scans/s (scans and modes from "
     "Player's driver, errors "
     "from general knowledge of the data sheet).",
     "{beams: 181, min_angle: -90 deg, max_angle: 90 deg, min_range: 0.02, max_range: 8, rate: 75,"
     " noise: {white: 5 mm, systematic: 15 mm, resolution: 1 mm}}"},
    {"sick_lms200_fine", "SICK LMS200, millimetre mode, in steps of 0.5 deg, 37.5 scans/s (as sick_lms200).",
     "{beams: 361, min_angle: -90 deg, max_angle: 90 deg, min_range: 0.02, max_range: 8, rate: 37.5,"
     " noise: {white: 5 mm, systematic: 15 mm, resolution: 1 mm}}"},
    {"sick_lms200_far", "SICK LMS200, centimetre mode: 80 m, larger errors (as sick_lms200).",
     "{beams: 181, min_angle: -90 deg, max_angle: 90 deg, min_range: 0.02, max_range: 80, rate: 75,"
     " noise: {white: 5 mm, systematic: 40 mm, resolution: 10 mm}}"},
    {"sick_ld",
     "SICK LD (LD-OEM 1000, LD-LRS): full turn in steps of 0.5 deg, 250 m, 20 turns/s (general knowledge; "
     "the errors "
     "are uncertain).",
     "{beams: 720, min_angle: -180 deg, max_angle: 179.5 deg, min_range: 0.5, max_range: 250, rate: 20,"
     " noise: {white: 25 mm, systematic: 38 mm, resolution: 3.90625 mm}}"},
    {"hokuyo_urg04lx",
     "Hokuyo URG-04LX: 240 deg in 683 beams, 4 m, 10 scans/s (general knowledge of the data sheet: +-10 mm "
     "up to 1 m).",
     "{beams: 683, min_angle: -119.8828125 deg, max_angle: 119.8828125 deg, min_range: 0.06, max_range: "
     "4.095, rate: 10,"
     " noise: {white: 5 mm, systematic: 10 mm, resolution: 1 mm}}"},
    {"hokuyo_utm30lx",
     "Hokuyo UTM-30LX: 270 deg in steps of 0.25 deg, 30 m, 40 scans/s (general knowledge of the data sheet: "
     "+-30 mm, "
     "deviation below 10 mm, up to 10 m).",
     "{beams: 1081, min_angle: -135 deg, max_angle: 135 deg, min_range: 0.1, max_range: 30, rate: 40,"
     " noise: {white: 10 mm, systematic: 30 mm, resolution: 1 mm}}"},
};
}  // namespace

constinit const Kind kind = make_kind<Scanner>({
    .name = "laser_scanner",
    .help = "Planar scanning range finder (2D lidar).",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .accepts = [](const Node& element) { return !sdf_element::has_planes(element); },
    .sdf_note = "topic names, intensities, visibility masks, range/resolution",
    .presets = presets,
});

}  // namespace sandlot::laser_scanner
