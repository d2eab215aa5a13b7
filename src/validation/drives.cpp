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
  bool skids =
      false;  ///< turns by slip: its turning rate on level contact is checked in a section of its own
};

const std::vector<Vehicle>& vehicles() {
  static const Manoeuvre straight{"straight", {0.4, 0, 0}}, side{"side", {0, 0.3, 0}},
      arc{"arc", {0.3, 0, 0.5}}, spin{"spin", {0, 0, 0.8}};
  static const std::vector<Vehicle> all = {
      {"differential", "{builder: diff_robot}", {"ideal", "contact"}, {straight, arc, spin}},
      {"skid, four wheels", "{builder: skid_robot}", {"ideal", "contact"}, {straight, arc, spin}, true},
      {"tracks", "{builder: tracked_robot}", {"ideal", "contact"}, {straight, arc, spin}, true},
      {"Ackermann", "{builder: ackermann_robot}", {"ideal", "contact"}, {straight, arc}},
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
       {straight, side, arc, spin}},
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

double yaw_of(const Quat& q) {
  return math::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z));
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
          SL_CHECK_MSG(moved.has_value(), moved.error().what);
          const std::string what = fmt::format("{}, {}, {}", vehicle.name, level, m.name);
          const std::string where = fmt::format("{}, {}", engine,
                                                std::string_view(level) == "rollers" ? "1 ms" : "2 ms");
          const bool slips = vehicle.skids && std::string_view(level) == "contact";
          const double bound = std::string_view(level) == "ideal" ? 1e-3 : 0.01;
          const double wanted = std::sqrt(m.command.vx_mps * m.command.vx_mps +
                                          m.command.vy_mps * m.command.vy_mps);
          if (wanted > 0) {
            const double along = (moved->vx_mps * m.command.vx_mps + moved->vy_mps * m.command.vy_mps) /
                                 wanted;
            s.rows.push_back({what + ": speed", where, "m/s", along, wanted, slips ? 0.05 : bound});
          }
          if (m.command.wz_radps != 0 && !slips)
            s.rows.push_back(
                {what + ": turning", where, "rad/s", moved->wz_radps, m.command.wz_radps, bound});
        }
      }
  return s;
}

}  // namespace sandlot::validation
