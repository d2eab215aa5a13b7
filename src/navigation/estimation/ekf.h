#pragma once
/// State estimator: an extended Kalman filter (ekf_model.h) that fuses any number of sensors (sensor.h).
///
///   const ekf::Spec spec = ...;                      // read_spec<ekf::Spec>(node)
///   ekf::State state = ekf::begin(spec);
///   ekf::add(spec, state, "odom0", message);         // queued, or why not
///   ekf::advance(spec, state, now);                  // in order of time, late ones included
///   const ekf::Estimate estimate = ekf::estimate(spec, state, now);
///
/// Frames     W is `odom` for continuous sources, `map` when one jumps (gps, scan matching): REP 105. Two filters, one for
///            each, give the transform from map to odom (map_to_odom).
/// Order      samples are processed in the order (stamp, sensor, part of the message), whatever the order of arrival: with a
///            late one the filter goes back to a state from before it and does all again. The result is the same to the bit.
/// Begin      the first sample that can be used sets the components it measures, and their covariance.
/// Differences count from a copy of the pose at the sensor's last measurement, whose errors the filter knows (extra_states.h): ways add
///            up without passing through velocities, however the robot moved between. A difference that meets a filter
///            before any other sample sets velocities. One that is rejected leaves the copy when its errors are independent: the
///            next difference is longer.
/// Datum      without one, the first fix is the antenna where the filter then thinks it is. The datum's place in W is a state of three
///            numbers, as unsure as that fix and that place were, and later fixes improve it. The antenna's arm is turned by the
///            estimated orientation, whose errors count.
/// History    of `history` seconds before the newest sample processed, at most 4096 samples. What is older is `late`.
/// Errors     each measurement has an Outcome, counted for each sensor. None stops the filter or changes it silently.
/// Limits     acceleration is taken as the derivative of the velocity in B (ekf_model.h). A filter that has become too sure
///            rejects what is right: `gated_in_row` tells. A pitch of +-90 degrees has no unique roll and yaw.
/// Cost       some microseconds for a sample of 6 components; a late one costs again all samples after it. No allocation once the
///            history is full.
/// Source     parameters and defaults: robot_localization, ROS 2.
#include <string_view>
#include <vector>

#include "navigation/estimation/extra_states.h"
#include "navigation/estimation/sensor.h"

namespace sandlot::navigation::ekf {

struct Spec {
  bool two_d_mode = false;
  double history_s = 0.5;
  double future_s = 0.5;
  bool reset_on_time_jump = false;
  double gravity_mps2 = 9.80665;
  Vector process_noise{.05, .05, .06, .03, .03, .06, .025, .025, .04, .01, .01, .02, .01, .01, .015};
  Vector initial_state{};
  Vector initial_covariance{1e-9, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9,
                            1e-9, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9, 1e-9};
  std::optional<Datum> datum;
  std::vector<Sensor> sensors;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"two_d_mode", "", "Whether z, roll, pitch and what derives from them stay 0."}, s.two_d_mode);
    visit(Field{"history", "s", "Time for which measurements may be late.", 0, 60}, s.history_s);
    visit(Field{"future", "s", "Time by which stamps may be ahead of the clock.", 0, 60}, s.future_s);
    visit(Field{"reset_on_time_jump", "",
                "Whether the filter begins again when the clock jumps back by more than its history."},
          s.reset_on_time_jump);
    visit(Field{"gravity", "m/s^2", "Gravity that accelerometers measure at rest.", 0, 100}, s.gravity_mps2);
    visit(Field{"process_noise_covariance", "",
                "Variances by which the 15 components become unsure in a second.", 0, 1e12},
          s.process_noise);
    visit(Field{"initial_state", "", "Values of the 15 components before the first measurement.", -1e9, 1e9},
          s.initial_state);
    visit(Field{"initial_estimate_covariance", "",
                "Variances of the 15 components before the first measurement.", 0, 1e12},
          s.initial_covariance);
    visit(Field{"datum", "",
                "Place of the world frame, exactly known; none: the first fix is where the robot then is, as "
                "well "
                "as both are known."},
          s.datum);
    visit(Field{"sensors", "", "Sensors that are fused.", 0, 0, Field::none, 32}, s.sensors);
  }
  Status check(const Node& node, const std::string& path) const;
  /// Slot of a sensor's earlier pose (extra_states.h).
  std::size_t clone_slot(std::size_t sensor) const;
  /// Slot of a sensor's relative errors of way and turn, or none: it has none.
  std::optional<std::size_t> scale_slot(std::size_t sensor) const;
  /// Slot of the datum's place, or none: it is given, or there is no receiver.
  std::optional<std::size_t> datum_slot() const;
  std::size_t slots() const;
};

/// What differences and relative poses of a sensor count from.
struct Memory {
  bool set = false;
  bool cloned = false;  ///< the filter holds its own pose of that time
  Time at;
  std::array<double, 6> value{};
  Triangle covariance{};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"set", "", "Whether there is one."}, s.set);
    visit(Field{"cloned", "", "Whether the filter holds its own pose of that time."}, s.cloned);
    visit(Field{"at", "s", "Time of the pose."}, s.at);
    visit(Field{"value", "", "Pose: x y z roll pitch yaw."}, s.value);
    visit(Field{"covariance", "", "Lower triangle of its covariance."}, s.covariance);
  }
};

/// Filter at one time.
struct Core {
  bool known = false;        ///< a sample has been used
  Time at{-1};               ///< stamp of the last sample processed, which x and P are for
  std::uint32_t sensor = 0;  ///< of that sample
  Part part = Part::pose;    ///< of that sample
  Vector x{};
  Matrix P;
  std::vector<Memory> memories;  ///< one for each sensor
  ExtraStates extra;             ///< of spec.slots()
  bool datum_set = false;        ///< the slot of the datum's place is

