#include "programs/robios/robot.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "base/math.h"
#include "base/text.h"
#include "messages/command.h"
#include "messages/sensor_images.h"

namespace sandlot::programs::robios {
namespace {

using namespace sandlot::robios;
using Entry = Description::Entry;

/// The active level's entry of a type, of one device or of the first.
const Entry* find_entry(const std::vector<Entry>& entries, std::string_view type,
                        std::string_view device = "") {
  for (const Entry& each : entries)
    if (!each.program && each.level.empty() && each.type == type && (device.empty() || each.device == device))
      return &each;
  return nullptr;
}

template <class M>
std::optional<std::uint32_t> index_of(const std::vector<Entry>& entries, std::string_view device = "") {
  const Entry* const found = find_entry(entries, M::ros_type, device);
  return found ? std::optional(found->index) : std::nullopt;
}

void set_name(char (&to)[name_size], const std::string& name) {
  std::memset(to, 0, name_size);
  std::memcpy(to, name.data(), std::min(name.size(), name_size - 1));
}

/// Beyond these a limit is none.
constexpr double no_limit = 1e5, usual_mps = 0.5, usual_radps = 2, usual_motor_radps = 10;
double limit_or(double limit, double otherwise) { return limit > 0 && limit < no_limit ? limit : otherwise; }

}  // namespace

const DeviceFacts* RobotDevices::facts_of(const std::string& device) const {
  for (const DeviceFacts& each : facts_)
    if (each.name == device) return &each;
  return nullptr;
}

double RobotDevices::number(const std::string& device, std::initializer_list<const char*> keys,
                            double otherwise) const {
  if (const DeviceFacts* const facts = facts_of(device))
    for (const char* const key : keys)
      if (const auto found = facts->numbers.find(key); found != facts->numbers.end()) return found->second;
  return otherwise;
}

Status RobotDevices::find(const Description& robot, std::vector<DeviceFacts> facts, const Spec& spec) {
  facts_ = std::move(facts);
  servo_range_rad_ = spec.servo_range_rad;
  find_drive(robot, spec);
  find_motors(robot);
  SL_TRY(find_distances(robot, spec));
  lidar_ = index_of<msg::LaserScan>(robot.readings);
  imu_ = index_of<msg::Imu>(robot.readings);
  magnetometer_ = index_of<msg::MagneticField>(robot.readings);
  battery_ = index_of<msg::BatteryState>(robot.readings);
  keys_ = index_of<msg::KeyPresses>(robot.readings);
  sound_ = index_of<msg::Sound>(robot.actuators);
  speaker_ = index_of<msg::SpeakerState>(robot.readings);
  packet_ = index_of<msg::RadioPacket>(robot.actuators);
  reception_ = index_of<msg::RadioReceptionArray>(robot.readings);
  if (const Entry* const screen = find_entry(robot.actuators, msg::ScreenPatch::ros_type)) {
    screen_ = screen->index;
    screen_width_ = static_cast<std::uint32_t>(number(screen->device, {"width"}, 320));
    screen_height_ = static_cast<std::uint32_t>(number(screen->device, {"height"}, 240));
  }
  for (const Entry& each : robot.readings) {
    if (each.program || !each.level.empty()) continue;
    if (each.type == msg::Image::ros_type && !camera_ &&
        !find_entry(robot.actuators, msg::ScreenPatch::ros_type, each.device))
      camera_ = each.index;
    if (each.type == msg::ContactsState::ros_type && bumpers_.size() < most_bumpers)
      bumpers_.push_back({each.index, each.device, 0});
    if (each.type == msg::Int64Stamped::ros_type && encoders_.size() < most_motors) {
      const double ticks = number(each.device, {"ticks_per_turn"}, 0);
      if (ticks < 1) continue;
      encoders_.push_back({each.index, each.device, 0});
      ticks_per_turn_ = static_cast<std::uint32_t>(ticks);
    }
  }
  return {};
}

Status RobotDevices::find_distances(const Description& robot, const Spec& spec) {
  std::vector<std::string> known;
  for (const Entry& each : robot.readings)
    if (!each.program && each.level.empty() && each.type == msg::Range::ros_type)
      known.push_back(each.device);
  const std::vector<std::string>& wanted = spec.distances.empty() ? known : spec.distances;
  for (std::size_t i = 0; i < wanted.size() && distances_.size() < most_distances; ++i) {
    if (wanted[i].empty()) continue;
    // "PSD_LEFT", or with a number of its own "-205=PSD_LEFT".
    std::string name = wanted[i];
    auto number = static_cast<std::int32_t>(i + 1);
    if (const std::size_t equals = name.find('='); equals != std::string::npos) {
      const auto [end, wrong] = std::from_chars(name.data(), name.data() + equals, number);
      if (wrong != std::errc() || end != name.data() + equals)
        return Error{"'" + name + "' has no number", "NAME, or NUMBER=NAME", {}, "/distances"};
      name.erase(0, equals + 1);
    }
    const Entry* const found = find_entry(robot.readings, msg::Range::ros_type, name);
    if (!found)
      return Error{"robot '" + robot.robot + "' has no distance sensor '" + name + "'",
                   suggestion(name, known),
                   {},
                   "/distances"};
    distances_.push_back({found->index, name, number});
  }
  return {};
}

void RobotDevices::find_drive(const Description& robot, const Spec& spec) {
  const Entry* const drive = find_entry(robot.actuators, msg::Twist::ros_type);
  if (!drive) return;
  drive_ = drive->device;
  twist_ = drive->index;
  odometry_ = index_of<msg::Odometry>(robot.readings, drive->device);
  maneuver_ = index_of<msg::DriveManeuver>(robot.actuators, drive->device);
  progress_ = index_of<msg::DriveProgress>(robot.readings, drive->device);
  const DeviceFacts* const facts = facts_of(drive->device);
  const std::string kind = facts ? facts->kind : "";
  drive_kind_ = kind == "ackermann_drive" ? Drive::ackermann
                : kind == "mecanum_drive" || kind == "omni_drive" || kind == "swerve_drive"
                    ? Drive::omni
                    : Drive::differential;
  max_steering_rad_ = number(drive->device, {"max_steering_angle"}, 0.6);
  wheelbase_m_ = number(drive->device, {"wheelbase"}, 0);
  if (kind == "mecanum_drive") wheels_ = index_of<msg::JointState>(robot.actuators, drive->device);
  const double radius_m = number(drive->device, {"wheel_radius"}, 0.025);
  wheel_diameter_m_ = spec.wheel_diameter_m.value_or(2 * radius_m);
  track_m_ = spec.track_m.value_or(number(drive->device, {"wheel_separation", "track"}, 0.1));
  max_speed_mps_ = limit_or(number(drive->device, {"max_linear_speed", "max_speed"}, 0), usual_mps);
  max_turning_rate_radps_ = limit_or(number(drive->device, {"max_angular_speed", "max_turn_rate"}, 0),
                                     usual_radps);
}

void RobotDevices::find_motors(const Description& robot) {
  for (const Entry& each : robot.actuators) {
    if (each.type != msg::Float64::ros_type || !each.level.empty()) continue;
    const DeviceFacts* const facts = facts_of(each.device);
    const bool position = facts && std::find(facts->levels.begin(), facts->levels.end(), "position") !=
                                       facts->levels.end();
    if (position) {
      if (servos_.size() < most_servos) servos_.push_back({each.index, each.device, 1, false});
      continue;
    }
    if (motors_.size() >= most_motors) continue;
    const auto at = [&](const char* level) {
      return facts && std::find(facts->levels.begin(), facts->levels.end(), level) != facts->levels.end();
    };
    Actor motor{each.index, each.device, 1, at("velocity")};
    if (motor.speed) motor.full = limit_or(number(each.device, {"max_velocity"}, 0), usual_motor_radps);
    else if (at("voltage")) motor.full = limit_or(number(each.device, {"supply_voltage"}, 0), 12);
    else motor.full = limit_or(number(each.device, {"max_effort"}, 0), 1);
    motors_.push_back(motor);
  }
}

std::size_t RobotDevices::drive_motors() const {
  if (!motors_.empty()) return 0;
  if (drive_kind_ == Drive::differential) return 2;
  if (drive_kind_ == Drive::ackermann) return 1;
  return wheels_ ? 4 : 0;
}

bool RobotDevices::steers() const { return drive_kind_ == Drive::ackermann && motors_.empty(); }

void RobotDevices::describe(const Spec& spec, const State& state, sandlot::robios::Robot& out) const {
  set_name(out.name, state.number >= 1 && state.number <= state.robots.size() ? state.robots[state.number - 1]
                                                                              : std::string());
  set_name(out.type, "");
  out.id = state.number;
  out.drive = drive_kind_;
  const std::size_t by_drive = drive_motors();
  out.motors = static_cast<std::uint32_t>(by_drive + motors_.size());
  const std::size_t steering = steers() ? 1 : 0;
  out.servos = static_cast<std::uint32_t>(steering + servos_.size());
  out.distances = static_cast<std::uint32_t>(distances_.size());
  out.bumpers = static_cast<std::uint32_t>(bumpers_.size());
  out.ticks_per_turn = ticks_per_turn_;
  out.has_camera = camera_.has_value();
  out.has_lidar = lidar_.has_value();
  out.has_radio = packet_ && reception_;
  out.has_keys = keys_.has_value();
  out.has_screen = screen_.has_value();
  out.has_speaker = sound_.has_value();
  out.has_compass = imu_ || magnetometer_;
  out.has_battery = battery_.has_value();
  out.screen_width = screen_width_;
  out.screen_height = screen_height_;
  out.delays = spec.delays;
  out.supervisor = spec.supervisor;
  out.wheel_diameter_m = wheel_diameter_m_;
  out.track_m = track_m_;
  out.max_speed_mps = max_speed_mps_;
  out.max_turning_rate_radps = max_turning_rate_radps_;
  out.max_motor_radps = by_drive > 0 && wheel_diameter_m_ > 0 ? max_speed_mps_ / (wheel_diameter_m_ / 2)
                        : motors_.empty()                     ? 0
                                                              : motors_.front().full;
  out.slot_s = spec.slot_s;
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    set_name(out.distance_names[i], distances_[i].name);
    out.distance_numbers[i] = distances_[i].number;
  }
  static constexpr const char* two[] = {"left", "right"};
  static constexpr const char* four[] = {"frontleft", "frontright", "backleft", "backright"};
  for (std::size_t i = 0; i < by_drive; ++i)
    set_name(out.motor_names[i], by_drive == 1 ? "drive" : by_drive == 2 ? two[i] : four[i]);
  for (std::size_t i = 0; i < motors_.size(); ++i) set_name(out.motor_names[i], motors_[i].name);
  if (steers()) set_name(out.servo_names[0], "steering");
  for (std::size_t i = 0; i < servos_.size() && steering + i < most_servos; ++i)
    set_name(out.servo_names[steering + i], servos_[i].name);
  for (std::size_t i = 0; i < bumpers_.size(); ++i) set_name(out.bumper_names[i], bumpers_[i].name);
}

