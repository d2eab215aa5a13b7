#pragma once
/// Joints of a model.
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/fields.h"
#include "base/result.h"
#include "geometry/pose.h"
#include "model/wheel.h"

namespace sandlot::model {

/// A universal joint turns about `axis_J` and then about `second->axis_J`; a screw turns and slides along one axis.
enum class JointType : std::uint8_t { fixed, revolute, continuous, prismatic, ball, universal, screw };

inline std::span<const EnumName<JointType>> enum_names(JointType) {
  static constexpr EnumName<JointType> names[] = {{"fixed", JointType::fixed},
                                                  {"revolute", JointType::revolute},
                                                  {"continuous", JointType::continuous},
                                                  {"prismatic", JointType::prismatic},
                                                  {"ball", JointType::ball},
                                                  {"universal", JointType::universal},
                                                  {"screw", JointType::screw}};
  return names;
}

/// One axis of a joint follows another joint of the model: position = multiplier * (leader - reference) + offset.
struct Mimic {
  std::uint32_t joint = 0;  ///< index of the leader
  double multiplier = 1, offset = 0, reference = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"joint", "", "Index of the leader."}, s.joint);
    visit(Field{"multiplier", "1", "Ratio of the position to that of the leader."}, s.multiplier);
    visit(Field{"offset", "rad", "Position when the leader is at its reference."}, s.offset);
    visit(Field{"reference", "rad", "Position of the leader at which this joint is at its offset."},
          s.reference);
  }
};

/// Limits that a motor keeps before the joint's own ones end the motion, as the safety controller of ROS:
///   speed within [-k_position (x - soft_lower), -k_position (x - soft_upper)] and the largest speed,
///   effort within [-k_velocity (v - lowest speed), -k_velocity (v - highest speed)] and the largest effort.
/// A gain of 0 leaves its line out.
struct SafetyLimits {
  double soft_lower = -1e16, soft_upper = 1e16;
  double k_position = 0, k_velocity = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"soft_lower", "rad", "Position below which motors do not turn the joint."}, s.soft_lower);
    visit(Field{"soft_upper", "rad", "Position above which motors do not turn the joint."}, s.soft_upper);
    visit(Field{"k_position", "1/s", "Speed that is allowed per distance from a soft limit."}, s.k_position);
    visit(Field{"k_velocity", "Nm s/rad", "Torque that is allowed per distance from a limit of the speed."},
          s.k_velocity);
  }
};

/// The second axis of a universal joint. It is passive: it can be limited and damped, not driven or read.
struct SecondAxis {
  Vec3 axis_J{0, 1, 0};  ///< unit, in J, across the first
  double lower = -1e16, upper = 1e16;
  double damping = 0, friction = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"axis", "1", "Unit vector in the joint's frame, across the first axis."}, s.axis_J);
    visit(Field{"lower", "rad", "Lower limit."}, s.lower);
    visit(Field{"upper", "rad", "Upper limit."}, s.upper);
    visit(Field{"damping", "Nm s/rad", "Viscous damping."}, s.damping);
    visit(Field{"friction", "Nm", "Coulomb friction."}, s.friction);
  }
};

/// Connection of child to parent. The joint frame J is fixed in the child; positions are 0 in the declared pose.
/// Units in the list of fields are those of turning joints; a prismatic joint has m for rad and N for Nm.
struct Joint {
  std::string name;
  JointType type = JointType::fixed;
  std::uint32_t parent = 0;  ///< index of the link, or world_link
  std::uint32_t child = 0;
  Pose X_CJ;             ///< J in the child link
  Vec3 axis_J{0, 0, 1};  ///< unit, in J
  double lower = -1e16, upper = 1e16;
  double max_effort = 1e16;
  double max_velocity = 1e16;
  double damping = 0, friction = 0;
  double spring_stiffness = 0, spring_reference = 0;
  double thread_pitch_m = 0;
  std::optional<SecondAxis> second;  ///< of universal joints only
  std::optional<Mimic> mimic;
  std::optional<SafetyLimits> safety;
  std::optional<RollerWheel> rollers;  ///< about axis_J
  std::uint32_t roller_of = no_joint;  ///< of a roller: the joint of its wheel
  Place place;
  static constexpr std::uint32_t no_joint = ~0u;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the joint."}, s.name);
    visit(Field{"type", "", "Type of the joint."}, s.type);
    visit(Field{"parent", "", "Index of the parent link, or that of the world."}, s.parent);
    visit(Field{"child", "", "Index of the child link."}, s.child);
    visit(Field{"pose", "", "Pose of the joint's frame in the child link."}, s.X_CJ);
    visit(Field{"axis", "1", "Unit vector in the joint's frame."}, s.axis_J);
    visit(Field{"lower", "rad", "Lower limit."}, s.lower);
    visit(Field{"upper", "rad", "Upper limit."}, s.upper);
    visit(Field{"max_effort", "Nm", "Largest torque of a motor."}, s.max_effort);
    visit(Field{"max_velocity", "rad/s", "Largest speed of a motor."}, s.max_velocity);
    visit(Field{"damping", "Nm s/rad", "Viscous damping."}, s.damping);
    visit(Field{"friction", "Nm", "Coulomb friction."}, s.friction);
    visit(Field{"spring_stiffness", "Nm/rad", "Stiffness of the spring."}, s.spring_stiffness);
    visit(Field{"spring_reference", "rad", "Position at which the spring is relaxed."}, s.spring_reference);
    visit(Field{"thread_pitch", "m", "Slide of a screw per turn, right-handed when positive."},
          s.thread_pitch_m);
    visit(Field{"second", "", "Second axis of a universal joint."}, s.second);
    visit(Field{"mimic", "", "Coupling to another joint."}, s.mimic);
    visit(Field{"safety", "", "Limits that motors keep before the joint ends the motion."}, s.safety);
    visit(Field{"rollers", "", "Rollers of the wheel that the child is."}, s.rollers);
    visit(Field{"roller_of", "", "Index of the wheel's joint, of the joint of a roller."}, s.roller_of);
  }
};
inline constexpr std::uint32_t world_link = ~0u;

}  // namespace sandlot::model
