#pragma once
/// Wander: drives about without touching anything, by a planar laser scan alone.
///
/// Reads    a LaserScan of any number of beams over 120 degrees or more, facing forward.
/// Orders   a Twist for a drive that can turn on the spot about its centre.
/// Method   The scan is reduced to sectors of about 3 degrees (the nearest echo of each; a gap between sparse beams
///          takes the nearer neighbour). For candidate headings the free length of a corridor as wide as the robot is
///          computed; the best trades length against leaving the drifting favourite heading and against changing its
///          mind. Where no heading is free the robot turns on the spot, towards the freer side, and keeps to that
///          side until the way ahead is clear. Speed obeys a barrier for every echo at distance d and bearing b:
///          v cos(b) <= (d - radius - margin / 2) / reaction_s, so the gap can only shrink exponentially. What a
///          narrow scanner loses sight of is remembered for 3 s, moved by the orders given since.
/// Stuck    When neither the echo straight ahead nor the scan as a whole changes as driving should change them, or the
///          scan stays as it is while the robot should turn, it backs up the way it came and turns to a random side.
/// Limits   sees only what the scanner's plane sees; no map, so coverage is that of a random walk; obstacles that move
///          faster than the robot can hit it.
/// Cost     about 40 headings x 120 sectors per step; no allocation after the first scan.
/// Source   corridor test and gap choice after J. Minguez, L. Montano, Nearness Diagram Navigation, IEEE Trans.
///          Robotics and Automation 20(1), 2004; the barrier is the first-order form of A. Ames et al., Control
///          Barrier Functions: Theory and Applications, ECC 2019, sec. II.
#include "control/controller.h"

namespace sandlot::controllers::wander {

struct Spec {
  std::string laser, drive;
  double radius_m = 0.25;
  double margin_m = 0.1;
  double speed_mps = 0.5;
  double turn_speed_radps = 1.2;
  double lookahead_m = 2.5;
  double reaction_s = 0.6;

  static void fields(auto& s, auto&& visit) {
    constexpr unsigned tunable = Field::tunable;
    visit(Field{"laser", "", "Laser scanner to use; empty: the only one.", 0, 0, Field::none, 1000}, s.laser);
    visit(Field{"drive", "", "Drive to use; empty: the only one.", 0, 0, Field::none, 1000}, s.drive);
    visit(Field{"radius", "m", "Radius of the circle about its centre that contains the robot.", 0.01, 100,
                tunable},
          s.radius_m);
    visit(Field{"margin", "m", "Distance kept beyond the radius where there is room.", 0, 100, tunable},
          s.margin_m);
    visit(Field{"speed", "m/s", "Speed in free space.", 0, 100, tunable}, s.speed_mps);
    visit(Field{"turn_speed", "rad/s", "Largest turning rate.", 0.01, 100, tunable}, s.turn_speed_radps);
    visit(Field{"lookahead", "m", "Distance beyond which free space makes no difference.", 0.1, 100, tunable},
          s.lookahead_m);
    visit(Field{"reaction", "s", "Shortest time in which a gap in front may be used up.", 0.05, 60, tunable},
          s.reaction_s);
  }
};

enum class Mode : std::uint8_t { cruise, turn, back };

struct State {
  Mode mode = Mode::cruise;
  double mode_s = 0;                  ///< time in the present mode
  double turn_min_s = 0;              ///< the present turn lasts at least this long
  double turn_sign = 1;               ///< +1: left
  double favourite_rad = 0;           ///< heading the robot likes, relative to its own
  double favourite_left_s = 0;        ///< time until it likes another one
  double heading_rad = 0;             ///< chosen in the previous step
  double blind_s = 1e9;               ///< time since the last scan
  double v_mps = 0, omega_radps = 0;  ///< ordered in the previous step
  std::vector<std::array<float, 3>>
      memory;                           ///< x [m], y [m], age [s] of echoes out of view, in the robot's frame
  double driven_m = 0, turned_rad = 0;  ///< ordered since `before` was taken
  std::vector<float> before;            ///< sector distances to compare with

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mode", "", "Current behaviour."}, s.mode);
    visit(Field{"mode_time", "s", "Time since the behaviour began."}, s.mode_s);
    visit(Field{"turn_min", "s", "Least duration of the turn."}, s.turn_min_s);
    visit(Field{"turn_sign", "1", "Direction of the turn."}, s.turn_sign);
    visit(Field{"favourite", "rad", "Preferred heading."}, s.favourite_rad);
    visit(Field{"favourite_left", "s", "Time until another heading is preferred."}, s.favourite_left_s);
    visit(Field{"heading", "rad", "Heading chosen last."}, s.heading_rad);
    visit(Field{"blind", "s", "Time since the last scan."}, s.blind_s);
    visit(Field{"linear", "m/s", "Speed commanded in the previous step."}, s.v_mps);
    visit(Field{"angular", "rad/s", "Turning rate commanded in the previous step."}, s.omega_radps);
    visit(Field{"memory", "", "Echoes out of view: x, y and age of each."}, s.memory);
    visit(Field{"driven", "m", "Distance commanded since the scan used for comparison."}, s.driven_m);
    visit(Field{"turned", "rad", "Turn commanded since the scan used for comparison."}, s.turned_rad);
    visit(Field{"before", "m", "Scan used for comparison."}, s.before);
  }
};

/// A scan reduced to sectors, in the robot's frame. Scratch: computed from each message.
struct Sectors {
  struct Echo {
    double x_m, y_m;  ///< of the echo
    double range_m;   ///< from the robot's centre
    bool seen;        ///< false: nothing within the scanner's range
  };
  std::vector<Echo> echoes;       ///< by bearing from the scanner, right to left; then what is remembered
  std::vector<float> distance_m;  ///< from the scanner; its maximum where nothing was seen
  float max_m = 0;                ///< range of the scanner
  double first_rad = 0, last_rad = 0;  ///< bearings covered, in the robot's frame
  std::vector<float> own_m;            ///< per beam: an echo nearer than this is of the robot itself

  /// Learns how far each beam of such a scan runs within `own_radius_m` of the robot's centre.
  void learn_own_body(const msg::LaserScan& scan, const Pose& X_BS, double own_radius_m);
  void fill(const msg::LaserScan& scan, const Pose& X_BS);
  /// Length free for a disc that moves along `heading_rad` from the robot's centre, at most `most_m`.
  double corridor_m(double heading_rad, double half_width_m, double most_m) const;
};

struct Wander {
  using Spec = wander::Spec;
  using State = wander::State;
  Spec spec;
  State state;

  double period_s = 0.1;
  Reading<msg::LaserScan> laser;
  Actuator<msg::Twist> drive;
  Pose X_BS;
  Sectors sectors;

  Status init(const Description& robot);
  void step(const Observation& obs, Command& cmd);

 private:
  struct Motion {
    double v_mps = 0, omega_radps = 0;
  };
  Motion cruise(Stream& random);
  Motion turn(Stream& random);
  Motion back();
  void enter(Mode mode, Stream& random);
  void remember();
  bool stuck();
  double safe_speed(double wanted_mps) const;
};

}  // namespace sandlot::controllers::wander
