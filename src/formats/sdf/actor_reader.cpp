#include <algorithm>

#include "formats/sdf/document.h"
#include "formats/sdf/reading.h"

namespace sandlot::formats {
namespace {

constexpr std::size_t max_waypoints = 1'000'000;

Xml placed_element(const Place& place, const char* name, std::vector<Xml> children) {
  return {name, {}, "", std::move(children), place};
}
Xml text(const Place& place, const char* name, const char* value) { return {name, {}, value, {}, place}; }

std::vector<const Xml*> waypoints_of(const Xml& actor) {
  std::vector<const Xml*> out;
  if (const Xml* const script = actor.child("script"))
    for (const Xml& trajectory : script->children)
      if (trajectory.name == "trajectory")
        for (const Xml& waypoint : trajectory.children)
          if (waypoint.name == "waypoint") out.push_back(&waypoint);
  return out;
}

/// Skins of people have their origin in the hips or between the feet; the height of the path tells which.
bool walks_on_hips(const Xml& actor) {
  double height_m = 0;
  if (const Xml* const pose = actor.child("pose"))
    if (const auto X = read_sdf_pose(*pose)) height_m = X->p.z;
  const std::vector<const Xml*> waypoints = waypoints_of(actor);
  const Xml* const first = waypoints.empty() ? nullptr : waypoints.front()->child("pose");
  if (first)
    if (const auto X = read_sdf_pose(*first)) height_m += X->p.z;
  return height_m > 0.5;
}

}  // namespace

void stand_in_for_actor(Xml& actor) {
  actor.name = "model";
  actor.set_attribute("sandlot:actor", "true");
  if (actor.child("link")) return;
  const Place& at = actor.place;
  const auto part = [&](const char* name) {
    Xml out = placed_element(at, name, {});
    out.attributes = {{"name", "body"}};
    out.children.push_back(text(at, "pose", walks_on_hips(actor) ? "0 0 -0.1 0 0 0" : "0 0 0.9 0 0 0"));
    out.children.push_back(placed_element(
        at, "geometry",
        {placed_element(at, "capsule", {text(at, "radius", "0.25"), text(at, "length", "1.3")})}));
    return out;
  };
  Xml inertial = placed_element(at, "inertial", {});
  inertial.attributes = {{"auto", "true"}};
  Xml link = placed_element(at, "link", {std::move(inertial), part("collision"), part("visual")});
  link.attributes = {{"name", "person"}};
  actor.children.push_back(std::move(link));
}

Result<model::Motion> read_motion(const Xml& element, const Pose& X_WA, const Reading& in) {
  model::Motion out;
  const Xml* const script = element.child("script");
  bool starts = true;
  if (script) {
    in.notes.unused(*script, "loop delay_start auto_start trajectory*");
    SL_TRY(read_child(*script, "loop", out.loop));
    SL_TRY(read_child(*script, "delay_start", {0, 1e9}, out.delay_s));
    SL_TRY(read_child(*script, "auto_start", starts));
  }
  const std::vector<const Xml*> waypoints = waypoints_of(element);
  if (waypoints.size() > max_waypoints) return script->error("this script has more than 1000000 waypoints");
  for (const Xml* const waypoint : waypoints) {
    in.notes.unused(*waypoint, "time pose");
    const Xml* const time = waypoint->child("time");
    if (!time) return waypoint->error("<waypoint> has no <time>", "write <time>1</time>, in seconds");
    SL_ASSIGN(const double time_s, read_double(*time, {0, 1e9}));
    SL_ASSIGN(const Pose X_AM, read_child_pose(*waypoint));
    if (!out.keys.empty() && !(time_s > out.keys.back().time_s))
      return time->error("the times of waypoints must grow", "this one is not after the one before");
    // The script is relative to the actor, as in Gazebo Sim.
    out.keys.push_back({time_s, X_WA * X_AM});
  }
  if (out.keys.empty() || out.keys.front().time_s > 0) out.keys.insert(out.keys.begin(), {0, X_WA});
  if (!starts) out.keys.resize(1);
  return out;
}

}  // namespace sandlot::formats
