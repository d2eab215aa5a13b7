#pragma once
/// Adaptive Monte Carlo localisation: pose of a robot in a grid map, from odometry and laser scans, by a particle filter.
///
///   const amcl::Model model = *amcl::Model::make(spec, map);   // constant: likelihood field and free cells
///   amcl::State state = amcl::begin(seed);                     // all that changes
///   amcl::Workspace work(model);
///   amcl::spread(model, state);                                // or set_pose(model, state, pose, covariance)
///   amcl::update(model, state, work, {stamp, X_OB, X_BL}, scan);
///   const Pose2 X_MB = amcl::pose_at(state, X_OB);
///
/// A step moves the particles by the odometry (odometry_motion.h), weighs them by the scan, estimates the pose of the
/// heaviest cluster and draws particles again (particles.h).
///
///   beam      p(d) = z_hit exp(-d^2 / (2 sigma_hit^2)) + z_rand / laser_max_range,   d: from its end to the nearest surface
///   scan      weight *= (geometric mean of p over the beams) ^ min(beams, effective_beams)
///   recovery  w: mean of that geometric mean over the particles; slow += alpha_slow (w - slow), fast alike; a share
///             max(0, 1 - fast / slow) of the particles is drawn from the free cells instead, each as the best of some
///             candidates for the scan; so are all at the first scan after spread()
///
/// Frames    M is the map, O `odom`, B base_link, L the laser (REP 105).
/// Random    numbers are keyed by (seed, number of the event, particle): a copy of State goes on the same.
/// Errors    each scan has an Outcome, counted. None stops the filter or changes it silently.
/// Limits    beams without an echo do not count; beams that end off the map count as far from all
///           obstacles, those that end inside a solid one by the distance from its surface (distance_field.h). Moving
///           obstacles are noise (z_rand). Rooms that look alike are told apart only by driving on. The covariance
///           is that of the particles: errors common to all scans (of the map, of the laser's mount) are not in it.
/// Cost      about 0.6 us a particle with 60 beams: 0.4 ms for 500, 1.1 ms for 2000; the first scan after spread() ten times
///           as much. Memory 8 bytes a cell. No allocation after construction.
/// Source    S. Thrun, W. Burgard, D. Fox, Probabilistic Robotics (2005), tables 6.3, 8.3, 8.4; parameters and their
///           defaults: Nav2's AMCL (Humble). effective_beams and recovery_candidates are ours, and recovery is on.
#include "base/node.h"
#include "base/time.h"
#include "navigation/localisation/odometry_motion.h"
#include "navigation/localisation/particles.h"
#include "navigation/localisation/scan_points.h"
#include "navigation/maps/occupancy.h"

