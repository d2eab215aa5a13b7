#include "devices/ranges/laser_scanner_3d/laser_scanner_3d.h"

#include <array>
#include <cstring>
#include <limits>

#include "base/math.h"
#include "devices/ranges/scan_limits.h"
#include "devices/sdf_noise.h"
#include "physics/parallel.h"

namespace sandlot::laser_scanner_3d {
namespace {

constexpr std::uint32_t point_bytes = 20;  // x y z intensity, ring, two bytes of padding
constexpr std::uint32_t ring_offset = 16;

double angle(double first, double last, int i, int count) {
  return count > 1 ? first + i * ((last - first) / (count - 1)) : 0.5 * (first + last);
}

void put_point(std::uint8_t* at, Vec3 p, std::uint16_t ring) {
  const float values[4] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0.0f};
  std::memcpy(at, values, sizeof values);
  std::memcpy(at + ring_offset, &ring, sizeof ring);
}

/// From distances to points. Only data of this scanner is touched.
void fill_cloud(Scanner& scanner) {
  const Spec& spec = scanner.spec;
  msg::PointCloud2& message = scanner.cloud->message;
  const auto columns = static_cast<std::size_t>(spec.columns);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  message.data.resize(scanner.distance_m.size() * point_bytes);  // the padding stays zero
  std::size_t points = 0;
  for (std::size_t i = 0; i < scanner.distance_m.size(); ++i) {
    const double d = static_cast<double>(scanner.distance_m[i]);
    const bool hit = std::isfinite(d);
    if (!hit && !spec.organised) continue;
    put_point(message.data.data() + points++ * point_bytes,
              hit ? scanner.directions_S[i] * d : Vec3{nan, nan, nan},
              static_cast<std::uint16_t>(i / columns));
  }
  if (!spec.organised) {
    message.data.resize(points * point_bytes);
    message.width = static_cast<std::uint32_t>(points);
    message.row_step = message.width * point_bytes;
  }
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  const Node* const sensor = lidar(element);
  if (!sensor) return element.error("a laser scanner needs a <lidar> or <ray> element");
  warn_unknown(*sensor, {"scan", "range", "noise"}, "<lidar>", diagnostics);
  for (const auto& [axis, key] : {std::pair{"horizontal", "columns"}, std::pair{"vertical", "planes"}}) {
    const std::string scan = std::string("scan/") + axis;
    SL_ASSIGN(const auto samples, number(*sensor, scan + "/samples"));
    SL_ASSIGN(const auto resolution, number(*sensor, scan + "/resolution"));
    config.set(key, samples ? scalar(std::floor(*samples * resolution.value_or(1.0)),
                                     *find(*sensor, scan + "/samples"))
                            : Node::scalar("1", sensor->place()));
  }
  copy(*sensor, "scan/vertical/min_angle", config, "min_elevation");
  copy(*sensor, "scan/vertical/max_angle", config, "max_elevation");
  SL_TRY(copy_scan(element, *sensor, config, diagnostics));
  return config;
}

}  // namespace

