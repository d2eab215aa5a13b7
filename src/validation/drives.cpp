#include <fmt/format.h>

#include <limits>
#include <map>

#include "validation/robot.h"
#include "validation/world.h"

namespace sandlot::validation {
namespace {

struct Manoeuvre {
  const char* name;
  Twist command;
};

struct Vehicle {
  const char* name;     ///< as in the page
  const char* builder;  ///< with its parameters, in YAML
  std::vector<const char*> levels;
  std::vector<Manoeuvre> manoeuvres;
  double half_width_m = 0;        ///< of wheels with two edges; 0: they touch in a point
  std::vector<Vec3> wheels = {};  ///< of those, in the base
  double skid_radius_m = 0;       ///< of wheels that turn it by skidding
  int mecanum_rollers = 0;        ///< per wheel
};

/// Motion that friction makes of the wheels' present angles and speeds, where it decides; else nothing.
std::optional<Twist> by_friction(const Vehicle& vehicle, const Robot& robot, bool edges) {
  std::vector<Patch> patches;
  for (std::size_t k = 0; k < vehicle.wheels.size(); ++k) {
    const Vec3& at = vehicle.wheels[k];
    if (vehicle.skid_radius_m > 0 && robot.level == "contact") {
      add_wheel(patches, at.x, at.y, edges ? vehicle.half_width_m : 0,
                vehicle.skid_radius_m * robot.joint(k).velocity);
    } else if (vehicle.mecanum_rollers > 0 && robot.level == "rollers") {
      const double r = 0.1, thin = 0.4 * r * math::sin(math::pi / vehicle.mecanum_rollers);
      add_mecanum_wheel(patches, at.x, at.y, r, thin, vehicle.mecanum_rollers,
                        at.x * at.y > 0 ? -math::pi / 4 : math::pi / 4, robot.joint(k).position,
                        robot.joint(k).velocity);
    }
  }
  if (patches.empty()) return {};
  // The wheels' friction is 1, so that the centrifugal force is w v / g of what it can hold.
  const Twist slow = least_dissipation(patches);
  return least_dissipation(patches,
                           {slow.wz_radps * slow.vy_mps / g_mps2, -slow.wz_radps * slow.vx_mps / g_mps2});
}

/// Turn of a robot on wheels with two edges. A wheel's middle cannot roll: the edges run at other speeds than
/// the rim. Of all motions the one comes about that loses least to friction, here: the outer edge of the
/// wheel farthest from the centre of rotation rolls. Two wheels on one axle do not fix that centre: then it
/// is the one that changes, and the speed is met.
Twist with_edges(const Vehicle& vehicle, Twist command) {
  if (vehicle.half_width_m == 0 || vehicle.skid_radius_m > 0 || command.wz_radps == 0) return command;
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
       0.006,
       {{0, 0.18, 0}, {0, -0.18, 0}}},
      {"skid, four wheels",
       "{builder: skid_robot}",
       {"ideal", "contact"},
       {straight, arc, spin},
       0.03,
       {{0.17, 0.22, 0}, {0.17, -0.22, 0}, {-0.17, 0.22, 0}, {-0.17, -0.22, 0}},
       0.1},
      {"tracks",
       "{builder: tracked_robot}",
       {"ideal", "contact"},
       {straight, arc, spin},
       0.035,
       {{0.23, 0.21, 0},
        {0.23 / 3, 0.21, 0},
        {-0.23 / 3, 0.21, 0},
        {-0.23, 0.21, 0},
        {0.23, -0.21, 0},
        {0.23 / 3, -0.21, 0},
        {-0.23 / 3, -0.21, 0},
        {-0.23, -0.21, 0}},
       0.07},
      {"Ackermann",
       "{builder: ackermann_robot}",
       {"ideal", "contact"},
       {straight, wide_arc},
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
      {"Mecanum",
       "{builder: mecanum_robot}",
       {"ideal", "contact", "rollers"},
       {straight, side, arc, spin},
       0,
       {{0.2, 0.23, 0}, {0.2, -0.23, 0}, {-0.2, 0.23, 0}, {-0.2, -0.23, 0}},
       0,
       10},
      {"four-wheel drive and steer",
       "{builder: swerve_robot}",
       {"ideal", "contact"},
       {straight, side, arc, spin},
       0.01875,
       {{0.21, 0.21, 0}, {0.21, -0.21, 0}, {-0.21, 0.21, 0}, {-0.21, -0.21, 0}}},
  };
  return all;
}

struct Measured {
  Twist moved;                       ///< mean from the second to the fourth second after the command
  std::optional<Twist> by_friction;  ///< mean over the same time
};

Measured measure(const Vehicle& vehicle, const char* engine, const char* level, Twist command, int step_us) {
  auto started = Robot::start({vehicle.builder, engine, level, step_us});
  SL_CHECK_MSG(started, started ? "" : started.error().text().c_str());
  Robot& robot = *started;
  const int ticks = static_cast<int>(2 / robot.tick_s());
  robot.command(command);
  for (int i = 0; i < ticks; ++i) robot.tick();
  const Pose begin = robot.pose();
  double turned_rad = 0, yaw = yaw_of(begin.q);
  std::optional<Twist> mean;
  for (int i = 0; i < ticks; ++i) {
    robot.tick();
    const double now = yaw_of(robot.pose().q);
    turned_rad += math::wrap_angle(now - yaw);
    yaw = now;
    if (const auto v = by_friction(vehicle, robot, std::string_view(engine) == "rigid")) {
      if (!mean) mean = Twist{};
      mean->vx_mps += v->vx_mps / ticks, mean->vy_mps += v->vy_mps / ticks,
          mean->wz_radps += v->wz_radps / ticks;
    }
  }
  return {between(begin, robot.pose(), turned_rad, ticks * robot.tick_s()), mean};
}

/// Theory's prediction for a manoeuvre, and the bound for engines.
struct Theory {
  Twist twist;
  double bound;
};
Theory theory(const Vehicle& vehicle, std::string_view engine, std::string_view level, Twist command,
              const Measured& measured) {
  if (measured.by_friction)
    return {*measured.by_friction,
            vehicle.mecanum_rollers > 0 && command.vx_mps != 0 && command.wz_radps != 0 ? 0.01 : 0.005};
  // Only the rigid engine knows that a wheel has two edges; in the plane it is as wide as a line.
  if (level == "contact" && engine == "rigid") return {with_edges(vehicle, command), 0.005};
  return {command, level == "ideal" ? 1e-3 : 0.005};
}

double along(Twist measured, Twist wanted) {
  const double speed = std::sqrt(wanted.vx_mps * wanted.vx_mps + wanted.vy_mps * wanted.vy_mps);
  return (measured.vx_mps * wanted.vx_mps + measured.vy_mps * wanted.vy_mps) / speed;
}
bool goes(Twist t) { return t.vx_mps != 0 || t.vy_mps != 0; }

/// Errors in per cent, of speed and turning; NaN where the manoeuvre has none.
struct Errors {
  double speed = std::numeric_limits<double>::quiet_NaN(), turning = speed;
};
Errors errors(const Manoeuvre& m, const Measured& measured, Twist wanted) {
  Errors e;
  if (goes(m.command)) e.speed = 100 * (along(measured.moved, wanted) / along(wanted, wanted) - 1);
  if (m.command.wz_radps != 0) e.turning = 100 * (measured.moved.wz_radps / wanted.wz_radps - 1);
  return e;
}
std::string text(Errors e) {
  const auto number = [](double x) { return std::abs(x) < 0.005 ? "0" : fmt::format("{:+.2f}", x); };
  if (std::isnan(e.turning)) return number(e.speed);
  return std::isnan(e.speed) ? number(e.turning) : number(e.speed) + " / " + number(e.turning);
}

}  // namespace

