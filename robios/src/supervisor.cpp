#include <cmath>

#include "functions.h"

/// SIM... calls, the same in both generations.
namespace robios {
namespace {

double metres(int mm) { return mm * 1e-3; }

void get(int id, bool robot, int* x, int* y, int* z, int* phi) {
  const EntityPose* const e = entity(id, robot);
  if (!e)
    note_once(
        "pose",
        "a SIM... call asked for a robot or object that is not there, or the robot is not a supervisor");
  set(x, e ? to_int(e->x_m * 1e3) : 0);
  set(y, e ? to_int(e->y_m * 1e3) : 0);
  set(z, e ? to_int(e->z_m * 1e3) : 0);
  set(phi, e ? degrees(e->phi_rad) : 0);
}

void put(int id, bool robot, int x, int y, int z, int phi) {
  if (robot && id == 0) id = static_cast<int>(machine.robot().id);
  if (!machine.robot().supervisor || !entity(id, robot)) {
    note_once(
        "move",
        "a SIM... call would move a robot or object that is not there, or the robot is not a supervisor");
    return;
  }
  order(OrderKind::set_entity, EntityPose{static_cast<std::uint32_t>(id), robot ? 1u : 0u, metres(x),
                                          metres(y), metres(z), phi * radians_per_degree});
}

}  // namespace
}  // namespace robios

using namespace robios;

extern "C" {

void SIMGetRobot(int id, int* x, int* y, int* z, int* phi) {
  enter(Call::SIMGetRobot);
  get(id, true, x, y, z, phi);
}
void SIMSetRobot(int id, int x, int y, int z, int phi) {
  enter(Call::SIMSetRobot);
  put(id, true, x, y, z, phi);
}
void SIMGetObject(int id, int* x, int* y, int* z, int* phi) {
  enter(Call::SIMGetObject);
  get(id, false, x, y, z, phi);
}
void SIMSetObject(int id, int x, int y, int z, int phi) {
  enter(Call::SIMSetObject);
  put(id, false, x, y, z, phi);
}
int SIMGetRobotCount() {
  enter(Call::SIMGetRobotCount);
  return entities(true);
}
int SIMGetObjectCount() {
  enter(Call::SIMGetObjectCount);
  return entities(false);
}
int SIMGetVirtualTime() {
  enter(Call::SIMGetVirtualTime);
  return static_cast<int>(machine.clock_ns / millisecond);
}
int SIMGetSimulationTime() {
  enter(Call::SIMGetSimulationTime);
  return static_cast<int>(machine.senses().now_ns / millisecond);
}
int SIMGetRealTime() {
  enter(Call::SIMGetRealTime);
  return static_cast<int>(machine.senses().wall_ns / millisecond);
}

}  // extern "C"
