#include <fmt/format.h>

#include "base/bytes.h"
#include "messages/messages.h"
#include "sim/load.h"
#include "sim/simulation.h"
#include "validation/world.h"

namespace sandlot::validation {
namespace {

/// Velocity in the robot's own plane.
struct Twist {
  double vx_mps = 0, vy_mps = 0, wz_radps = 0;
};

struct Manoeuvre {
  const char* name;
  Twist command;
};

struct Vehicle {
  const char* name;     ///< as the page says it
  const char* builder;  ///< with its parameters, in YAML
  std::vector<const char*> levels;
  std::vector<Manoeuvre> manoeuvres;
  bool skids = false;             ///< turns by slip: how far a command is met depends on the ground
  double half_width_m = 0;        ///< of wheels with two edges; 0: they touch in a point
  std::vector<Vec3> wheels = {};  ///< of those, in the base
};

/// What a wheel with two edges makes of a turn. Its middle cannot roll: the edges run at other speeds than the rim. Of all
/// motions the one comes about that loses least to friction, here: the outer edge of the wheel farthest from the centre of
/// rotation rolls. Two wheels on one axle do not fix that centre: then it is the one that changes, and the speed is met.
Twist with_edges(const Vehicle& vehicle, Twist command) {
  if (vehicle.half_width_m == 0 || command.wz_radps == 0) return command;
  const double radius_m = command.vx_mps / command.wz_radps;
  if (vehicle.wheels.size() == 2) {
    const double arm_m = std::abs(vehicle.wheels[0].y);
    return {command.vx_mps, 0, command.wz_radps * arm_m / (arm_m + vehicle.half_width_m)};
  }
  double share = 0;
  for (const Vec3& wheel : vehicle.wheels) {
    const double arm_m = norm(Vec3{wheel.x, wheel.y - radius_m, 0});
    share = std::max(share, arm_m / (arm_m + vehicle.half_width_m));
  }
  return {share * command.vx_mps, share * command.vy_mps, share * command.wz_radps};
}

const std::vector<Vehicle>& vehicles() {
  static const Manoeuvre straight{"straight", {0.4, 0, 0}}, side{"side", {0, 0.3, 0}},
      arc{"arc", {0.3, 0, 0.5}}, wide_arc{"arc", {0.4, 0, 0.3}}, spin{"spin", {0, 0, 0.8}};
  static const std::vector<Vehicle> all = {
      {"differential",
       "{builder: diff_robot}",
       {"ideal", "contact"},
       {straight, arc, spin},
       false,
       0.006,
       {{0, 0.18, 0}, {0, -0.18, 0}}},
      {"skid, four wheels", "{builder: skid_robot}", {"ideal", "contact"}, {straight, arc, spin}, true},
      {"tracks", "{builder: tracked_robot}", {"ideal", "contact"}, {straight, arc, spin}, true},
      {"Ackermann",
       "{builder: ackermann_robot}",
       {"ideal", "contact"},
       {straight, wide_arc},
       false,
       0.0225,
       {{0, 0.2, 0}, {0, -0.2, 0}, {0.56, 0.2, 0}, {0.56, -0.2, 0}}},
      {"omni, 3 wheels",
       "{builder: omni_robot, wheels: 3}",
       {"ideal", "contact", "rollers"},
       {straight, side, arc, spin}},
      {"omni, 4 wheels",
       "{builder: omni_robot, wheels: 4}",
       {"ideal", "contact", "rollers"},
       {straight, side, arc, spin}},
      {"Mecanum", "{builder: mecanum_robot}", {"ideal", "contact", "rollers"}, {straight, side, arc, spin}},
      {"four-wheel drive and steer",
       "{builder: swerve_robot}",
       {"ideal", "contact"},
       {straight, side, arc, spin},
       false,
       0.01875,
       {{0.21, 0.21, 0}, {0.21, -0.21, 0}, {-0.21, 0.21, 0}, {-0.21, -0.21, 0}}},
  };
  return all;
}

Result<std::unique_ptr<Simulation>> start(const Vehicle& vehicle, const char* engine, const char* level) {
  // 1 ms with rollers, 2 ms without: facts that a user would choose by, too.
  const std::string text = fmt::format(
      "version: 1\nphysics: {}\ntime: {{step: 10 ms, substeps: {}}}\nrobots:\n  - name: robot\n    model: "
      "{}\n    devices:\n"
      "      drive: {{level: {}}}\n",
      engine, std::string_view(level) == "rollers" ? 10 : 5, vehicle.builder, level);
  Diagnostics diagnostics;
  SL_ASSIGN(model::Setup setup, load("validation.yaml", {.text = text}, diagnostics));
  return Simulation::create(std::move(setup), {}, diagnostics);
}

/// The constant twist that leads from one pose to the other, in the first one's frame.
Twist between(const Pose& from, const Pose& to, double turned_rad, double time_s) {
  const Vec3 moved = rotate_inverse(from.q, to.p - from.p);
  // p = V(a) v T with V = [sin a, -(1 - cos a); 1 - cos a, sin a] / a.
  const double a = turned_rad;
  if (std::abs(a) < 1e-9) return {moved.x / time_s, moved.y / time_s, a / time_s};
  const double s = math::sin(a) / a, c = (1 - math::cos(a)) / a, det = s * s + c * c;
  return {(s * moved.x + c * moved.y) / det / time_s, (-c * moved.x + s * moved.y) / det / time_s,
          a / time_s};
}

/// Mean velocity from the second to the fourth second after the command.
Result<Twist> measure(const Vehicle& vehicle, const char* engine, const char* level, Twist command) {
  SL_ASSIGN(const std::unique_ptr<Simulation> sim, start(vehicle, engine, level));
  const InstanceId robot = *sim->find_instance("robot");
  for (int i = 0; i < 50; ++i) SL_TRY(sim->tick());  // it settles on its wheels
  msg::Twist message;
  message.linear = {command.vx_mps, command.vy_mps, 0};
  message.angular = {0, 0, command.wz_radps};
  ByteWriter w;
  write(w, message);
  sim->submit(CommandRequest{"robot/drive", msg::Twist::ros_type, {w.bytes().begin(), w.bytes().end()}});
  for (int i = 0; i < 200; ++i) SL_TRY(sim->tick());
  const Pose begin = sim->engine().pose(robot);
  double turned_rad = 0, yaw = yaw_of(begin.q);
  for (int i = 0; i < 200; ++i) {
    SL_TRY(sim->tick());
    const double now = yaw_of(sim->engine().pose(robot).q);
    turned_rad += math::wrap_angle(now - yaw);
    yaw = now;
  }
  return between(begin, sim->engine().pose(robot), turned_rad, 2);
}

}  // namespace

Section drives() {
  Section s{"drives",
            "Drives",
            "Each drive at each of its levels on each engine is told a velocity; two seconds later the mean "
            "velocity over two "
            "seconds is measured from the true poses, as the constant twist that leads from the first pose "
            "to the last.",
            {},
            {}};
  for (const Vehicle& vehicle : vehicles())
    for (const char* level : vehicle.levels)
      for (const char* engine : engine_names) {
        if (std::string_view(level) == "rollers" && std::string_view(engine) == "planar") continue;
        for (const Manoeuvre& m : vehicle.manoeuvres) {
          const auto moved = measure(vehicle, engine, level, m.command);
          SL_CHECK_MSG(moved, moved.error().text().c_str());
          const std::string what = fmt::format("{}, {}, {}", vehicle.name, level, m.name);
          const std::string where = fmt::format("{}, {}", engine,
                                                std::string_view(level) == "rollers" ? "1 ms" : "2 ms");
          const std::string_view at = level;
          const bool slips = vehicle.skids && at == "contact";
          // Only the rigid engine knows that a wheel has two edges; in the plane it is as wide as a line.
          const Twist wanted = at == "contact" && std::string_view(engine) == "rigid"
                                   ? with_edges(vehicle, m.command)
                                   : m.command;
          // Tilted rollers touch beside the wheel's middle plane, by up to a third of a roller: 2.5 % of the arm.
          const double bound = at == "ideal"                                                    ? 1e-3
                               : at == "rollers" && std::string_view(vehicle.name) == "Mecanum" ? 0.025
                                                                                                : 0.005;
          const double speed = std::sqrt(wanted.vx_mps * wanted.vx_mps + wanted.vy_mps * wanted.vy_mps);
          if (speed > 0) {
            const double along = (moved->vx_mps * wanted.vx_mps + moved->vy_mps * wanted.vy_mps) / speed;
            s.rows.push_back({what + ": speed", where, "m/s", along, speed, slips ? 0.05 : bound});
          }
          if (wanted.wz_radps != 0 && !slips)
            s.rows.push_back({what + ": turning", where, "rad/s", moved->wz_radps, wanted.wz_radps, bound});
        }
      }
  return s;
}

}  // namespace sandlot::validation