  static void fields(auto& s, auto&& visit) {
    visit(Field{"known", "", "Whether a measurement has been used."}, s.known);
    visit(Field{"at", "s", "Time of the latest measurement."}, s.at);
    visit(Field{"sensor", "1", "Index of its sensor."}, s.sensor);
    visit(Field{"part", "", "Part of its message."}, s.part);
    visit(Field{"x", "", "Estimate of x y z roll pitch yaw, their velocities in base_link, accelerations."},
          s.x);
    visit(Field{"covariance", "", "Covariance of the estimate, row by row."}, s.P);
    visit(Field{"memories", "", "Poses that differences and relative poses count from."}, s.memories);
    visit(Field{"extra", "", "Earlier poses of the filter, and what the datum is to be moved by."}, s.extra);
    visit(Field{"datum_set", "", "Whether a fix has placed the datum."}, s.datum_set);
  }
};

/// What has become of a sensor's measurements.
struct SensorRecord {
  bool heard = false;
  Time newest;                                   ///< greatest stamp processed
  std::array<std::uint64_t, outcomes> counts{};  ///< by Outcome; parts of messages count one by one
  Outcome last = Outcome::unmeasured;
  double squared_distance = 0;   ///< squared Mahalanobis distance of the last one compared
  std::uint32_t components = 0;  ///< of that one
  std::uint64_t gated_in_row = 0;
  std::uint64_t count(Outcome o) const { return counts[static_cast<std::size_t>(o)]; }

  static void fields(auto& s, auto&& visit) {
    visit(Field{"heard", "", "Whether a measurement has been processed."}, s.heard);
    visit(Field{"newest", "s", "Greatest stamp processed."}, s.newest);
    visit(Field{"counts", "1",
                "Measurements queued, used, gated, started, late, early, duplicate, full, unmeasured, with a "
                "bad stamp, bad value, bad covariance, and those that met a diverged filter."},
          s.counts);
    visit(Field{"last", "", "Outcome of the latest one."}, s.last);
    visit(Field{"squared_distance", "1", "Squared Mahalanobis distance of the latest one compared."},
          s.squared_distance);
    visit(Field{"components", "1", "Number of components of that one."}, s.components);
    visit(Field{"gated_in_row", "1", "Measurements rejected since the last one used."}, s.gated_in_row);
  }
};

struct State {
  Time now;
  Core core;
  std::vector<Core> checkpoints;  ///< earlier cores, oldest first
  std::vector<Sample> history;    ///< after the oldest checkpoint, in order
  std::vector<Sample> queue;      ///< by arrival
  std::vector<SensorRecord> sensors;
  std::optional<Datum> datum;
  std::uint64_t rewinds = 0;  ///< times that the filter went back for late samples
  std::uint64_t resets = 0;   ///< times that the clock jumped back

  static void fields(auto& s, auto&& visit) {
    visit(Field{"now", "s", "Time of the clock."}, s.now);
    visit(Field{"core", "", "Filter after the latest measurement."}, s.core);
    visit(Field{"checkpoints", "", "Filter at earlier times.", 0, 0, Field::none, 64}, s.checkpoints);
    visit(Field{"history", "", "Measurements since the first of them."}, s.history);
    visit(Field{"queue", "", "Measurements that wait."}, s.queue);
    visit(Field{"sensors", "", "Records of the sensors."}, s.sensors);
    visit(Field{"datum", "", "Place of the world frame; of the first fix, before `extra` moves it."},
          s.datum);
    visit(Field{"rewinds", "1", "Times that the filter went back for late measurements."}, s.rewinds);
    visit(Field{"resets", "1", "Times that it began again."}, s.resets);
  }
  /// Whether the state can be one of this spec, for bytes that may be damaged.
  bool fits(const Spec& spec) const;
};

/// Filter before the first measurement, or what is wrong with the spec.
Result<State> begin(const Spec& spec);

/// Index of a sensor by its name.
std::optional<std::size_t> find_sensor(const Spec& spec, std::string_view name);

/// Puts a message in the queue; the kind of the sensor must be the message's (SL_CHECK). The first fix sets the datum,
/// unless the spec has one.
/// @param sensor  index in spec.sensors
Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::Odometry& message);
Outcome add(const Spec& spec, State& state, std::size_t sensor,
            const msg::PoseWithCovarianceStamped& message);
Outcome add(const Spec& spec, State& state, std::size_t sensor,
            const msg::TwistWithCovarianceStamped& message);
Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::Imu& message);
Outcome add(const Spec& spec, State& state, std::size_t sensor, const msg::NavSatFix& message);

/// What became of a sample.
struct Report {
  Time stamp;
  std::uint32_t sensor = 0;
  Part part = Part::pose;
  Outcome outcome = Outcome::used;
  double squared_distance = 0;
  std::size_t components = 0;
};

/// Processes what is due.
/// @param reports  out, unless null: what became of each sample that was processed or dropped for the first time
void advance(const Spec& spec, State& state, Time now, std::vector<Report>* reports = nullptr);

struct Estimate {
  bool known = false;  ///< false: the initial values
  Time at;             ///< not before the latest sample
  Vector x{};
  Matrix P;

  Pose pose() const;  ///< X_WB
};
/// Prediction from the latest sample to a time. The state does not change.
Estimate estimate(const Spec& spec, const State& state, Time at);

/// Into a message: pose and twist with their covariances, of turns as those of roll, pitch and yaw.
void write_message(const Estimate& estimate, msg::Odometry& out);

/// Pose of the frame odom in the frame map, from one filter in each at the same time.
Pose map_to_odom(const Estimate& in_map, const Estimate& in_odom);

}  // namespace sandlot::navigation::ekf
