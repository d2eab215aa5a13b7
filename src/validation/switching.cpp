#include <fmt/format.h>

#include <algorithm>

#include "messages/messages.h"
#include "validation/robot.h"
#include "validation/world.h"

namespace sandlot::validation {
namespace {

Pose odometry_of(const Robot& robot) {
  const auto* topic = topic_cast<msg::Odometry>(robot.sim->find_topic("/robot/drive/" + robot.level));
  SL_CHECK(topic);
  return topic->message.pose.pose;
}
double length(Twist a) { return math::hypot(a.vx_mps, a.vy_mps); }
Twist operator-(Twist a, Twist b) {
  return {a.vx_mps - b.vx_mps, a.vy_mps - b.vy_mps, a.wz_radps - b.wz_radps};
}

}  // namespace

Section switching() {
  Section s{
      "switching",
      "Levels switched on the way",
      "A Mecanum robot drives an arc of 0.3 m/s and 0.5 rad/s and is switched to another level every second, "
      "with "
      "no new "
      "command. In the tick of the switch (10 ms) it goes on by what its velocity makes of it, so does its "
      "odometry, and its velocity stays: each column is the difference to that. On rollers the velocity "
      "itself "
      "swings by some per cent as they pass (see above), and a switch changes it by as much; between the "
      "others only the centripetal "
      "acceleration of a sub-step, v w h, is left.",
      {},
      {}};
  for (const char* engine : engine_names) {
    const bool rigid = std::string_view(engine) == "rigid";
    auto started = Robot::start({"{builder: mecanum_robot}", engine, rigid ? "rollers" : "ideal", 1000});
    SL_CHECK_MSG(started, started ? "" : started.error().text().c_str());
    Robot& robot = *started;
    robot.command({0.3, 0, 0.5});
    for (int i = 0; i < 100; ++i) robot.tick();
    const std::vector<const char*> order = rigid ? std::vector{"contact", "ideal",   "rollers",
                                                               "ideal",   "contact", "rollers"}
                                                 : std::vector{"contact", "ideal", "contact", "ideal"};
    for (const char* to : order) {
      const std::string what = fmt::format("{} to {}", robot.level, to);
      const std::string where = fmt::format("{}, 1 ms", engine);
      const bool rolls = what.find("rollers") != std::string::npos;
      const Pose pose = robot.pose(), measured = odometry_of(robot);
      const Twist velocity = robot.velocity();
      robot.switch_level(to);
      robot.tick();
      const double dt = robot.tick_s();
      const Twist moved = between(pose, robot.pose(),
                                  math::wrap_angle(yaw_of(robot.pose().q) - yaw_of(pose.q)), dt);
      const Pose measured_now = odometry_of(robot);
      const Twist counted = between(measured, measured_now,
                                    math::wrap_angle(yaw_of(measured_now.q) - yaw_of(measured.q)), dt);
      const Twist jump = robot.velocity() - velocity;
      s.rows.push_back({what + ": jump of place", where, "mm", 1e3 * dt * length(moved - velocity), 0,
                        rolls ? 0.2 : 0.005, false});
      s.rows.push_back({what + ": jump of odometry", where, "mm", 1e3 * dt * length(counted - velocity), 0,
                        rolls ? 0.2 : 0.005, false});
      s.rows.push_back({what + ": jump of speed", where, "m/s", length(jump), 0, rolls ? 0.02 : 2e-4, false});
      s.rows.push_back({what + ": jump of turning", where, "rad/s", std::abs(jump.wz_radps), 0,
                        rolls ? 0.04 : 1e-4, false});
      for (int i = 1; i < 100; ++i) robot.tick();
    }
  }
  return s;
}

}  // namespace sandlot::validation
