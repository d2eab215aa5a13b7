#include <algorithm>

#include "api.h"

namespace robios {
namespace {

struct Name {
  DeviceSemantics number;
  const char* text;
};
constexpr Name names[] = {
    {MOTOR_RIGHT, "RIGHT"},
    {MOTOR_LEFT, "LEFT"},
    {MOTOR_FRONT, "FRONT"},
    {MOTOR_BACK, "BACK"},
    {MOTOR_FRONTLEFT, "FRONTLEFT"},
    {MOTOR_FRONTRIGHT, "FRONTRIGHT"},
    {MOTOR_BACKLEFT, "BACKLEFT"},
    {MOTOR_BACKRIGHT, "BACKRIGHT"},
    {PSD_FRONT, "FRONT"},
    {PSD_FRONTLEFT, "FRONTLEFT"},
    {PSD_FRONTRIGHT, "FRONTRIGHT"},
    {PSD_FL, "FL"},
    {PSD_FR, "FR"},
    {PSD_LEFT, "LEFT"},
    {PSD_RIGHT, "RIGHT"},
    {PSD_BACK, "BACK"},
    {PSD_BACKLEFT, "BACKLEFT"},
    {PSD_BACKRIGHT, "BACKRIGHT"},
    {PSD_BL, "BL"},
    {PSD_BR, "BR"},
    {PSD_DOWN, "DOWN"},
    {IR_LM, "LM"},
    {IR_LF, "LF"},
    {IR_RM, "RM"},
    {IR_RF, "RF"},
    {IR_LB, "LB"},
    {IR_RB, "RB"},
    {BUMP_RIGHT, "RIGHT"},
    {BUMP_LEFT, "LEFT"},
    {BUMP_FRONT, "FRONT"},
    {BUMP_BACK, "BACK"},
    {BUMP_FRONTLEFT, "FRONTLEFT"},
    {BUMP_FRONTRIGHT, "FRONTRIGHT"},
};

/// The longer form of FL and the like, and back.
std::string other_form(const std::string& name) {
  constexpr const char* forms[][2] = {
      {"FL", "FRONTLEFT"}, {"FR", "FRONTRIGHT"}, {"BL", "BACKLEFT"}, {"BR", "BACKRIGHT"}};
  for (const auto& form : forms) {
    if (name == form[0]) return form[1];
    if (name == form[1]) return form[0];
  }
  return name;
}

int find(const char (*given)[name_size], std::size_t count, const char* prefix, DeviceSemantics semantics) {
  const std::string name = device_name(semantics);
  if (name.empty()) return -1;
  for (const std::string& form : {name, other_form(name)}) {
    for (const std::string& text : {prefix + form, form}) {
      const int index = index_of(given, count, text);
      if (index >= 0) return index;
    }
  }
  return -1;
}

}  // namespace

std::string device_name(DeviceSemantics semantics) {
  if (semantics <= QUAD_RIGHT && semantics >= QUAD_BACKRIGHT) semantics += MOTOR_RIGHT - QUAD_RIGHT;
  if (semantics <= SERVO1 && semantics >= SERVO14) return std::to_string(SERVO1 - semantics + 1);
  if (semantics <= PSD1 && semantics >= PSD8) return std::to_string(PSD1 - semantics + 1);
  for (const Name& name : names) {
    if (name.number == semantics) return name.text;
  }
  return "";
}

int find_distance(DeviceSemantics semantics) {
  const Robot& r = machine.robot();
  const int by_number = distance_index(semantics);
  if (by_number >= 0) return by_number;
  const int count = static_cast<int>(std::min<std::size_t>(r.distances, most_distances));
  const int by_name = find(r.distance_names, static_cast<std::size_t>(count), "PSD", semantics);
  if (by_name >= 0) return by_name;
  // A robot of RoBIOS-7 numbers its sensors: front, left, right, back.
  switch (semantics) {
    case PSD_FRONT: return distance_index(1);
    case PSD_LEFT: return distance_index(2);
    case PSD_RIGHT: return distance_index(3);
    case PSD_BACK: return distance_index(4);
    default: return semantics <= PSD1 && semantics >= PSD8 ? distance_index(PSD1 - semantics + 1) : -1;
  }
}

int find_motor(DeviceSemantics semantics) {
  const Robot& r = machine.robot();
  const std::size_t count = std::min<std::size_t>(r.motors, most_motors);
  const int by_name = find(r.motor_names, count, "MOTOR", semantics);
  if (by_name >= 0) return by_name;
  // Names that say nothing: in the order of the drive, left before right, front before back.
  const int last = static_cast<int>(count);
  const auto in_order = [&](int index) { return index < last ? index : -1; };
  if (semantics <= QUAD_RIGHT && semantics >= QUAD_BACKRIGHT) semantics += MOTOR_RIGHT - QUAD_RIGHT;
  switch (semantics) {
    case MOTOR_LEFT: return in_order(0);
    case MOTOR_RIGHT: return in_order(1);
    case MOTOR_FRONTLEFT: return count == 4 ? 0 : -1;
    case MOTOR_FRONTRIGHT: return count == 4 ? 1 : -1;
    case MOTOR_BACKLEFT: return count == 4 ? 2 : -1;
    case MOTOR_BACKRIGHT: return count == 4 ? 3 : -1;
    default: return -1;
  }
}

int find_servo(DeviceSemantics semantics) {
  const Robot& r = machine.robot();
  if (semantics > SERVO1 || semantics < SERVO14) return -1;
  const std::size_t count = std::min<std::size_t>(r.servos, most_servos);
  const int by_name = find(r.servo_names, count, "SERVO", semantics);
  if (by_name >= 0) return by_name;
  const int index = SERVO1 - semantics;
  return index < static_cast<int>(count) ? index : -1;
}

int find_bumper(DeviceSemantics semantics) {
  const Robot& r = machine.robot();
  const std::size_t count = std::min<std::size_t>(r.bumpers, most_bumpers);
  const bool infrared = semantics <= IR_LM && semantics > BUMP_RIGHT;
  return find(r.bumper_names, count, infrared ? "IR" : "BUMP", semantics);
}

}  // namespace robios
