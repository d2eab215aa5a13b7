/// lamp: a light that is switched, dimmed and coloured by commands, for cameras and light sensors.
///
/// Frame    the device's frame S: a spot shines along x, a point light to all sides.
/// Command  level `brightness`: std_msgs/Float64, 0 (off) to 1 (full); values beyond are cut.
///          level `color`: std_msgs/ColorRGBA, red, green and blue from 0 to 1 instead of `color`; `a` has no meaning.
/// Output   the same, as the lamp shines, `rate` times per second.
/// Time     a command acts from the tick it arrives in: cameras of that tick see it.
/// Limits   no warm-up, no lag, no heat. Rays of light pass the lamp's own visuals as those of any light do: put it outside of
///          them, or switch `cast_shadows` off. The page and range sensors do not see it.
/// Cost     that of a light of the world while it is on; none while it is off. When one changes, all lights are handed to
///          the scene again.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "devices/kind.h"
#include "messages/messages.h"

namespace sandlot::lamp {
namespace {

enum class Type : std::uint8_t { point, spot };
std::span<const EnumName<Type>> enum_names(Type) {
  static constexpr EnumName<Type> names[] = {{"point", Type::point}, {"spot", Type::spot}};
  return names;
}

struct Spec {
  Type type = Type::point;
  std::array<double, 3> color{1, 1, 1};
  double intensity = 1, brightness = 1, range_m = 10;
  double constant = 1, linear_per_m = 0, quadratic_per_m2 = 0;
  double cone_rad = 1;
  bool cast_shadows = true;
  double rate_hz = 10;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"type", "", "Point light, or spot light along x."}, s.type);
    visit(Field{"color", "", "Colour at first: red, green and blue, each 0 to 1.", 0, 1}, s.color);
    visit(Field{"intensity", "1", "Factor on the colour of full light.", 0, 1e3}, s.intensity);
    visit(Field{"brightness", "1", "Brightness before the first command: 0 off, 1 full.", 0, 1},
          s.brightness);
    visit(Field{"range", "m", "Reach of the light; dark beyond.", 1e-3, 1e6}, s.range_m);
    visit(Field{"constant", "1",
                "Constant term of the attenuation 1 / (constant + linear d + quadratic d^2).", 1e-6, 1e6},
          s.constant);
    visit(Field{"linear", "1/m", "Linear term of the attenuation.", 0, 1e6}, s.linear_per_m);
    visit(Field{"quadratic", "1/m^2", "Quadratic term of the attenuation.", 0, 1e6}, s.quadratic_per_m2);
    visit(Field{"cone", "rad",
                "Whole angle of a spot light's cone; darker from its inner two thirds outwards.", 0.01, 3.1},
          s.cone_rad);
    visit(Field{"cast_shadows", "", "Whether things cast shadows in this light."}, s.cast_shadows);
    visit(Field{"rate", "Hz", "Messages per second; 0: one in every tick.", 0, 1e5}, s.rate_hz);
  }
};

struct State {
  std::uint64_t dimmed = 0, coloured = 0;
  double brightness = 1;
  std::array<double, 3> color{1, 1, 1};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"dimmed", "1", "Number of commands for the brightness seen."}, s.dimmed);
    visit(Field{"coloured", "1", "Number of commands for the colour seen."}, s.coloured);
    visit(Field{"brightness", "1", "Brightness, from 0 to 1.", 0, 1}, s.brightness);
    visit(Field{"color", "1", "Colour: red, green and blue, each 0 to 1.", 0, 1}, s.color);
  }
};

double part(double x) { return x >= 0 ? std::min(x, 1.0) : 0.0; }

struct Lamp {
  using Spec = lamp::Spec;
  using State = lamp::State;
  Spec spec;
  State state;
  SceneLight* light = nullptr;
  Topic<msg::Float64>*brightness = nullptr, *dim = nullptr;
  Topic<msg::ColorRGBA>*color = nullptr, *paint = nullptr;

  static Result<Lamp> create(const DeviceBuild& build, Spec spec) {
    Lamp lamp{spec, {}};
    lamp.state.brightness = spec.brightness;
    lamp.state.color = spec.color;
    model::Light light;
    light.name = build.path;
    light.type = spec.type == Type::spot ? model::Light::Type::spot : model::Light::Type::point;
    // Lights shine along -z of their frame.
    light.X_PLight = build.decl.X_LS * Pose{{}, quat_from_rpy(0, -math::pi / 2, 0)};
    const auto full = static_cast<float>(spec.intensity);
    light.color = light.specular = {full, full, full, 1};
    light.cast_shadows = spec.cast_shadows;
    light.range_m = spec.range_m;
    light.constant = spec.constant;
    light.linear = spec.linear_per_m;
    light.quadratic = spec.quadratic_per_m2;
    light.inner_rad = spec.cone_rad * 2 / 3;
    light.outer_rad = spec.cone_rad;
    lamp.light = build.shine(std::move(light));
    lamp.brightness = build.publish<msg::Float64>(0, "brightness");
    lamp.color = build.publish<msg::ColorRGBA>(1, "color");
    lamp.dim = build.accept<msg::Float64>(0, "brightness");
    lamp.paint = build.accept<msg::ColorRGBA>(1, "color");
    lamp.shine();  // cameras of the first tick see it, before the lamp has acted
    return lamp;
  }

  void shine() const {
    const auto factor = [&](std::size_t i) { return static_cast<float>(state.brightness * state.color[i]); };
    light->set({factor(0), factor(1), factor(2), 1});
  }

  static void actuate(PoolView<Lamp> pool, const Context&) {
    for (const std::uint32_t index : pool.due) {
      Lamp& lamp = pool.all[index];
      State& state = lamp.state;
      if (lamp.dim->count != state.dimmed) {
        state.dimmed = lamp.dim->count;
        state.brightness = part(lamp.dim->message.data);
      }
      if (lamp.paint->count != state.coloured) {
        state.coloured = lamp.paint->count;
        const msg::ColorRGBA& to = lamp.paint->message;
        state.color = {part(static_cast<double>(to.r)), part(static_cast<double>(to.g)),
                       part(static_cast<double>(to.b))};
      }
      lamp.shine();
    }
  }

  static void sense(PoolView<Lamp> pool, const Context& context) {
    for (const std::uint32_t index : pool.due) {
      Lamp& lamp = pool.all[index];
      if (pool.levels[index] & 1) {
        lamp.brightness->message.data = lamp.state.brightness;
        lamp.brightness->publish(context.now);
      }
      if (pool.levels[index] & 2) {
        const Color& now = lamp.light->factors();
        lamp.color->message = {now.r, now.g, now.b, 1};
        lamp.color->publish(context.now);
      }
    }
  }

  bool fits() const {
    const auto is_part = [](double x) { return x >= 0 && x <= 1; };
    return is_part(state.brightness) && std::all_of(state.color.begin(), state.color.end(), is_part);
  }
  void release(const Context&) const { light->set({0, 0, 0, 1}); }
};

constexpr LevelInfo levels[] = {
    {"brightness", msg::Float64::ros_type, msg::Float64::ros_type, "Brightness from 0 to 1."},
    {"color", msg::ColorRGBA::ros_type, msg::ColorRGBA::ros_type,
     "Colour of the light; published times its brightness."},
};

}  // namespace

extern const Kind kind;
constinit const Kind kind = make_kind<Lamp>({
    .name = "lamp",
    .help = "Light that commands switch, dim and colour; cameras and light sensors see it.",
    .levels = levels,
});

}  // namespace sandlot::lamp
