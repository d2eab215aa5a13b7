#include "builders/wheeled.h"

#include <algorithm>

namespace sandlot::builders {
namespace {

void add_lamps(model::Model& model, std::uint32_t base, Vec3 front, double apart_m, double size_m) {
  for (const double side : {1.0, -1.0})
    add_part(model, base,
             {.shape = Sphere{size_m},
              .X_LP = {front + Vec3{0, side * apart_m, 0}, {}},
              .color = colors::yellow,
              .touches = false});
}

}  // namespace

Part creature_wheel(WheelShape shape, double radius, double width, double mass_kg,
                    const model::Surface& surface) {
  if (shape == WheelShape::balls) return {Sphere{radius}, {}, mass_kg, colors::dark, surface};
  return {Cylinder{radius, width}, along({0, 1, 0}), mass_kg, colors::dark, surface};
}

std::uint32_t add_wheel(model::Model& model, const WheelOptions& w) {
  const std::uint32_t wheel = add_link(model, w.name + "_wheel", {w.centre_M, {}});
  model::Surface tyre;
  tyre.mu = tyre.mu2 = w.friction;
  // Under rollers lies a hub, which touches nothing.
  const double radius = w.rollers ? w.radius_m - 2.2 * w.rollers->roller_radius_m : w.radius_m;
  add_part(model, wheel,
           {Cylinder{radius, w.width_m}, along(w.axis_M), w.mass_kg, w.rollers ? colors::grey : colors::dark,
            tyre, !w.rollers.has_value()});
  // Three bars across the wheel, seen on both sides, the first one in colour.
  const Quat upright = quat_between({0, 0, 1}, w.axis_M);
  for (int i = 0; i < 3; ++i)
    add_part(model, wheel,
             {.shape = Box{{1.5 * radius, 0.16 * radius, w.width_m + 0.004}},
              .X_LP = {{}, upright * quat_from_axis_angle({0, 0, 1}, i * 1.0471975511965976)},
              .color = i == 0 ? colors::orange : colors::white,
              .touches = false});
  const std::uint32_t joint = add_joint(model, w.name + "_joint", w.parent, wheel, w.centre_M,
                                        {.type = model::JointType::continuous,
                                         .axis_M = w.axis_M,
                                         .max_effort = w.max_effort_Nm,
                                         .max_velocity = w.max_speed_radps});
  model.joints[joint].rollers = w.rollers;
  return joint;
}

void add_box_body(model::Model& model, std::uint32_t base, Vec3 size, double low_z, double mass_kg,
                  Color color) {
  const double z = low_z + size.z / 2;
  add_part(model, base, {Box{size}, {{0, 0, z}, {}}, mass_kg, color});
  add_part(model, base,
           {.shape = Box{{0.5 * size.x, 0.7 * size.y, 0.16 * size.z}},
            .X_LP = {{-0.12 * size.x, 0, low_z + 1.08 * size.z}, {}},
            .color = colors::white,
            .touches = false});
  add_lamps(model, base, {size.x / 2, 0, z}, 0.3 * size.y, 0.16 * std::min(size.y, size.z));
}

void add_round_body(model::Model& model, std::uint32_t base, double radius, double height, double low_z,
                    double mass_kg, Color color) {
  const double z = low_z + height / 2;
  add_part(model, base, {Cylinder{radius, height}, {{0, 0, z}, {}}, mass_kg, color});
  add_part(model, base,
           {.shape = Box{{0.5 * radius, 0.2 * radius, 0.1 * height}},
            .X_LP = {{0.6 * radius, 0, low_z + 1.04 * height}, {}},
            .color = colors::white,
            .touches = false});
  add_lamps(model, base, {0.94 * radius, 0, z}, 0.25 * radius, 0.12 * radius);
}

std::uint32_t add_steering(model::Model& model, const std::string& name, std::uint32_t base, Vec3 pivot,
                           double limit_rad, double wheel_radius, double mass_kg) {
  const std::uint32_t fork = add_link(model, name + "_fork", {pivot, {}});
  add_part(model, fork,
           {.shape = Cylinder{0.18 * wheel_radius, 0.8 * wheel_radius},
            .X_LP = {{0, 0, 1.2 * wheel_radius}, {}},
            .mass_kg = mass_kg,
            .color = colors::grey,
            .touches = false});
  add_joint(model, name + "_steering", base, fork, pivot,
            {.lower = -limit_rad, .upper = limit_rad, .max_effort = 20, .max_velocity = 20});
  return fork;
}

}  // namespace sandlot::builders
