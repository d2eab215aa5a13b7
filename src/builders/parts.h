#pragma once
/// Parts of models: links made of solids, joints, devices. Poses of links and joints are given in the model's
/// frame M, with all joints at 0.
#include <initializer_list>
#include <span>
#include <string>
#include <utility>

#include "base/fields.h"
#include "model/model.h"

namespace sandlot::builders {

namespace colors {
inline constexpr Color orange{0.90f, 0.36f, 0.06f, 1}, blue{0.10f, 0.28f, 0.72f, 1},
    green{0.16f, 0.50f, 0.20f, 1}, red{0.75f, 0.10f, 0.08f, 1}, yellow{0.95f, 0.75f, 0.10f, 1},
    violet{0.42f, 0.18f, 0.58f, 1}, teal{0.05f, 0.50f, 0.52f, 1}, white{0.92f, 0.92f, 0.90f, 1},
    dark{0.07f, 0.07f, 0.08f, 1}, grey{0.38f, 0.40f, 0.42f, 1}, wood{0.60f, 0.40f, 0.22f, 1},
    stone{0.55f, 0.53f, 0.50f, 1};
}

/// Solid fixed to a link, with mass, collision shape and visual.
struct Part {
  Shape shape;
  Pose X_LP;
  double mass_kg = 0;
  Color color;
  model::Surface surface;
  bool touches = true, shown = true;
};

/// A link without parts: no mass, which the first part with some or set_mass() gives it.
std::uint32_t add_link(model::Model& model, std::string name, const Pose& X_ML);
/// The link's mass, centre and inertia become those of all its parts together (homogeneous solids, overlaps
/// counted twice).
void add_part(model::Model& model, std::uint32_t link, const Part& part);
/// A mass without geometry: that of a ball of this radius about the link's origin.
void add_mass(model::Model& model, std::uint32_t link, double mass_kg, double radius_m);

struct JointOptions {
  model::JointType type = model::JointType::revolute;
  Vec3 axis_M{0, 0, 1};
  double lower = -1e16, upper = 1e16;
  double max_effort = 1e16, max_velocity = 1e16;
  double damping = 0;
};
/// A joint at `at_M`.
std::uint32_t add_joint(model::Model& model, std::string name, std::uint32_t parent, std::uint32_t child,
                        Vec3 at_M, const JointOptions& options);

/// A key's value: a text, or a list of texts.
struct KeyValue : Node {
  KeyValue(const char* text) : Node(scalar(text)) {}                    // NOLINT(google-explicit-constructor)
  KeyValue(std::string text) : Node(scalar(std::move(text))) {}         // NOLINT(google-explicit-constructor)
  KeyValue(const std::vector<std::string>& texts) : Node(sequence()) {  // NOLINT(google-explicit-constructor)
    for (const std::string& text : texts) push(scalar(text));
  }
};
using Keys = std::initializer_list<std::pair<const char*, KeyValue>>;
void add_device(model::Model& model, std::string name, const char* kind, Keys keys, std::uint32_t link = 0,
                const Pose& X_LS = {});
/// A joint_motor that holds its joint exactly, with what effort it takes up to the joint's: it follows angles
/// (lengths), or speeds on joints that turn without end.
void add_motor(model::Model& model, std::string name, std::uint32_t joint);
/// Own senses of a creature: angles and speeds of the joints it has so far, and an IMU in its first
/// link.
void add_senses(model::Model& model);

/// Units of a creature's motors and joint states.
enum class Units : std::uint8_t {
  si,       ///< rad, m, rad/s, m/s
  centred,  ///< -1 to 1 between a joint's limits, and of its largest speed
};
inline std::span<const EnumName<Units>> enum_names(Units) {
  static constexpr EnumName<Units> names[] = {{"si", Units::si}, {"centred", Units::centred}};
  return names;
}
inline constexpr Field units_field{"units", "",
                                   "Units of motors and joint states: SI, or -1 to 1 between the limits."};
/// Gives all motors and joint states of a model these units.
void set_units(model::Model& model, Units units);

/// The rotation that lays a cylinder, whose axis is z, along `axis` (unit).
Pose along(Vec3 axis, Vec3 at = {});

/// "name_3"
std::string numbered(const char* stem, int number);

}  // namespace sandlot::builders
