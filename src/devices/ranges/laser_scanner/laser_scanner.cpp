#include "devices/ranges/laser_scanner/laser_scanner.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/math.h"
#include "devices/ranges/cast_due.h"
#include "devices/ranges/scan_limits.h"
#include "devices/sdf_noise.h"

namespace sandlot::laser_scanner {
namespace {

enum Level : std::uint32_t { ranges_level, segments_level, pose_level };
/// Streams of their own: switching one level on or off moves no numbers of another.
constexpr std::uint64_t segments_use = 1, pose_use = 2;

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

void find_segments(Scanner& scanner, std::uint64_t sample, const Context& context) {
  const Spec& spec = scanner.spec;
  std::vector<msg::LineSegment>& segments = scanner.segments->message.segments;
  const SegmentFinder::Fan fan{spec.min_angle_rad, spec.max_angle_rad,        spec.segments.step_rad,
                               spec.min_range_m,   spec.segments.tolerance_m, spec.segments.min_length_m};
  const RayJob job{.X_WS = context.engine.states()[scanner.body].X_WB * scanner.X_LS,
                   .max_m = spec.max_range_m,
                   .ignore_body = scanner.body};
  scanner.finder.find(fan, context.rays, job, segments);
  const double std_m = spec.errors * spec.segments.end_std_m;
  const double miss = std::min(1.0, spec.errors * spec.segments.miss);
  if (std_m > 0 || miss > 0) {
    Stream random = Stream(context.seed, scanner.key, Purpose::noise, sample).fork(segments_use);
    std::size_t kept = 0;
    for (msg::LineSegment segment : segments) {
      for (msg::Point* const end : {&segment.start, &segment.end}) {
        end->x += std_m * random.normal();
        end->y += std_m * random.normal();
      }
      if (random.uniform() >= miss) segments[kept++] = segment;
    }
    segments.resize(kept);
  }
  scanner.segments->publish(context.now);
}

void publish_pose(Scanner& scanner, std::uint64_t sample, Time since, const Context& context) {
  const Spec& spec = scanner.spec;
  const Stream random = Stream(context.seed, scanner.key, Purpose::noise, sample).fork(pose_use);
  msg::PoseWithCovariance& pose = scanner.pose->message.pose;
  pose.pose = scanner.state.pose.corrupt(spec.pose, context.engine.states()[scanner.base].X_WB, since.s(),
                                         random, spec.errors);
  pose.covariance = covariance_of(spec.pose, spec.errors);
  scanner.pose->publish(context.now);
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
  SL_TRY(copy_scan(element, *sensor, config, diagnostics));
  return config;
}

}  // namespace

Result<Scanner> Scanner::create(const DeviceBuild& build, Spec spec) {
  SL_TRY(check_scan_limits(build, spec));

  Scanner scanner{spec};
  scanner.key = build.key;
  scanner.body = build.body().index;
  scanner.base = build.bodies.front().index;
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

  scanner.state.pose.reset(spec.pose, random.fork(pose_use));

  scanner.scan = build.publish<msg::LaserScan>(ranges_level, "ranges");
  msg::LaserScan& message = scanner.scan->message;
  message.header.frame_id = build.frame_id();
  message.angle_min = static_cast<float>(first);
  message.angle_max = static_cast<float>(first + static_cast<double>(spec.beams - 1) * increment);
  message.angle_increment = static_cast<float>(increment);
  message.scan_time = static_cast<float>(spec.rate_hz > 0 ? 1 / spec.rate_hz : build.tick.s());
  message.range_min = static_cast<float>(spec.min_range_m);
  message.range_max = static_cast<float>(spec.max_range_m);
  message.ranges.assign(beams, std::numeric_limits<float>::infinity());
  scanner.segments = build.publish<msg::LineSegmentArray>(segments_level, "segments");
  scanner.segments->message.header.frame_id = build.frame_id();
  scanner.pose = build.publish<msg::PoseWithCovarianceStamped>(pose_level, "pose");
  scanner.pose->message.header.frame_id = "world";
  return scanner;
}

void Scanner::sense(PoolView<Scanner> pool, const Context& context) {
  const auto distances_of = [](Scanner& scanner) -> std::span<float> {
    scanner.scan->message.ranges.resize(scanner.directions_S.size());
    return scanner.scan->message.ranges;
  };
  // Each level serves the scanners that have it: one with poses alone casts no ray.
  const auto at = [&pool](std::uint32_t level, std::vector<std::uint32_t>& chosen) {
    chosen.clear();
    for (const std::uint32_t index : pool.due)
      if (pool.levels[index] >> level & 1) chosen.push_back(index);
    return std::span<const std::uint32_t>(chosen);
  };
  static thread_local std::vector<std::uint32_t> chosen;  // keeps its room
  PoolView<Scanner> scanning = pool;
  scanning.due = at(ranges_level, chosen);
  if (!chosen.empty()) cast_due(scanning, context, distances_of, finish);
  const std::span<const std::uint32_t> lines = at(segments_level, chosen);
  parallel_for(lines.size(), 2, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      find_segments(pool.all[lines[i]], pool.sample[lines[i]], context);
  });
  for (const std::uint32_t index : at(pose_level, chosen))
    publish_pose(pool.all[index], pool.sample[index], pool.since[index], context);
}

namespace {
constexpr LevelInfo levels[] = {
    {"ranges", msg::LaserScan::ros_type, "", "Distances of all beams."},
    {"segments", msg::LineSegmentArray::ros_type, "",
     "Line segments along the surfaces that the scanner sees."},
    {"pose", msg::PoseWithCovarianceStamped::ros_type, "",
     "Pose of the robot, with the errors of a localisation."},
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
    {"sick_lms100",
     "SICK LMS100: 270 deg in steps of 0.5 deg, 20 m, 50 scans/s (errors +-30 mm and 12 mm from the maker's "
     "page, the rest "
     "general knowledge).",
     "{beams: 541, min_angle: -135 deg, max_angle: 135 deg, min_range: 0.05, max_range: 20, rate: 50,"
     " noise: {white: 12 mm, systematic: 30 mm, resolution: 1 mm}}"},
    {"sick_lms500",
     "SICK LMS500 SR: 190 deg in steps of 0.5 deg, 80 m, 50 scans/s (errors from the maker's page: +-25 mm; "
     "6 mm up to 10 m, "
     "8 mm up to 20 m, 14 mm up to 30 m, which is met by an error that grows with the square; the rest "
     "general knowledge).",
     "{beams: 381, min_angle: -95 deg, max_angle: 95 deg, min_range: 0.2, max_range: 80, rate: 50,"
     " noise: {white: 6 mm, systematic: 25 mm, resolution: 1 mm, stages: [{growing: {std: 2 mm, at: 10 "
     "m}}]}}"},
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
