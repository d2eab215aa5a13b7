#pragma once
/// Sensors of the estimator (ekf.h): what each measures, and its messages turned into samples of base_link.
///
/// Kinds      odometry (pose and twist), pose, twist, imu (orientation, rates, acceleration), gps (position).
/// Frames     poses are those of the sensor's frame S in the world frame W, twists and accelerations are in S; `mount` is
///            the pose of S in base_link B. A sample, `config` and `deviation` are about B.
/// Covariance of turns: about the axes of the message's frame, in rad^2; taken for that of roll, pitch and yaw.
/// Scale      a differential sensor's ways and turns may have constant relative errors, whose deviations are given: it measures
///            (1 + s) times the way and (1 + t) times the turn, and the filter estimates s and t. On a way back and forth, or a loop,
///            they cancel, which errors that count as white never do.
/// Limits     the mount's lever arm is not applied to accelerations. How much a relative error shows is told by the way that the filter
///            expects, not by the measured one, whose noise would look like an error of its own: a way that begins with a
///            velocity nobody expects counts wrong. Other errors of differences count as white, so that independent
///            errors of poses, of which each is in two differences, count twice.
#include <cstdint>
#include <string>
#include <vector>

#include "base/node.h"
#include "base/result.h"
#include "base/time.h"
#include "geometry/pose.h"
#include "messages/geometry_msgs.h"
#include "messages/nav_msgs.h"
#include "messages/sensor_msgs.h"
#include "navigation/estimation/datum.h"
#include "navigation/estimation/ekf_model.h"

namespace sandlot::navigation::ekf {

enum class SensorKind : std::uint8_t { odometry, pose, twist, imu, gps };
inline std::span<const EnumName<SensorKind>> enum_names(SensorKind) {
  static constexpr EnumName<SensorKind> names[] = {{"odometry", SensorKind::odometry},
                                                   {"pose", SensorKind::pose},
                                                   {"twist", SensorKind::twist},
                                                   {"imu", SensorKind::imu},
                                                   {"gps", SensorKind::gps}};
  return names;
}

/// What the errors of two poses in a row have in common.
enum class PoseErrors : std::uint8_t {
  independent,  ///< nothing: the errors of both count in the difference
  accumulated,  ///< all of the earlier one's, as in odometry: the growth of the covariance counts
  as_twist      ///< what the message's twist says, which is the mean velocity since the message before
};
inline std::span<const EnumName<PoseErrors>> enum_names(PoseErrors) {
  static constexpr EnumName<PoseErrors> names[] = {{"independent", PoseErrors::independent},
                                                   {"accumulated", PoseErrors::accumulated},
                                                   {"as_twist", PoseErrors::as_twist}};
  return names;
}

struct Sensor {
  std::string name;
  SensorKind kind = SensorKind::odometry;
  std::array<bool, states> config{};
  bool differential = false, relative = false;
  PoseErrors pose_errors = PoseErrors::independent;
  double longest_gap_s = 1;
  double way_scale_deviation = 0, turn_scale_deviation = 0;  ///< prior, as shares; 0: exact
  double pose_rejection_threshold = 0, twist_rejection_threshold = 0, acceleration_rejection_threshold = 0;
  bool remove_gravitational_acceleration = false;
  int queue_size = 20;
  Pose mount;                     ///< X_BS
  std::vector<double> deviation;  ///< none, or one for each component of the state; 0: the message's

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the sensor.", 0, 0, Field::required, 100, 1}, s.name);
    visit(Field{"kind", "", "Kind of its messages."}, s.kind);
    visit(Field{"config", "",
                "Whether each of x y z roll pitch yaw vx vy vz vroll vpitch vyaw ax ay az is used."},
          s.config);
    visit(
        Field{
            "differential", "",
            "Whether poses count from the one before: x y z roll pitch yaw are then the way and turn since, "
            "in the base link's axes at that time."},
        s.differential);
    visit(Field{"relative", "", "Whether poses count from the first one."}, s.relative);
    visit(Field{"pose_errors", "",
                "Errors of successive poses, for differences: independent; accumulated as in odometry, whose "
                "covariance grows; or as_twist: the covariance of an odometry's twist, which is its mean "
                "velocity "
                "since the message before."},
          s.pose_errors);
    visit(Field{"longest_gap", "s", "Longest time over which a difference of poses is used.", 1e-3, 1e6},
          s.longest_gap_s);
    visit(Field{"way_scale_deviation", "1",
                "Standard deviation of a constant relative error of all ways of a differential sensor, of a "
                "wheel's radius or a calibration, which the filter estimates; 0: none.",
                0, 1},
          s.way_scale_deviation);
    visit(Field{"turn_scale_deviation", "1",
                "Standard deviation of a constant relative error of all turns of a differential sensor; 0: "
                "none.",
                0, 1},
          s.turn_scale_deviation);
    visit(Field{"pose_rejection_threshold", "1",
                "Mahalanobis distance above which a pose is rejected; 0: never.", 0, 1e6},
          s.pose_rejection_threshold);
    visit(Field{"twist_rejection_threshold", "1",
                "Mahalanobis distance above which a velocity is rejected; 0: never.", 0, 1e6},
          s.twist_rejection_threshold);
    visit(Field{"acceleration_rejection_threshold", "1",
                "Mahalanobis distance above which an acceleration is rejected; 0: never.", 0, 1e6},
          s.acceleration_rejection_threshold);
    visit(Field{"remove_gravitational_acceleration", "",
                "Whether the accelerometer measures gravity too, which is then subtracted."},
          s.remove_gravitational_acceleration);
    visit(Field{"queue_size", "1", "Messages that may wait for their time.", 1, 1000}, s.queue_size);
    visit(Field{"mount", "", "Pose of the sensor in base_link."}, s.mount);
    visit(
        Field{
            "deviation", "",
            "Standard deviations of the 15 components in place of the messages' covariances, of differences "
            "those of the mean velocity; 0: the message's. Empty: all of them are the messages'.",
            0, 1e6, Field::none, states},
        s.deviation);
  }
  Status check(const Node& node, const std::string& path) const;
  bool scaled() const { return differential && (way_scale_deviation > 0 || turn_scale_deviation > 0); }
};