namespace {

template <class M>
const Topic<M>& topic_of(const Observation& obs, std::uint32_t index) {
  const Topic<M>* const topic = topic_cast<M>(&obs.topic(index));
  SL_CHECK(topic != nullptr);
  return *topic;
}

void put_image(const Topic<msg::Image>& topic, Senses& out) {
  const msg::Image& image = topic.message;
  const std::size_t pixels = std::size_t{image.width} * image.height;
  const bool grey = image.encoding == "mono8";
  if (pixels * 3 > most_image_bytes || image.data.size() != pixels * (grey ? 1 : 3)) return;
  if (!grey && image.encoding != "rgb8" && image.encoding != "bgr8") return;
  out.image_width = image.width;
  out.image_height = image.height;
  out.image_count = topic.count;
  out.image_time_ns = topic.stamp.ns;
  const std::uint8_t* const from = image.data.data();
  if (image.encoding == "rgb8") std::memcpy(out.image, from, pixels * 3);
  else
    for (std::size_t i = 0; i < pixels; ++i)
      for (std::size_t c = 0; c < 3; ++c) out.image[i * 3 + c] = grey ? from[i] : from[i * 3 + 2 - c];
}

double wrapped(double angle_rad) { return math::atan2(math::sin(angle_rad), math::cos(angle_rad)); }

}  // namespace