namespace sandlot::navigation::amcl {

struct Spec {
  MotionModel motion_model = MotionModel::differential;
  MotionNoise noise;
  int min_particles = 500, max_particles = 2000;
  double kld_error = 0.05, kld_quantile = 2.33;
  int max_beams = 60;
  double effective_beams = 10;
  double laser_min_range_m = 0, laser_max_range_m = 100;
  double z_hit = 0.5, z_rand = 0.5, sigma_hit_m = 0.2, likelihood_max_distance_m = 2;
  double update_min_d_m = 0.25, update_min_a_rad = 0.2;
  int resample_interval = 1;
  double alpha_slow = 0.05, alpha_fast = 0.3;
  int recovery_candidates = 10;
  int occupied_percent = 65, free_percent = 25;
  double odometry_age_s = 0.1, odometry_jump_m = 5, time_jump_s = 1;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"robot_model_type", "", "Motion model: differential or omnidirectional."}, s.motion_model);
    visit(Field{"alpha1", "1", "Variance of the turn per squared turn.", 0, 100}, s.noise.alpha1);
    visit(Field{"alpha2", "rad^2/m^2", "Variance of the turn per squared drive.", 0, 100}, s.noise.alpha2);
    visit(Field{"alpha3", "1", "Variance of the drive per squared drive.", 0, 100}, s.noise.alpha3);
    visit(Field{"alpha4", "m^2/rad^2", "Variance of the drive per squared turn.", 0, 100}, s.noise.alpha4);
    visit(Field{"alpha5", "1", "Variance across the drive per squared drive; omnidirectional only.", 0, 100},
          s.noise.alpha5);
    visit(Field{"min_particles", "1", "Least number of particles.", 1, 1e6}, s.min_particles);
    visit(Field{"max_particles", "1", "Greatest number of particles.", 1, 1e6}, s.max_particles);
    visit(Field{"pf_err", "1", "Bound of the Kullback-Leibler distance that the number of particles keeps.",
                1e-4, 10},
          s.kld_error);
    visit(Field{"pf_z", "1", "Upper quantile of the normal distribution with which it is kept.", 0, 10},
          s.kld_quantile);
    visit(Field{"max_beams", "1", "Number of beams that are used, taken evenly.", 1, 10'000}, s.max_beams);
    visit(Field{"effective_beams", "1", "Number of independent beams that a scan counts for.", 0.01, 10'000},
          s.effective_beams);
    visit(Field{"laser_min_range", "m", "Shortest distance that is used.", 0, 1e4}, s.laser_min_range_m);
    visit(Field{"laser_max_range", "m", "Longest distance that is used.", 0.01, 1e4}, s.laser_max_range_m);
    visit(Field{"z_hit", "1", "Weight of beams that end at a wall of the map.", 0, 1}, s.z_hit);
    visit(Field{"z_rand", "1", "Weight of beams that end anywhere.", 1e-3, 1}, s.z_rand);
    visit(Field{"sigma_hit", "m", "Standard deviation of a beam's end from its wall.", 1e-3, 100},
          s.sigma_hit_m);
    visit(Field{"laser_likelihood_max_dist", "m", "Greatest distance from obstacles that is told apart.",
                1e-3, 1e3},
          s.likelihood_max_distance_m);
    visit(Field{"update_min_d", "m", "Drive after which a scan is used.", 0, 100}, s.update_min_d_m);
    visit(Field{"update_min_a", "rad", "Turn after which a scan is used.", 0, 2 * math::pi},
          s.update_min_a_rad);
    visit(Field{"resample_interval", "1", "Number of scans after which particles are drawn again.", 1, 1000},
          s.resample_interval);
    visit(Field{"recovery_alpha_slow", "1", "Gain of the slow mean of weights. 0: no recovery.", 0, 1},
          s.alpha_slow);
    visit(Field{"recovery_alpha_fast", "1", "Gain of the fast mean of weights.", 0, 1}, s.alpha_fast);
    visit(Field{"recovery_candidates", "1",
                "Random poses of which the one that fits the scan best becomes a random particle.", 1, 1000},
          s.recovery_candidates);
    visit(Field{"occupied", "%", "Occupancy from which a cell is an obstacle.", 1, 100}, s.occupied_percent);
    visit(Field{"free", "%", "Occupancy up to which a known cell is free.", 0, 99}, s.free_percent);
    visit(Field{"odometry_age", "s", "Greatest difference of the stamps of scan and odometry.", 0, 10},
          s.odometry_age_s);
    visit(Field{"odometry_jump", "m", "Step of the odometry that counts as its restart.", 0.01, 1e4},
          s.odometry_jump_m);
    visit(Field{"time_jump", "s", "Step back of the stamps that counts as a restart of the clock.", 0, 1e4},
          s.time_jump_s);
  }
  Status check(const Node& node, const std::string& path) const;
};

/// Answer to a scan.
enum class Outcome : std::uint8_t {
  updated,         ///< corrected the estimate
  waiting,         ///< the robot has not moved enough since the last one used
  uninitialised,   ///< neither set_pose() nor spread() was called
  jumped,          ///< the odometry jumped since the scan before: it counts from here now, the jump does not
  rewound,         ///< the stamps jumped back: time and odometry count from here now
  late,            ///< is not newer than the last one used
  bad_stamp,       ///< has a negative stamp or one after the year 2096
  unsynchronised,  ///< odometry is of another time
  bad_odometry,    ///< odometry is not finite or above 1e6 m
  bad_scan,        ///< as ScanFault
  bad_mount,       ///< as ScanFault
  no_beams,        ///< as ScanFault
};
inline constexpr std::size_t outcomes = 12;
std::span<const EnumName<Outcome>> enum_names(Outcome);

/// Likelihood field and free cells of a map: constant.
class Model {
 public:
  /// Errors: ranges and rules of the spec, the geometry, data that does not fit the size, no occupied or no free cell.
  static Result<Model> make(const Spec& spec, const GridMap& map);

  const Spec& spec() const { return spec_; }
  const GridGeometry& geometry() const { return geometry_; }
  /// Logarithm of p(d) for a beam that ends at a point.
  double log_likelihood(Vec2 end_M) const;
  /// Mean over the points of a scan of that logarithm.
  double mean_log_likelihood(std::span<const Vec2> points_B, const Pose2& X_MB) const;
  /// Random pose in a free cell.
  Pose2 free_pose(Stream& random) const;

 private:
  Model(const Spec& spec, const GridGeometry& geometry)
      : spec_(spec), geometry_(geometry), frame_(geometry) {}
  Spec spec_;
  GridGeometry geometry_;
  GridFrame frame_;
  std::vector<float> log_likelihood_;  ///< for each cell
  double log_lowest_ = 0;              ///< off the map
  std::vector<std::uint32_t> free_;    ///< indices of the free cells
};

struct Estimate {
  bool known = false;  ///< false: nothing but a spread over the map
  Pose2 pose;          ///< X_MB at the last scan used: mean of the heaviest cluster
  Covariance3 covariance{};
  double share = 0;            ///< of the weight in this cluster
  std::uint32_t clusters = 0;  ///< 1: the robot is somewhere about `pose`
  double fit = 0;              ///< geometric mean of p over beams, mean over the cluster's particles

  static void fields(auto& s, auto&& visit) {
    visit(Field{"known", "", "Whether a scan or a pose was given."}, s.known);
    visit(Field{"x", "m", "Position along x of the map."}, s.pose.x);
    visit(Field{"y", "m", "Position along y of the map."}, s.pose.y);
    visit(Field{"theta", "rad", "Heading."}, s.pose.theta);
    visit(Field{"covariance", "", "Covariance of x, y and theta, row by row."}, s.covariance);
    visit(Field{"share", "1", "Part of the particles' weight in the heaviest cluster."}, s.share);
    visit(Field{"clusters", "1", "Number of clusters."}, s.clusters);
    visit(Field{"fit", "1", "Mean likelihood of a beam."}, s.fit);
  }
};

struct State {
  std::uint64_t seed = 0;
  std::uint64_t events = 0;   ///< updates and initialisations: keys of the random numbers
  std::uint64_t updates = 0;  ///< since the last initialisation
  bool has_odometry = false;
  Time at;            ///< of the last scan used
  Pose2 X_OB;         ///< odometry at that time
  Pose2 latest_X_OB;  ///< odometry of the last scan, used or not
  std::vector<Particle> particles;
  double slow = 0, fast = 0;   ///< means of the likelihood of a beam, for recovery
  std::uint64_t injected = 0;  ///< random particles drawn by recovery, in all
  Estimate estimate;
  std::array<std::uint64_t, outcomes> counts{};
  Outcome last = Outcome::uninitialised;
  std::uint64_t count(Outcome o) const { return counts[static_cast<std::size_t>(o)]; }

  static void fields(auto& s, auto&& visit) {
    visit(Field{"seed", "1", "Seed of the random numbers."}, s.seed);
    visit(Field{"events", "1", "Number of updates and initialisations."}, s.events);
    visit(Field{"updates", "1", "Number of scans used since the last initialisation."}, s.updates);
    visit(Field{"has_odometry", "", "Whether there is odometry to count from."}, s.has_odometry);
    visit(Field{"at", "s", "Stamp of the last scan used."}, s.at);
    visit(Field{"odometry_x", "m", "Position along x of odom at that time."}, s.X_OB.x);
    visit(Field{"odometry_y", "m", "Position along y of odom at that time."}, s.X_OB.y);
    visit(Field{"odometry_theta", "rad", "Heading in odom at that time."}, s.X_OB.theta);
    visit(Field{"latest_x", "m", "Position along x of odom at the latest scan."}, s.latest_X_OB.x);
    visit(Field{"latest_y", "m", "Position along y of odom at the latest scan."}, s.latest_X_OB.y);
    visit(Field{"latest_theta", "rad", "Heading in odom at the latest scan."}, s.latest_X_OB.theta);
    visit(Field{"particles", "", "Particles.", 0, 0, Field::none, 1'000'000}, s.particles);
    visit(Field{"slow", "1", "Slow mean of the likelihood of a beam."}, s.slow);
    visit(Field{"fast", "1", "Fast mean of the likelihood of a beam."}, s.fast);
    visit(Field{"injected", "1", "Number of random particles drawn by recovery."}, s.injected);
    visit(Field{"estimate", "", "Estimate after the last scan used."}, s.estimate);
    visit(
        Field{"counts", "1",
              "Scans that updated, waited for motion, came before an initial pose, met a jump of odometry or "
              "clock, were late, had a bad stamp, odometry of another time, bad odometry, bad angles, a bad "
              "mount, no beams."},
        s.counts);
    visit(Field{"last", "", "Outcome of the latest scan."}, s.last);
  }
  /// Whether the state can be one of this model, for bytes that may be damaged.
  bool fits(const Model& model) const;
};

/// Memory of update(), whose content does not outlast a call.
struct Workspace {
  explicit Workspace(const Model& model);
  ScanPoints scan;
  PoseBins bins;
  std::vector<Particle> drawn;
  std::vector<double> weights, fit;
  std::vector<std::uint32_t> picks, bin;
};

State begin(std::uint64_t seed);

/// Particles about a pose. Errors: a pose that is not finite or off the map; a covariance that is not finite, symmetric
/// and positive semi-definite. They change nothing.
Status set_pose(const Model& model, State& state, const Pose2& X_MB, const Covariance3& covariance);

/// Particles all over the free cells, of any heading.
void spread(const Model& model, State& state);

/// Where the robot was when a scan was taken.
struct Moment {
  Time odometry_stamp;
  Pose2 X_OB;
  Pose X_BL;  ///< mount of the laser
};
Outcome update(const Model& model, State& state, Workspace& work, const Moment& moment,
               const msg::LaserScan& scan);

/// X_MO at the last scan used, for the transform from map to odom.
Pose2 map_to_odom(const State& state);
/// X_MB for odometry that is newer than the last scan used; the initial pose before the first one.
Pose2 pose_at(const State& state, const Pose2& X_OB);

}  // namespace sandlot::navigation::amcl