/// Part of a message: six components of the state in a row, of the acceleration three.
enum class Part : std::uint8_t { pose, twist, acceleration };
inline std::span<const EnumName<Part>> enum_names(Part) {
  static constexpr EnumName<Part> names[] = {
      {"pose", Part::pose}, {"twist", Part::twist}, {"acceleration", Part::acceleration}};
  return names;
}
constexpr std::size_t first_index(Part part) {
  return part == Part::pose ? X : part == Part::twist ? Vx : Ax;
}

/// Answer to a measurement.
enum class Outcome : std::uint8_t {
  queued,      ///< waits for advance()
  used,        ///< corrected the estimate
  gated,       ///< was too far from the prediction
  started,     ///< is the first one of a differential source, or the first after a gap, or places the datum
  late,        ///< is older than the history
  early,       ///< has a stamp too far in the future
  duplicate,   ///< has the stamp of an earlier one of its sensor
  full,        ///< found the queue full
  unmeasured,  ///< holds nothing that is to be used (no fix, covariance -1)
  bad_stamp,   ///< has a negative stamp or one after the year 2096
  bad_value,   ///< holds a number that is not finite, above 1e9, or no rotation
  bad_covariance,  ///< has a covariance that is not finite, symmetric and positive definite
  diverged,        ///< met an estimate that had grown beyond bounds: the filter begins again
};
inline constexpr std::size_t outcomes = 13;
inline std::span<const EnumName<Outcome>> enum_names(Outcome) {
  static constexpr EnumName<Outcome> names[] = {{"queued", Outcome::queued},
                                                {"used", Outcome::used},
                                                {"gated", Outcome::gated},
                                                {"started", Outcome::started},
                                                {"late", Outcome::late},
                                                {"early", Outcome::early},
                                                {"duplicate", Outcome::duplicate},
                                                {"full", Outcome::full},
                                                {"unmeasured", Outcome::unmeasured},
                                                {"bad_stamp", Outcome::bad_stamp},
                                                {"bad_value", Outcome::bad_value},
                                                {"bad_covariance", Outcome::bad_covariance},
                                                {"diverged", Outcome::diverged}};
  return names;
}

