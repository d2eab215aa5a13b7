#pragma once
/// Localise: where a robot is in a map, by adaptive Monte Carlo localisation of the navigation library.
///
/// Reads      `laser`, a LaserScan, and `odometry`, an Odometry of wheels or of a program; the topic /ROBOT/initialpose,
///            geometry_msgs/PoseWithCovarianceStamped in `frame`, as RViz and Foxglove publish it.
/// Publishes  `amcl_pose`, geometry_msgs/PoseWithCovarianceStamped in `frame`, at each step once the pose is known: carried on by the
///            odometry since the last scan used, whose covariance it has; none while the odometry is older than `odometry_age`.
///            `map_to_odom`, geometry_msgs/TransformStamped, with it. `particle_cloud`, geometry_msgs/PoseArray, after each scan
///            used.
/// Errors     an initialpose in another frame, off the map, without an orientation or with a covariance that is none is refused: counted, with a warning in the log.
/// Begins     as `begin` says: all over the map (global), at `x`, `y`, `yaw` (pose), or with the first initialpose (topic).
/// Method, errors, limits   navigation/localisation/amcl.h, with the keys of Nav2's AMCL. What became of the scans stands in the
///            state, `localise.filter.counts`. No ground truth is read.
/// Random     numbers are keyed by the run's seed and the controller's path.
/// Limits     an initialpose counts from when it came, whatever its stamp; of several scans in a control step the newest alone
///            counts. Between odometry and scan the robot is taken to keep its velocity.
/// Cost       amcl.h's, at scans after a motion; memory of the map, 8 bytes a cell.
#include <optional>

#include "control/controller.h"
#include "controllers/grid_map.h"
#include "navigation/localisation/amcl.h"

namespace sandlot::controllers::localise {

enum class Begin : std::uint8_t { global, pose, topic };
std::span<const EnumName<Begin>> enum_names(Begin);

struct Spec : navigation::amcl::Spec {
  MapKeys map;
  std::string laser, odometry, frame = "map";
  Begin begin = Begin::global;
  double x_m = 0, y_m = 0, yaw_rad = 0, deviation_m = 0.5, deviation_rad = 0.26;

  static void fields(auto& s, auto&& visit) {
    MapKeys::fields(s.map, visit);
    visit(Field{"laser", "", "Laser scanner, not needed when there is only one.", 0, 0, Field::none, 1000},
          s.laser);
    visit(Field{"odometry", "", "Odometry of wheels or of a program, not needed when there is only one.", 0,
                0, Field::none, 1000},
          s.odometry);
    visit(Field{"frame", "", "Name of the map's frame.", 0, 0, Field::none, 100, 1}, s.frame);
    visit(Field{"begin", "", "Where the robot may be at first: global, pose or topic."}, s.begin);
    visit(Field{"x", "m", "First position along x of the map.", -1e6, 1e6}, s.x_m);
    visit(Field{"y", "m", "First position along y of the map.", -1e6, 1e6}, s.y_m);
    visit(Field{"yaw", "rad", "First heading in the map.", -7, 7}, s.yaw_rad);
    visit(Field{"deviation", "m", "Standard deviation of the first position.", 0, 1e3}, s.deviation_m);
    visit(Field{"deviation_yaw", "rad", "Standard deviation of the first heading.", 0, 10}, s.deviation_rad);
    navigation::amcl::Spec::fields(s, visit);
  }
};

struct State {
  bool begun = false;
  navigation::amcl::State filter;
  std::uint64_t poses = 0, refused = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"begun", "", "Whether the random numbers have their seed."}, s.begun);
    visit(Field{"filter", "", "Particles and the estimate."}, s.filter);
    visit(Field{"poses", "1", "Initial poses taken from clients."}, s.poses);
    visit(Field{"refused", "1", "Initial poses refused: off the map, another frame, bad covariance."},
          s.refused);
  }
};

struct Localiser {
  using Spec = localise::Spec;
  using State = localise::State;
  Spec spec;
  State state;

  Status init(const Description& robot, Outputs& out);
  void step(const Observation& obs, Command& cmd);
  bool fits() const { return model_ && state.filter.fits(*model_); }

 private:
  void start(const Observation& obs);
  void take_pose(const msg::PoseWithCovarianceStamped& message);

  std::optional<navigation::amcl::Model> model_;
  std::optional<navigation::amcl::Workspace> work_;
  Reading<msg::LaserScan> laser_;
  Reading<msg::Odometry> odometry_;
  Pose X_BL_;
  std::string path_;  ///< "rover/localiser"
  Subscription<msg::PoseWithCovarianceStamped> initial_;
  Publication<msg::PoseWithCovarianceStamped> pose_;
  Publication<msg::TransformStamped> transform_;
  Publication<msg::PoseArray> cloud_;
  // Of one step: members for the memory of their texts and lists.
  msg::PoseWithCovarianceStamped pose_out_;
  msg::TransformStamped transform_out_;
  msg::PoseArray cloud_out_;
};

}  // namespace sandlot::controllers::localise