Section drives() {
  Section s{
      "drives",
      "Drives",
      "Each drive at each of its levels on each engine is given a velocity; two seconds later the mean "
      "velocity over two seconds is measured from the true poses, as the constant twist that leads "
      "from the first pose to the last.\n\n"
      "What theory says is the command; of wheels with two edges what is left of it when the outer edge "
      "rolls; and where friction decides (skid and track drives at `contact`, Mecanum at `rollers`) the "
      "motion that dissipates least, given the angles and speeds that the wheels have in the run "
      "(validation/quasistatic.h). A Mecanum wheel's roller past the bottom is not the one that the closed "
      "form thinks of: its axis on the ground is turned, so that n rollers go sideways by sin(pi/n) / "
      "(pi/n) of the command, and it touches beside the wheel's middle, so that wheels contradict each "
      "other in a turn and the one with the longer arm wins. Friction counts as dry and loads as equal: what "
      "the load moves "
      "outwards in a curve is left out, which at times decides for another wheel of a Mecanum robot on an "
      "arc.",
      {},
      {}};
  Table table{"Errors of speed / turning [%] against theory by the length of the physics step",
              {"drive", "level", "engine", "step", "straight", "side", "arc", "spin"},
              {}};
  std::map<std::string_view, double> of_ideal;  // largest error, by engine
  for (const Vehicle& vehicle : vehicles())
    for (const char* level : vehicle.levels)
      for (const char* engine : engine_names) {
        const bool on_rollers = std::string_view(level) == "rollers";
        if (on_rollers && std::string_view(engine) == "planar") continue;
        for (const int step_us : {1000, 2000, 4000}) {
          std::map<std::string_view, std::string> cells;
          double& largest = of_ideal[engine];
          for (const Manoeuvre& m : vehicle.manoeuvres) {
            const Measured measured = measure(vehicle, engine, level, m.command, step_us);
            const auto [wanted, bound] = theory(vehicle, engine, level, m.command, measured);
            const Errors e = errors(m, measured, wanted);
            cells[m.name] = text(e);
            if (std::string_view(level) == "ideal")
              for (const double x : {e.speed, e.turning})
                if (std::abs(x) > largest) largest = std::abs(x);
            // Those of the steps that a user would choose.
            if (step_us != (on_rollers ? 1000 : 2000)) continue;
            const std::string what = fmt::format("{}, {}, {}", vehicle.name, level, m.name);
            const std::string where = fmt::format("{}, {} ms", engine, step_us / 1000);
            if (goes(m.command))
              s.rows.push_back({what + ": speed", where, "m/s", along(measured.moved, wanted),
                                along(wanted, wanted), bound});
            if (m.command.wz_radps != 0)
              s.rows.push_back(
                  {what + ": turning", where, "rad/s", measured.moved.wz_radps, wanted.wz_radps, bound});
            if (m.command.wz_radps != 0 && measured.by_friction) {
              s.rows.push_back({what + ": centre of rotation, to the left", where, "m",
                                measured.moved.vx_mps / measured.moved.wz_radps,
                                wanted.vx_mps / wanted.wz_radps, vehicle.mecanum_rollers > 0 ? 0.015 : 0.001,
                                false});
              s.rows.push_back({what + ": centre of rotation, ahead", where, "m",
                                -measured.moved.vy_mps / measured.moved.wz_radps,
                                -wanted.vy_mps / wanted.wz_radps, vehicle.mecanum_rollers > 0 ? 0.015 : 0.001,
                                false});
            }
          }
          if (std::string_view(level) == "ideal") continue;
          table.rows.push_back({vehicle.name, level, engine, fmt::format("{} ms", step_us / 1000),
                                cells["straight"], cells["side"], cells["arc"], cells["spin"]});
        }
      }
  for (const char* engine : engine_names) {
    const std::string most = fmt::format("up to {:.1g}", of_ideal[engine]);
    table.rows.push_back({"all", "ideal", engine, "1, 2, 4 ms", most, most, most, most});
  }
  s.tables.push_back(std::move(table));
  return s;
}

}  // namespace sandlot::validation