/// Symmetric matrix of 6 x 6 as its lower triangle, row by row.
using Triangle = std::array<double, 21>;
constexpr std::size_t triangle_index(std::size_t i, std::size_t j) {
  return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
}

/// Part of a message, about B. What is not used, and not needed for what is, is 0.
struct Sample {
  Time stamp;
  std::uint32_t sensor = 0;
  Part part = Part::pose;
  bool counted = false;        ///< its outcome is in the counters
  bool holds_gravity = false;  ///< acceleration: gravity is to be removed by the estimated orientation
  std::array<double, 6> value{};
  Triangle covariance{};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Time of the measurement."}, s.stamp);
    visit(Field{"sensor", "1", "Index of the sensor."}, s.sensor);
    visit(Field{"part", "", "Part of the message."}, s.part);
    visit(Field{"counted", "", "Whether its outcome has been counted."}, s.counted);
    visit(Field{"holds_gravity", "", "Whether gravity is still to be removed."}, s.holds_gravity);
    visit(Field{"value", "", "Measured values."}, s.value);
    visit(Field{"covariance", "", "Lower triangle of the covariance."}, s.covariance);
  }
};

/// Parts of one message.
struct Samples {
  std::size_t count = 0;
  std::array<Sample, 3> part;
};

/// Turn a message into samples; stamps and indices of sensors are the caller's. The answer is `queued` when it can be used.
Outcome to_samples(const Sensor& sensor, const msg::Odometry& odometry, Samples& out);
Outcome to_samples(const Sensor& sensor, const msg::PoseWithCovariance& pose, Samples& out);
Outcome to_samples(const Sensor& sensor, const msg::TwistWithCovariance& twist, Samples& out);
Outcome to_samples(const Sensor& sensor, const msg::Imu& imu, double gravity_mps2, Samples& out);
/// @param datum  place of W, for a message that passes usable_fix()
Outcome to_samples(const Sensor& sensor, const msg::NavSatFix& fix, const Datum& datum, Samples& out);
/// Whether a fix has a place: `queued`, or why not.
Outcome usable_fix(const Sensor& sensor, const msg::NavSatFix& fix);
/// Place of a fix.
/// @param altitude_m  for a fix without one
geodesy::Geodetic place_of(const msg::NavSatFix& fix, double altitude_m);

/// Way and turn from one pose to a later one, in the axes of B at the earlier one, and their covariance; errors of turns are
/// about these axes. With `as_twist` the later sample's covariance is that of its twist.
/// @param dt_s  > 0
struct Movement {
  Pose X_AB;
  Triangle covariance{};
};
Movement movement(const Sample& from, const Sample& to, PoseErrors errors, double dt_s);
/// Turn as axis times angle.
Vec3 turn_vector(Quat q);
/// Twist of B that leads from one pose to a later one: mean over the time between.
/// @param dt_s  > 0
void difference(const Sample& from, const Sample& to, PoseErrors errors, double dt_s, Sample& out);
/// Pose as it is seen from another one, whose errors do not count.
void make_relative(const std::array<double, 6>& first, Sample& sample);

/// Whether a symmetric matrix of m x m, m <= 6, has a Cholesky factor.
bool positive_definite(std::span<const double> matrix, std::size_t m);

}  // namespace sandlot::navigation::ekf