Result<Scanner> Scanner::create(const DeviceBuild& build, Spec spec) {
  if (static_cast<std::int64_t>(spec.columns) * spec.planes > max_beams)
    return build.error("columns", "the scanner has more than a million beams",
                       "columns * planes is at most " + std::to_string(max_beams));
  SL_TRY(check_scan_limits(build, spec));
  if (spec.max_elevation_rad < spec.min_elevation_rad)
    return build.error("max_elevation", "max_elevation must not be less than min_elevation",
                       "elevations grow upwards");

  Scanner scanner{spec};
  scanner.key = build.key;
  scanner.body = build.body().index;
  scanner.X_LS = build.decl.X_LS;
  const auto beams = static_cast<std::size_t>(spec.columns) * static_cast<std::size_t>(spec.planes);
  scanner.directions_S.reserve(beams);
  for (int p = 0; p < spec.planes; ++p) {
    const auto up = math::sincos(angle(spec.min_elevation_rad, spec.max_elevation_rad, p, spec.planes));
    for (int c = 0; c < spec.columns; ++c) {
      const auto [s, co] = math::sincos(angle(spec.min_angle_rad, spec.max_angle_rad, c, spec.columns));
      scanner.directions_S.push_back({up.cos * co, up.cos * s, up.sin});
    }
  }
  scanner.distance_m.resize(beams);
  Stream random(build.seed, build.key, Purpose::initial, 0);
  scanner.state.noise.reset(spec.noise, random);

  scanner.cloud = build.publish<msg::PointCloud2>(0, "points");
  msg::PointCloud2& message = scanner.cloud->message;
  message.header.frame_id = build.frame_id();
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", "intensity"}) {
    message.point_fields.push_back({name, offset, msg::PointField::float32, 1});
    offset += 4;
  }
  message.point_fields.push_back({"ring", ring_offset, msg::PointField::uint16, 1});
  message.point_step = point_bytes;
  message.height = spec.organised ? static_cast<std::uint32_t>(spec.planes) : 1;
  message.width = spec.organised ? static_cast<std::uint32_t>(spec.columns) : 0;
  message.row_step = message.width * point_bytes;
  message.is_dense = !spec.organised;
  return scanner;
}

void Scanner::sense(PoolView<Scanner> pool, const Context& context) {
  for (const std::uint32_t index : pool.due) {
    Scanner& scanner = pool.all[index];
    const Spec& spec = scanner.spec;
    const Pose X_WS = context.engine.states()[scanner.body].X_WB * scanner.X_LS;
    const auto columns = static_cast<std::size_t>(spec.columns);
    // One job per plane: its rays are neighbours.
    parallel_for(static_cast<std::size_t>(spec.planes), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t plane = begin; plane < end; ++plane) {
        const RayJob job{.X_WS = X_WS,
                         .directions = std::span(scanner.directions_S).subspan(plane * columns, columns),
                         .min_m = 0,
                         .max_m = spec.max_range_m,
                         .ignore_body = scanner.body,
                         .distance_m = std::span(scanner.distance_m).subspan(plane * columns, columns)};
        context.rays.cast({&job, 1});
      }
    });
    for (float& d : scanner.distance_m)
      if (static_cast<double>(d) < spec.min_range_m) d = -std::numeric_limits<float>::infinity();
    Stream random(context.seed, scanner.key, Purpose::noise, pool.sample[index]);
    scanner.state.noise.corrupt(spec.noise, pool.since[index].s(), random, spec.min_range_m, spec.max_range_m,
                                scanner.distance_m, spec.errors);
    fill_cloud(scanner);
    scanner.cloud->publish(context.now);
  }
}

namespace {
constexpr LevelInfo levels[] = {
    {"points", msg::PointCloud2::ros_type, "", "Points in the sensor's frame."},
};
constexpr const char* sdf_types[] = {"sensor:lidar",
                                     "sensor:gpu_lidar",
                                     "sensor:ray",
                                     "sensor:gpu_ray",
                                     "plugin:gazebo_ros_velodyne_laser",
                                     "plugin:gazebo_ros_velodyne_gpu_laser"};
constexpr Preset presets[] = {
    {"velodyne_vlp16",
     "Velodyne VLP-16: 16 planes of +-15 deg, full turn in steps of 0.2 deg, 100 m, 10 turns/s (general "
     "knowledge of "
     "the data sheet: +-3 cm, 2 mm).",
     "{columns: 1800, planes: 16, min_angle: -180 deg, max_angle: 179.8 deg, min_elevation: -15 deg,"
     " max_elevation: 15 deg, min_range: 0.5, max_range: 100, rate: 10,"
     " noise: {white: 1 cm, systematic: 2 cm, resolution: 2 mm}}"},
};
}  // namespace

constinit const Kind kind = make_kind<Scanner>({
    .name = "laser_scanner_3d",
    .help = "Scanning range finder with several planes (3D lidar).",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .accepts = [](const Node& element) { return sdf_element::has_planes(element); },
    .sdf_note = "topic names, intensities, visibility masks, range/resolution",
    .presets = presets,
});

}  // namespace sandlot::laser_scanner_3d
