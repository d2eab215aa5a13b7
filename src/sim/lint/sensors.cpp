/// Devices that cannot do their work where they are: blinded by their own robot, below the ground, on a joint that cannot
/// move, on a link that hangs on nothing.
#include <algorithm>
#include <cmath>

#include "base/math.h"
#include "messages/messages.h"
#include "sim/lint/rules.h"

namespace sandlot::lint_rules {
namespace {

/// The beams of a range sensor in its frame, thinned out where there are more than a check needs; none for other devices.
struct Beams {
  std::vector<Vec3> directions;
  double max_m = 0;

  void add(double azimuth, double elevation) {
    const math::SinCos a = math::sincos(azimuth), e = math::sincos(elevation);
    directions.push_back({e.cos * a.cos, e.cos * a.sin, e.sin});
  }
};

Beams beams_of(const msg::LaserScan& scan) {
  Beams beams;
  beams.max_m = static_cast<double>(scan.range_max);
  for (std::size_t i = 0; i < scan.ranges.size(); ++i)
    beams.add(static_cast<double>(scan.angle_min) +
                  static_cast<double>(i) * static_cast<double>(scan.angle_increment),
              0);
  return beams;
}

/// The axis of the cone and eight rays along its edge.
Beams beams_of(const msg::Range& cone) {
  Beams beams;
  beams.max_m = static_cast<double>(cone.max_range);
  beams.add(0, 0);
  const double half = 0.5 * static_cast<double>(cone.field_of_view);
  if (!(half > 0)) return beams;
  const math::SinCos edge = math::sincos(half);
  for (int i = 0; i < 8; ++i) {
    const math::SinCos around = math::sincos(math::tau * i / 8);
    beams.directions.push_back({edge.cos, edge.sin * around.cos, edge.sin * around.sin});
  }
  return beams;
}

/// A cloud does not say how it was made; the keys of its sensor do.
Beams beams_of(const model::DeviceDecl& device) {
  const auto between = [&](const char* low, const char* high, int i, int n) {
    const double a = setting(device, low).value_or(0), b = setting(device, high).value_or(0);
    return n > 1 ? a + (b - a) * i / (n - 1) : 0.5 * (a + b);
  };
  const auto number = [&](const char* key, double most) {
    return static_cast<int>(std::clamp(setting(device, key).value_or(0), 0.0, most));
  };
  Beams beams;
  beams.max_m = setting(device, "max_range").value_or(0);
  const int columns = number("columns", 90), planes = number("planes", 16);
  for (int plane = 0; plane < planes; ++plane)
    for (int column = 0; column < columns; ++column)
      beams.add(between("min_angle", "max_angle", column, columns),
                between("min_elevation", "max_elevation", plane, planes));
  return beams;
}

/// What a range sensor sees of its own robot; noise and range limits aside.
void check_own_view(const Simulation& simulation, const Entity& entity, const Simulation::Device& device,
                    const Beams& seen, Findings& findings) {
  const std::vector<Vec3>& directions = seen.directions;
  const std::size_t beams = directions.size();
  if (beams == 0) return;
  const auto bodies = simulation.engine().bodies(entity.id);
  const BodyId carrier = bodies[device.decl.link];
  std::vector<float> distance(beams);
  std::vector<std::uint32_t> hit(beams, no_body);
  const RayJob job{simulation.engine().states()[carrier.index].X_WB * device.decl.X_LS,
                   directions,
                   0,
                   seen.max_m,
                   carrier.index,
                   distance,
                   hit};
  simulation.rays().cast({&job, 1});
  std::vector<std::size_t> hits(bodies.size(), 0);
  std::size_t own = 0;
  double nearest = seen.max_m;
  for (std::size_t i = 0; i < beams; ++i) {
    if (!std::isfinite(distance[i])) continue;
    const auto link = std::find_if(bodies.begin(), bodies.end(), [&](BodyId b) { return b.index == hit[i]; });
    if (link == bodies.end()) continue;
    ++own;
    ++hits[static_cast<std::size_t>(link - bodies.begin())];
    nearest = std::min(nearest, static_cast<double>(distance[i]));
  }
  if (2 * own <= beams) return;
  const auto worst = static_cast<std::size_t>(std::max_element(hits.begin(), hits.end()) - hits.begin());
  const model::Link& link = entity.instance.model->links[worst];
  findings.add("blinded",
               "device '" + device.decl.name + "' sees its own robot with " + std::to_string(own) + " of " +
                   std::to_string(beams) + " beams, mostly link '" + link.name + "'" + at(link.place) +
                   " from " + length_text(nearest) + " on",
               "move the sensor out of the robot, or put it on that link", device.decl.place);
}

/// A sensor behind the surface of an endless floor looks at nothing but its underside.
void check_below_floor(const Simulation& simulation, const Entity& entity, const Simulation::Device& device,
                       Findings& findings) {
  const BodyId carrier = simulation.engine().bodies(entity.id)[device.decl.link];
  const Vec3 p = (simulation.engine().states()[carrier.index].X_WB * device.decl.X_LS).p;
  for (const model::Instance* instance : simulation.instances()) {
    if (!instance->model->is_static) continue;
    for (const model::Link& link : instance->model->links)
      for (const model::Collision& collision : link.collisions) {
        const auto* plane = std::get_if<Plane>(&collision.shape);
        if (!plane) continue;
        const Pose X_WG = instance->X_WM * link.X_ML * collision.X_LC;
        const double above = dot(rotate(X_WG.q, plane->normal), p - X_WG.p);
        if (above < -1e-3)
          findings.add("below_ground",
                       "device '" + device.decl.name + "' sits " + length_text(-above) + " below '" +
                           instance->original_name + "'" + at(instance->place) + " and sees nothing",
                       "raise it, or its robot", device.decl.place);
      }
  }
}

void check_joints(const model::DeviceDecl& device, const model::Model& model, Findings& findings) {
  for (const std::uint32_t index : joints_of(device, model)) {
    const model::Joint& joint = model.joints[index];
    const bool limited = joint.type == model::JointType::revolute ||
                         joint.type == model::JointType::prismatic;
    if (limited && joint.lower == joint.upper)
      findings.add("still_joint",
                   "device '" + device.name + "' works on joint '" + joint.name + "'" + at(joint.place) +
                       ", which cannot move: its limits are both " + short_text(joint.lower),
                   "widen <lower> and <upper>", device.place);
  }
}

/// Links that joints connect with the canonical one.
std::vector<char> connected_links(const model::Model& model) {
  std::vector<char> connected(model.links.size(), 0);
  if (!connected.empty()) connected[0] = 1;
  for (bool more = true; more;) {
    more = false;
    for (const model::Joint& joint : model.joints) {
      if (joint.parent == model::world_link || connected[joint.parent] == connected[joint.child]) continue;
      connected[joint.parent] = connected[joint.child] = 1;
      more = true;
    }
  }
  return connected;
}

void check_connected(const Entity& entity, Findings& findings) {
  const model::Model& model = *entity.instance.model;
  if (model.is_static || entity.devices.empty() || model.links.size() < 2) return;
  const std::vector<char> connected = connected_links(model);
  for (const auto& device : entity.devices) {
    if (connected[device->decl.link]) continue;
    const model::Link& link = model.links[device->decl.link];
    const bool jointed = std::any_of(model.joints.begin(), model.joints.end(), [&](const model::Joint& j) {
      return j.child == device->decl.link || j.parent == device->decl.link;
    });
    if (jointed) continue;  // a second robot in the same model is odd, but works
    findings.add("loose_link",
                 "device '" + device->decl.name + "' sits on link '" + link.name + "'" + at(link.place) +
                     ", which no joint holds: it stays behind when '" + model.name + "' moves",
                 "add a fixed joint from '" + model.links[0].name + "' to '" + link.name + "'",
                 device->decl.place);
  }
}

}  // namespace

void check_sensors(const Simulation& simulation, Findings& findings) {
  for (const auto& entity : simulation.entities()) {
    check_connected(*entity, findings);
    for (const auto& device : entity->devices) {
      check_joints(device->decl, *entity->instance.model, findings);
      for (const Simulation::Slot& slot : device->topics) {
        const TopicBase* const topic = slot.topic.get();
        Beams beams;
        if (const auto* scan = topic_cast<msg::LaserScan>(topic)) beams = beams_of(scan->message);
        else if (const auto* cone = topic_cast<msg::Range>(topic)) beams = beams_of(cone->message);
        else if (topic_cast<msg::PointCloud2>(topic)) beams = beams_of(device->decl);
        if (beams.directions.empty() || !(beams.max_m > 0)) continue;
        check_own_view(simulation, *entity, *device, beams, findings);
        check_below_floor(simulation, *entity, *device, findings);
      }
    }
  }
}

}  // namespace sandlot::lint_rules