std::array<double, 3> RobotDevices::odometry(const Observation& obs) const {
  if (!odometry_) return {};
  const auto& pose = topic_of<msg::Odometry>(obs, *odometry_).message.pose.pose;
  return {pose.p.x, pose.p.y, yaw_of(pose.q)};
}

void RobotDevices::sense(const Observation& obs, const State& state, Senses& out,
                         std::uint64_t& sent_pictures) const {
  // The odometry that the program has set: `origin` before that of the drive.
  const std::array<double, 3> moved = odometry(obs);
  const double c = math::cos(state.origin[2]), s = math::sin(state.origin[2]);
  out.x_m = state.origin[0] + c * moved[0] - s * moved[1];
  out.y_m = state.origin[1] + s * moved[0] + c * moved[1];
  out.phi_rad = wrapped(state.origin[2] + moved[2]);
  if (odometry_) {
    const auto& twist = topic_of<msg::Odometry>(obs, *odometry_).message.twist.twist;
    out.v_mps = twist.linear.x;
    out.w_radps = twist.angular.z;
  }
  out.maneuver_done = 1;
  if (progress_) {
    const msg::DriveProgress& progress = topic_of<msg::DriveProgress>(obs, *progress_).message;
    out.maneuvers = progress.maneuvers;
    out.maneuver_done = progress.done;
    out.remaining_m = progress.remaining_distance;
    out.remaining_rad = progress.remaining_angle;
    out.stalled = 0;
    for (const std::uint32_t motor : progress.stalled)
      if (motor >= 1 && motor <= most_motors) out.stalled |= 1u << (motor - 1);
  }
  for (std::size_t i = 0; i < encoders_.size(); ++i)
    out.encoder_ticks[i] = topic_of<msg::Int64Stamped>(obs, encoders_[i].index).message.data;
  for (std::size_t i = 0; i < distances_.size(); ++i) {
    const auto& topic = topic_of<msg::Range>(obs, distances_[i].index);
    const bool seen = topic.count > 0 && topic.message.range >= topic.message.min_range &&
                      topic.message.range <= topic.message.max_range;
    out.distance_m[i] = seen ? static_cast<double>(topic.message.range) : -1;
    out.distance_count[i] = static_cast<std::uint32_t>(topic.count);
  }
  if (lidar_) {
    const auto& topic = topic_of<msg::LaserScan>(obs, *lidar_);
    const msg::LaserScan& scan = topic.message;
    if (const auto count = static_cast<std::uint32_t>(topic.count); out.lidar_count != count) {
      out.lidar_count = count;
      out.beams = static_cast<std::uint32_t>(std::min(scan.ranges.size(), most_beams));
      out.lidar_first_rad = static_cast<double>(scan.angle_min);
      out.lidar_step_rad = static_cast<double>(scan.angle_increment);
      std::copy_n(scan.ranges.data(), out.beams, out.beam_m);
    }
  }
  for (std::size_t i = 0; i < bumpers_.size(); ++i)
    out.bumper[i] = !topic_of<msg::ContactsState>(obs, bumpers_[i].index).message.states.empty();
  if (imu_) {
    out.compass_rad = yaw_of(topic_of<msg::Imu>(obs, *imu_).message.orientation);
  } else if (magnetometer_) {
    const Vec3 field = topic_of<msg::MagneticField>(obs, *magnetometer_).message.magnetic_field;
    constexpr double quarter_rad = 1.5707963267948966;
    out.compass_rad = wrapped(quarter_rad - math::atan2(field.y, field.x));
  }
  if (battery_)
    out.battery_V = static_cast<double>(topic_of<msg::BatteryState>(obs, *battery_).message.voltage);
  if (keys_) {
    const msg::KeyPresses& presses = topic_of<msg::KeyPresses>(obs, *keys_).message;
    out.key_presses = presses.count;
    const std::size_t kept = std::min(presses.latest.size(), most_key_presses);
    out.keys = static_cast<std::uint32_t>(kept);
    for (std::size_t i = 0; i < kept; ++i) {
      const msg::KeyPress& press = presses.latest[presses.latest.size() - kept + i];
      out.key[i] = {press.key, press.x, press.y};
    }
  }
  if (speaker_) out.speaker_busy = topic_of<msg::SpeakerState>(obs, *speaker_).message.playing;
  if (camera_)
    if (const auto& topic = topic_of<msg::Image>(obs, *camera_);
        topic.count > 0 && topic.count != sent_pictures) {
      put_image(topic, out);
      sent_pictures = topic.count;
    }
}

