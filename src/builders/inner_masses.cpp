#include "builders/inner_masses.h"

namespace sandlot::builders {

Status InnerMassSpec::check(const Node& node, const std::string& path, double diameter_m,
                            const char* shell) const {
  if (range_m < diameter_m / 2) return {};
  return parameter_error(node, path, "range", std::string("the masses would leave the ") + shell,
                         "choose a range below half the diameter");
}

void add_inner_mass(model::Model& model, std::uint32_t shell, const char* name, Vec3 axis,
                    const InnerMassSpec& spec, const Shape& rail, const Part& part) {
  add_part(model, shell, {.shape = rail, .X_LP = along(axis), .color = part.color, .touches = false});
  const std::uint32_t mass = add_link(model, std::string("mass_") + name, {});
  add_part(model, mass, part);
  add_motor(model, name,
            add_joint(model, std::string("slider_") + name, shell, mass, {},
                      {.type = model::JointType::prismatic,
                       .axis_M = axis,
                       .lower = -spec.range_m,
                       .upper = spec.range_m,
                       .max_effort = spec.power_N,
                       .max_velocity = spec.speed_mps}));
}

}  // namespace sandlot::builders
