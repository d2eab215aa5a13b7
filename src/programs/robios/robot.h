#pragma once
/// A robot as RoBIOS sees it: which devices serve as drive, distance sensors, camera ..., found by the types of their messages.
///
///   drive       first device that takes Twist; its odometry, and DriveManeuver and DriveProgress if it has them
///   distances   Range, one device each; lidar: the first LaserScan; camera: the first colour Image
///   encoders    devices with `ticks_per_turn`; bumpers: ContactsState; compass: Imu, or MagneticField (north along y)
///   motors      devices that take Float64 at another level than `position`; without any, the two sides of a differential drive, the
///               four wheels of a Mecanum drive, or the one motor of a car
///   servos      devices that take Float64 at level `position`; before them the steering of a car without motors of its own
///   battery, radio, keys, screen, speaker   by their messages
#include <optional>

#include "programs/robios/orders.h"
#include "programs/robios/spec.h"
#include "programs/surroundings.h"

namespace sandlot::programs::robios {

class RobotDevices {
 public:
  /// Errors: `distances` names what is no distance sensor.
  Status find(const Description& robot, std::vector<DeviceFacts> facts, const Spec& spec);

  /// What does not change; of `out` only that.
  void describe(const Spec& spec, const State& state, sandlot::robios::Robot& out) const;
  /// All but radio, entities and times. @param sent_pictures  picture that `out` holds already; kept up to date
  void sense(const Observation& obs, const State& state, sandlot::robios::Senses& out,
             std::uint64_t& sent_pictures) const;

  std::uint64_t key_presses(const Observation& obs) const;
  std::uint64_t pictures(const Observation& obs) const;
  bool maneuver_done(const Observation& obs) const;
  /// x, y, heading of the drive's odometry.
  std::array<double, 3> odometry(const Observation& obs) const;
  /// The radio's latest message; null: it has no radio.
  const Topic<msg::RadioReceptionArray>* receptions(const Observation& obs) const;

  /// Gives the commands that orders mean. @return false: the robot has nothing for it
  bool carry_out(const Order& order, State& state, Command& cmd) const;
  bool has_radio() const { return reception_.has_value(); }
  /// Gains of the drive's loops on speed and turning rate, where it has such loops.
  void add_gains(const sandlot::robios::ControlOrder& order, std::vector<Setting>& out) const;
  /// Stops drive and motors, as the end of a program does.
  void stop(Command& cmd) const;

 private:
  using Index = std::optional<std::uint32_t>;
  struct Actor {
    std::uint32_t index = 0;
    std::string name;
    double full = 1;     ///< command that full voltage or speed means
    bool speed = false;  ///< commands are rad/s
  };
  struct Sensor {
    std::uint32_t index = 0;
    std::string name;
    std::int32_t number = 0;
  };
  const DeviceFacts* facts_of(const std::string& device) const;
  double number(const std::string& device, std::initializer_list<const char*> keys, double otherwise) const;
  Status find_distances(const Description& robot, const Spec& spec);
  void find_drive(const Description& robot, const Spec& spec);
  void find_motors(const Description& robot);
  /// Motors that are wheels of the drive.
  std::size_t drive_motors() const;
  /// Whether motor 1 and servo 1 are those of a car: state.wheels[0] is its speed, state.wheels[1] the steering, 1 on the left end.
  bool steers() const;
  bool order_car(const State& state, Command& cmd) const;
  bool order_speed(double v_mps, double w_radps, Command& cmd) const;
  bool order_motor(const sandlot::robios::MotorOrder& order, State& state, Command& cmd) const;

  std::vector<DeviceFacts> facts_;
  std::string drive_;  ///< name of the device
  sandlot::robios::Drive drive_kind_ = sandlot::robios::Drive::none;
  double wheel_diameter_m_ = 0, track_m_ = 0, max_speed_mps_ = 0, max_turning_rate_radps_ = 0,
         servo_range_rad_ = 0, max_steering_rad_ = 0, wheelbase_m_ = 0;
  std::uint32_t ticks_per_turn_ = 0, screen_width_ = 0, screen_height_ = 0;
  Index twist_, wheels_, maneuver_, odometry_, progress_, lidar_, camera_, imu_, magnetometer_, battery_,
      keys_, screen_, sound_, speaker_, packet_, reception_;
  std::vector<Sensor> distances_, encoders_, bumpers_;
  std::vector<Actor> motors_, servos_;
};

}  // namespace sandlot::programs::robios
