#include "devices/ranges/range_finder/range_finder.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/math.h"
#include "devices/ranges/cast_due.h"
#include "devices/sdf_noise.h"

namespace sandlot::range_finder {
namespace {

/// The nearest of the rays, as a driver reports it. Only data of this device is touched.
void finish(Finder& finder, std::uint64_t sample, Time since, const Context& context) {
  const Spec& spec = finder.spec;
  float nearest = *std::min_element(finder.distance_m.begin(), finder.distance_m.end());
  if (static_cast<double>(nearest) < spec.min_range_m) nearest = -std::numeric_limits<float>::infinity();
  Stream random(context.seed, finder.key, Purpose::noise, sample);
  finder.state.noise.corrupt(spec.noise, since.s(), random, spec.min_range_m, spec.max_range_m, {&nearest, 1},
                             spec.errors);
  finder.range->message.range = nearest;
  finder.range->publish(context.now);
}

/// <sonar>: a cone of a radius at its far end (or a sphere, which looks ahead here).
Result<Node> from_sonar(const Node& sonar, Node config, Diagnostics& diagnostics) {
  using namespace sdf_element;
  warn_unknown(sonar, {"min", "max", "radius", "geometry"}, "<sonar>", diagnostics);
  copy(sonar, "min", config, "min_range");
  copy(sonar, "max", config, "max_range");
  SL_ASSIGN(const auto radius_m, number(sonar, "radius"));
  SL_ASSIGN(const auto max_m, number(sonar, "max"));
  if (const Node* const geometry = find(sonar, "geometry"); geometry && text(geometry) == "sphere")
    diagnostics.warn(geometry->error("a sonar with a sphere is not supported: it looks ahead in a cone"));
  // SDF's defaults: a radius of 0.5 m at 1 m.
  config.set("fov",
             scalar(2 * math::atan2(std::abs(radius_m.value_or(0.5)), std::abs(max_m.value_or(1.0))), sonar));
  return config;
}

/// A <ray> sensor whose plugin publishes a Range: the corners of its beams are the cone.
Result<Node> from_rays(const Node& element, const Node& rays, Node config, Diagnostics& diagnostics) {
  using namespace sdf_element;
  warn_unknown(rays, {"scan", "range", "noise"}, "<ray>", diagnostics);
  SL_ASSIGN(const auto min_rad, number(rays, "scan/horizontal/min_angle"));
  SL_ASSIGN(const auto max_rad, number(rays, "scan/horizontal/max_angle"));
  SL_ASSIGN(const auto fov_rad, number(element, "plugin/fov"));
  config.set("fov", scalar(fov_rad ? *fov_rad : max_rad.value_or(0) - min_rad.value_or(0), rays));
  copy(rays, "range/min", config, "min_range");
  copy(rays, "range/max", config, "max_range");
  const std::string radiation = text(find(element, "plugin/radiation"));
  const std::string newer = text(find(element, "plugin/radiation_type"));
  config.set("radiation",
             Node::scalar(radiation == "infrared" || newer == "infrared" ? "infrared" : "ultrasound",
                          element.place()));
  if (const Node* const noise = find(rays, "noise")) {
    SL_ASSIGN(Node errors, range_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set("noise", std::move(errors));
  }
  return config;
}

Result<Node> from_sdf(const Node& element, Diagnostics& diagnostics) {
  using namespace sdf_element;
  Node config = Node::map(element.place());
  copy_rate(element, "update_rate", config);
  if (const Node* const sonar = find(element, "sonar"))
    return from_sonar(*sonar, std::move(config), diagnostics);
  if (const Node* const rays = lidar(element))
    return from_rays(element, *rays, std::move(config), diagnostics);
  return element.error("a range finder needs a <sonar> or <ray> element");
}

}  // namespace

Result<Finder> Finder::create(const DeviceBuild& build, Spec spec) {
  if (spec.max_range_m <= spec.min_range_m) {
    return build.error("max_range", "max_range must be greater than min_range",
                       "min_range is " + number_text(spec.min_range_m) + " m");
  }
  Finder finder{spec};
  finder.key = build.key;
  finder.body = build.body().index;
  finder.X_LS = build.decl.X_LS;
  finder.directions_S.push_back({1, 0, 0});
  for (int ring = 1; ring <= spec.rings; ++ring) {
    const auto off = math::sincos(0.5 * spec.fov_rad * ring / spec.rings);
    for (int i = 0; i < 6 * ring; ++i) {
      const auto about = math::sincos(math::tau * i / (6 * ring));
      finder.directions_S.push_back({off.cos, off.sin * about.cos, off.sin * about.sin});
    }
  }
  finder.distance_m.resize(finder.directions_S.size());
  Stream random(build.seed, build.key, Purpose::initial, 0);
  finder.state.noise.reset(spec.noise, random);

  finder.range = build.publish<msg::Range>(0, "range");
  msg::Range& message = finder.range->message;
  message.header.frame_id = build.frame_id();
  message.radiation_type = static_cast<std::uint8_t>(spec.radiation);
  message.field_of_view = static_cast<float>(spec.fov_rad);
  message.min_range = static_cast<float>(spec.min_range_m);
  message.max_range = static_cast<float>(spec.max_range_m);
  message.range = std::numeric_limits<float>::infinity();
  return finder;
}

void Finder::sense(PoolView<Finder> pool, const Context& context) {
  cast_due(
      pool, context, [](Finder& finder) -> std::span<float> { return finder.distance_m; }, finish);
}

namespace {
constexpr LevelInfo levels[] = {
    {"range", msg::Range::ros_type, "", "The nearest distance in the cone."},
};
constexpr const char* sdf_types[] = {"sensor:sonar", "plugin:gazebo_ros_range",
                                     "plugin:gazebo_ros_ray_sensor", "plugin:hector_gazebo_ros_sonar"};
/// gazebo_ros_ray_sensor publishes several types of message; only a Range is ours.
bool accepts(const Node& element) {
  const std::string file = sdf_element::text(sdf_element::find(element, "plugin/@filename"));
  return file.find("gazebo_ros_ray_sensor") == std::string::npos ||
         sdf_element::text(sdf_element::find(element, "plugin/output_type")) == "sensor_msgs/Range";
}
constexpr Preset presets[] = {
    {"sharp_gp2d12",
     "Sharp GP2D12, an infra-red position sensitive detector: 10 to 80 cm, about 25 samples/s (general "
     "knowledge of the "
     "data sheet; the error is uncertain).",
     "{radiation: infrared, fov: 2 deg, rings: 1, min_range: 0.1, max_range: 0.8, rate: 25,"
     " noise: {white: 5 mm, systematic: 1 cm}}"},
    {"polaroid_6500",
     "Polaroid 6500 sonar as the Pioneer and the B21 carry it: 15 cm to 5 m, cone of about 30 deg, each "
     "fired 3 "
     "times a second (general knowledge of the makers' manuals; the error is uncertain).",
     "{radiation: ultrasound, fov: 30 deg, rings: 3, min_range: 0.15, max_range: 5, rate: 3.125,"
     " noise: {white: 1 cm, resolution: 1 cm}}"},
    {"devantech_srf08",
     "Devantech SRF08 ultrasonic ranger: 3 cm to 6 m, cone of about 55 deg, 15 samples/s (general knowledge "
     "of the "
     "maker's page; the error is uncertain).",
     "{radiation: ultrasound, fov: 55 deg, rings: 4, min_range: 0.03, max_range: 6, rate: 15,"
     " noise: {white: 1 cm, resolution: 1 cm}}"},
};
}  // namespace

constinit const Kind kind = make_kind<Finder>({
    .name = "range_finder",
    .help = "Range finder of one distance: infra-red beam or sonar cone.",
    .levels = levels,
    .sdf_types = sdf_types,
    .from_sdf = from_sdf,
    .accepts = accepts,
    .sdf_note = "topic and frame names",
    .presets = presets,
});

}  // namespace sandlot::range_finder
