#include "validation/robot.h"

#include <fmt/format.h>

#include "base/math.h"
#include "messages/command.h"
#include "messages/messages.h"
#include "sim/load/load.h"

namespace sandlot::validation {

Result<Robot> Robot::start(const Trial& trial) {
  Robot robot;
  robot.level = trial.level;
  robot.tick_ms = 10 * 1000 % trial.step_us == 0 ? 10 : 12;
  const std::string text = fmt::format(
      "version: 1\nphysics: {}\ntime: {{step: {} ms, substeps: {}}}\n{}robots:\n  - name: robot\n    model: "
      "{}\n"
      "    devices:\n      drive: {{level: {}{}{}, rate: 0}}\n",
      trial.engine, robot.tick_ms, robot.tick_ms * 1000 / trial.step_us, trial.world, trial.model,
      trial.level, trial.drive.empty() ? "" : ", ", trial.drive);
  Diagnostics diagnostics;
  SL_ASSIGN(model::Setup setup, load("validation.yaml", {.text = text}, diagnostics));
  SL_ASSIGN(robot.sim, Simulation::create(std::move(setup), {}, diagnostics));
  robot.id = *robot.sim->find_instance("robot");
  for (int i = 0; i < 50; ++i) SL_TRY(robot.sim->tick());
  return robot;
}

void Robot::command(Twist velocity) {
  msg::Twist message;
  message.linear = {velocity.vx_mps, velocity.vy_mps, 0};
  message.angular = {0, 0, velocity.wz_radps};
  sim->submit(CommandRequest{"robot/drive", msg::Twist::ros_type, command_bytes(message)});
}

void Robot::switch_level(const std::string& to) {
  sim->submit(LevelRequest{"robot/drive", {to}});
  level = to;
}

void Robot::tick() {
  const Status done = sim->tick();
  SL_CHECK_MSG(done, done ? "" : done.error().text().c_str());
}

Twist Robot::velocity() const {
  const BodyState& base = sim->engine().states()[sim->engine().bodies(id)[0].index];
  const Vec3 v = rotate_inverse(base.X_WB.q, base.V_WB.linear);
  return {v.x, v.y, base.V_WB.angular.z};
}

Twist between(const Pose& from, const Pose& to, double turned_rad, double time_s) {
  const Vec3 moved = rotate_inverse(from.q, to.p - from.p);
  // p = V(a) v T with V = [sin a, -(1 - cos a); 1 - cos a, sin a] / a.
  const double a = turned_rad;
  if (std::abs(a) < 1e-9) return {moved.x / time_s, moved.y / time_s, a / time_s};
  const double s = math::sin(a) / a, c = (1 - math::cos(a)) / a, det = s * s + c * c;
  return {(s * moved.x + c * moved.y) / det / time_s, (-c * moved.x + s * moved.y) / det / time_s,
          a / time_s};
}

}  // namespace sandlot::validation