std::uint64_t RobotDevices::key_presses(const Observation& obs) const {
  return keys_ ? topic_of<msg::KeyPresses>(obs, *keys_).message.count : 0;
}

std::uint64_t RobotDevices::pictures(const Observation& obs) const {
  return camera_ ? obs.topic(*camera_).count : 0;
}

bool RobotDevices::maneuver_done(const Observation& obs) const {
  return !progress_ || topic_of<msg::DriveProgress>(obs, *progress_).message.done;
}

const Topic<msg::RadioReceptionArray>* RobotDevices::receptions(const Observation& obs) const {
  return reception_ ? &topic_of<msg::RadioReceptionArray>(obs, *reception_) : nullptr;
}

// ---------------------------------------------------------------------------------------------------------- orders

bool RobotDevices::order_speed(double v_mps, double w_radps, Command& cmd) const {
  if (!twist_) return false;
  msg::Twist twist;
  twist.linear.x = v_mps;
  twist.angular.z = w_radps;
  cmd.set_bytes(*twist_, command_bytes(twist));
  return true;
}

/// Speed of the motor, on the curve of the steering's servo: its 0 is the left end.
bool RobotDevices::order_car(const State& state, Command& cmd) const {
  const double steering_rad = state.wheels[1] * max_steering_rad_;
  const double wheelbase_m = wheelbase_m_ > 0 ? wheelbase_m_ : 1.5 * track_m_;
  return order_speed(state.wheels[0], state.wheels[0] * math::tan(steering_rad) / wheelbase_m, cmd);
}

