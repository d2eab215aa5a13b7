#include "base/math.h"
#include "base/text.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {
namespace {

constexpr double unlimited = 1e16;  ///< SDF's own word for it
constexpr Range bound_range{-unlimited, unlimited};

Result<model::JointType> joint_type(const Xml& joint) {
  static constexpr std::pair<const char*, model::JointType> types[] = {
      {"fixed", model::JointType::fixed},
      {"revolute", model::JointType::revolute},
      {"continuous", model::JointType::continuous},
      {"prismatic", model::JointType::prismatic},
      {"ball", model::JointType::ball},
      {"universal", model::JointType::universal},
      {"screw", model::JointType::screw},
      {"revolute2", model::JointType::universal}};
  const std::string* const text = joint.attribute("type");
  const std::string name = "joint '" + *joint.attribute("name") + "'";
  if (!text) return joint.error(name + " has no type", "write type=\"revolute\"");
  std::vector<std::string> known;
  for (const auto& [word, type] : types) {
    if (*text == word) return type;
    known.emplace_back(word);
  }
  return joint.error(name + ": there is no type '" + text->substr(0, 40) + "'", suggestion(*text, known));
}

/// What has no sign: negative means "no limit" too.
Status read_maximum(const Xml& limit, const char* key, double& out) {
  SL_TRY(read_capped(limit, key, bound_range, out));
  if (out < 0) out = unlimited;
  return {};
}

Result<Vec3> read_direction(const Xml& axis, const Reading& in) {
  Vec3 direction{0, 0, 1};
  SL_TRY(read_child(axis, "xyz", position_range, direction));
  if (const auto resolved = in.frames.axes.find(&axis); resolved != in.frames.axes.end())
    direction = resolved->second;
  if (!(norm(direction) > 1e-6))
    return axis.child("xyz")->error("the axis of this joint is zero", "write 0 0 1");
  return normalised(direction);
}

Status read_limits(const Xml& axis, double& lower, double& upper, double* effort, double* velocity,
                   const Reading& in) {
  const Xml* const limit = axis.child("limit");
  if (!limit) return {};
  in.notes.unused(*limit, "lower upper effort velocity", "stiffness dissipation");
  SL_TRY(read_capped(*limit, "lower", bound_range, lower));
  SL_TRY(read_capped(*limit, "upper", bound_range, upper));
  if (lower > upper)
    return limit->error("the lower limit " + number_text(lower) + " is above the upper limit " +
                        number_text(upper));
  if (effort) SL_TRY(read_maximum(*limit, "effort", *effort));
  if (velocity) SL_TRY(read_maximum(*limit, "velocity", *velocity));
  return {};
}

Status read_axis(const Xml& axis, model::Joint& out, const Reading& in) {
  in.notes.unused(axis, "xyz limit dynamics mimic", "initial_position");
  SL_ASSIGN(out.axis_J, read_direction(axis, in));
  SL_TRY(read_limits(axis, out.lower, out.upper, &out.max_effort, &out.max_velocity, in));
  if (const Xml* const dynamics = axis.child("dynamics")) {
    in.notes.unused(*dynamics, "damping friction spring_stiffness spring_reference");
    SL_TRY(read_child(*dynamics, "damping", not_negative, out.damping));
    SL_TRY(read_child(*dynamics, "friction", not_negative, out.friction));
    SL_TRY(read_child(*dynamics, "spring_stiffness", not_negative, out.spring_stiffness));
    SL_TRY(read_child(*dynamics, "spring_reference", {-1e6, 1e6}, out.spring_reference));
  }
  return {};
}

Status read_second_axis(const Xml& axis, model::Joint& out, const Reading& in) {
  in.notes.unused(axis, "xyz limit dynamics", "initial_position");
  model::SecondAxis second;
  SL_ASSIGN(second.axis_J, read_direction(axis, in));
  // Files write axes with a few digits; across is within a tenth of a degree.
  if (std::abs(dot(second.axis_J, out.axis_J)) > 2e-3)
    return axis.error("the two axes of joint '" + out.name + "' are not perpendicular",
                      "a universal joint needs them so; make two revolute joints with a link between");
  second.axis_J = normalised(second.axis_J - dot(second.axis_J, out.axis_J) * out.axis_J);
  SL_TRY(read_limits(axis, second.lower, second.upper, nullptr, nullptr, in));
  if (const Xml* const dynamics = axis.child("dynamics")) {
    in.notes.unused(*dynamics, "damping friction", "spring_reference spring_stiffness");
    SL_TRY(read_child(*dynamics, "damping", not_negative, second.damping));
    SL_TRY(read_child(*dynamics, "friction", not_negative, second.friction));
    double stiffness = 0;
    SL_TRY(read_child(*dynamics, "spring_stiffness", not_negative, stiffness));
    if (stiffness > 0) in.notes.warn(*dynamics, "a spring on the second axis of a joint is not used");
  }
  out.second = second;
  return {};
}

Status read_pitch(const Xml& joint, model::Joint& out) {
  if (const Xml* const pitch = joint.child("screw_thread_pitch")) {
    SL_ASSIGN(out.thread_pitch_m, read_double(*pitch, {-1e6, 1e6}));
    if (out.thread_pitch_m == 0)
      return pitch->error("the pitch of a screw cannot be 0", "in metres per turn");
    return {};
  }
  const Xml* const old = joint.child("thread_pitch");
  if (!old)
    return joint.error("joint '" + out.name + "' is a screw and has no <screw_thread_pitch>",
                       "write <screw_thread_pitch>0.01</screw_thread_pitch>, in metres per turn");
  // The older element is in radians per metre, with the sign turned round.
  SL_ASSIGN(const double rad_per_m, read_double(*old, {-1e9, 1e9}));
  if (!(std::abs(rad_per_m) > 1e-9))
    return old->error("the <thread_pitch> of a screw cannot be 0", "write <screw_thread_pitch>");
  out.thread_pitch_m = -2 * math::pi / rad_per_m;
  return {};
}

}  // namespace

