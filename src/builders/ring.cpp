#include "builders/ring.h"

#include "base/math.h"

namespace sandlot::builders {

Built build_ring(const RingSpec& s) {
  Built out;
  model::Model& m = out.model;
  // Neighbours' centres are 1.15 diameters apart: room to bend.
  const double step = math::tau / s.segments, pitch = 1.15 * s.diameter_m;
  const double radius = pitch / (2 * math::sin(step / 2));
  const double thick = s.diameter_m / 2;
  // A stave at the bottom: the ring stands on it.
  out.X_WM.p.z = radius + thick;
  const auto at = [&](double angle, double r) {  // from the bottom, towards x
    return Vec3{r * math::sin(angle), 0, -r * math::cos(angle)};
  };
  for (int i = 0; i < s.segments; ++i) {
    const double angle = i * step;
    // x of a stave: along the rim, in the order of numbers; z: to the middle.
    const std::uint32_t stave = add_link(m, numbered("stave", i + 1),
                                         {at(angle, radius), quat_from_axis_angle({0, 1, 0}, -angle)});
    const Color shade = i == 0       ? colors::yellow
                        : i % 2 == 0 ? s.color
                                     : Color{0.6f * s.color.r, 0.6f * s.color.g, 0.6f * s.color.b, 1};
    add_part(m, stave, {Capsule{thick, s.length_m - s.diameter_m}, along({0, 1, 0}), s.mass_kg, shade});
  }
  for (int i = 0; i < s.segments; ++i) {
    const auto parent = static_cast<std::uint32_t>(i);
    const auto child = static_cast<std::uint32_t>((i + 1) % s.segments);
    const double angle = (i + 0.5) * step;
    const Vec3 where = at(angle, radius * math::cos(step / 2));
    const bool slides = s.sliders && i % 2 == 1;
    JointOptions options{.axis_M = {0, -1, 0},
                         .lower = -s.limit_out_rad,
                         .upper = s.limit_in_rad,
                         .max_effort = s.power_Nm,
                         .max_velocity = s.speed_radps};
    if (slides)
      options = {.type = model::JointType::prismatic,
                 .axis_M = {math::cos(angle), 0, math::sin(angle)},
                 .lower = -s.slide_m,
                 .upper = s.slide_m,
                 .max_effort = s.power_Nm / pitch,
                 .max_velocity = s.speed_radps * pitch};
    const std::string name = numbered(slides ? "slider" : "hinge", i + 1);
    const std::uint32_t joint = add_joint(m, name + "_joint", parent, child, where, options);
    add_motor(m, name, joint);
  }
  add_senses(m);
  set_units(m, s.units);
  return out;
}

}  // namespace sandlot::builders