bool RobotDevices::order_motor(const MotorOrder& order, State& state, Command& cmd) const {
  if (order.number < motors_.size()) {
    const Actor& motor = motors_[order.number];
    if (order.mode == 1 && !motor.speed) return false;
    msg::Float64 command;
    command.data = order.mode == 1 ? order.value : std::clamp(order.value, -1.0, 1.0) * motor.full;
    cmd.set_bytes(motor.index, command_bytes(command));
    return true;
  }
  if (order.number >= drive_motors()) return false;
  state.wheels[order.number] = order.mode == 1 ? order.value * wheel_diameter_m_ / 2
                                               : std::clamp(order.value, -1.0, 1.0) * max_speed_mps_;
  if (steers()) return order_car(state, cmd);
  if (drive_motors() == 4) {
    msg::JointState wheels;
    for (const double speed_mps : state.wheels)
      wheels.velocity.push_back(speed_mps / (wheel_diameter_m_ / 2));
    cmd.set_bytes(*wheels_, command_bytes(wheels));
    return true;
  }
  return order_speed((state.wheels[0] + state.wheels[1]) / 2, (state.wheels[1] - state.wheels[0]) / track_m_,
                     cmd);
}

bool RobotDevices::carry_out(const Order& order, State& state, Command& cmd) const {
  if (const auto* speed = std::get_if<SpeedOrder>(&order)) {
    state.wheels = {};
    return order_speed(speed->v_mps, speed->w_radps, cmd);
  }
  if (const auto* maneuver = std::get_if<ManeuverOrder>(&order)) {
    if (!maneuver_) return false;
    state.wheels = {};
    msg::DriveManeuver out;
    out.kind = static_cast<std::uint8_t>(maneuver->kind);
    out.distance = maneuver->distance_m;
    out.angle = maneuver->angle_rad;
    out.x = maneuver->x_m;
    out.y = maneuver->y_m;
    out.speed = maneuver->speed_mps;
    out.turning_rate = maneuver->turning_rate_radps;
    cmd.set_bytes(*maneuver_, command_bytes(out));
    return true;
  }
  if (const auto* pose = std::get_if<PoseOrder>(&order)) {
    // origin * odometry = pose, at the time of the turn.
    const double turned = wrapped(pose->phi_rad - state.odometry[2]);
    const double c = math::cos(turned), s = math::sin(turned);
    state.origin = {pose->x_m - (c * state.odometry[0] - s * state.odometry[1]),
                    pose->y_m - (s * state.odometry[0] + c * state.odometry[1]), turned};
    return true;
  }
  if (const auto* motor = std::get_if<MotorOrder>(&order)) return order_motor(*motor, state, cmd);
  if (const auto* servo = std::get_if<ServoOrder>(&order)) {
    const std::size_t steering = steers() ? 1 : 0;
    if (servo->number >= steering + servos_.size()) return false;
    if (servo->number < steering) {
      state.wheels[1] = std::clamp(1 - 2 * servo->value, -1.0, 1.0);
      return order_car(state, cmd);
    }
    msg::Float64 command;
    command.data = (servo->value - 0.5) * servo_range_rad_;
    cmd.set_bytes(servos_[servo->number - steering].index, command_bytes(command));
    return true;
  }
  if (const auto* pixels = std::get_if<ScreenPixels>(&order)) {
    if (!screen_ || pixels->at.x + pixels->at.width > screen_width_ ||
        pixels->at.y + pixels->at.height > screen_height_)
      return false;
    msg::ScreenPatch patch;
    patch.x = pixels->at.x;
    patch.y = pixels->at.y;
    patch.width = pixels->at.width;
    patch.height = pixels->at.height;
    patch.data.resize(pixels->rgb.size());
    std::memcpy(patch.data.data(), pixels->rgb.data(), pixels->rgb.size());
    cmd.set_bytes(*screen_, command_bytes(patch));
    return true;
  }
  if (const auto* lines = std::get_if<ScreenLines>(&order)) {
    if (!screen_) return false;
    msg::ScreenPatch patch;
    patch.has_text = true;
    patch.lines = lines->lines;
    patch.menu = lines->menu;
    cmd.set_bytes(*screen_, command_bytes(patch));
    return true;
  }
  if (const auto* sound = std::get_if<SoundNamed>(&order)) {
    if (!sound_) return false;
    msg::Sound out;
    out.frequency = sound->tone.frequency_Hz;
    out.duration = sound->tone.duration_s;
    out.name = sound->name;
    cmd.set_bytes(*sound_, command_bytes(out));
    return true;
  }
  if (const auto* packet = std::get_if<Packet>(&order)) {
    if (!packet_ || packet->to > state.robots.size()) return false;
    msg::RadioPacket out;
    if (packet->to > 0) out.to = state.robots[packet->to - 1];
    out.data.resize(packet->bytes.size());
    if (!packet->bytes.empty()) std::memcpy(out.data.data(), packet->bytes.data(), packet->bytes.size());
    cmd.set_bytes(*packet_, command_bytes(out));
    return true;
  }
  if (std::holds_alternative<PictureOrder>(order)) {
    if (camera_) cmd.request_sample_of(*camera_);
    return camera_.has_value();
  }
  // Notes are for the log alone, moves come as requests of their own, and so do gains of the controller.
  return true;
}

void RobotDevices::add_gains(const ControlOrder& order, std::vector<Setting>& out) const {
  const DeviceFacts* const facts = facts_of(drive_);
  if (!facts || !facts->numbers.contains("control.vv")) return;
  constexpr double shortest_s = 1e-3, longest_s = 1e6,
                   most = 1e6;  // what the drive takes; RoBIOS has 0 for no integral
  const auto time_s = [&](double t) { return t > 0 ? std::clamp(t, shortest_s, longest_s) : longest_s; };
  out.push_back({drive_, "control/vv", std::clamp(order.vv, 0.0, most)});
  out.push_back({drive_, "control/tv", time_s(order.tv)});
  out.push_back({drive_, "control/vw", std::clamp(order.vw, 0.0, most)});
  out.push_back({drive_, "control/tw", time_s(order.tw)});
}

void RobotDevices::stop(Command& cmd) const {
  order_speed(0, 0, cmd);
  for (const Actor& motor : motors_) cmd.set_bytes(motor.index, command_bytes(msg::Float64()));
}

}  // namespace sandlot::programs::robios