bool is_gearbox(const Xml& element) {
  const std::string* const type = element.attribute("type");
  return type && *type == "gearbox";
}

Status read_joint_motion(const Xml& element, model::Joint& out, const Reading& in) {
  SL_ASSIGN(out.type, joint_type(element));
  const bool turns = out.type != model::JointType::fixed && out.type != model::JointType::ball;
  const bool two = out.type == model::JointType::universal, screw = out.type == model::JointType::screw;
  in.notes.unused(element,
                  std::string("parent child pose axis sensor* ") + (two ? "axis2 " : "") +
                      (screw ? "thread_pitch screw_thread_pitch" : ""),
                  screw ? "physics" : "physics thread_pitch");
  const Xml* const axis = element.child("axis");
  if (turns && !axis)
    return element.error("joint '" + out.name + "' has no <axis>", "write <axis><xyz>0 0 1</xyz></axis>");
  if (axis && turns) SL_TRY(read_axis(*axis, out, in));
  if (two) {
    const Xml* const second = element.child("axis2");
    if (!second)
      return element.error("joint '" + out.name + "' has no <axis2>",
                           "a universal joint turns about two axes: write <axis2><xyz>0 1 0</xyz></axis2>");
    SL_TRY(read_second_axis(*second, out, in));
  }
  if (screw) SL_TRY(read_pitch(element, out));
  if (out.type == model::JointType::continuous) {
    out.lower = -unlimited;
    out.upper = unlimited;
  }
  return {};
}

Status read_safety(const Xml& joint, model::Joint& out, const Reading& in) {
  const Xml* const safety = joint.child("sandlot:safety");
  if (!safety) return {};
  using Type = model::JointType;
  if (out.type != Type::revolute && out.type != Type::continuous && out.type != Type::prismatic)
    return safety->error("joint '" + out.name + "' has no motion that a safety controller could limit",
                         "revolute, continuous and prismatic joints have one");
  in.notes.unused(*safety, "soft_lower soft_upper k_position k_velocity");
  model::SafetyLimits limits;
  SL_TRY(read_child(*safety, "soft_lower", bound_range, limits.soft_lower));
  SL_TRY(read_child(*safety, "soft_upper", bound_range, limits.soft_upper));
  SL_TRY(read_child(*safety, "k_position", not_negative, limits.k_position));
  SL_TRY(read_child(*safety, "k_velocity", not_negative, limits.k_velocity));
  if (limits.k_position > 0 && limits.soft_lower > limits.soft_upper)
    return safety->error("the soft limits of joint '" + out.name + "', " + number_text(limits.soft_lower) +
                             " and " + number_text(limits.soft_upper) + ", leave no room",
                         "the lower one must be below the upper one");
  out.safety = limits;
  return {};
}

}  // namespace sandlot::formats
