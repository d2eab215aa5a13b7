#pragma once
/// Tracker of moving discs: people, robots and other small obstacles in the scans of a laser.
///
/// Neighbouring echoes no further apart than `gap` are one object; objects up to `max_radius` whose edges no
/// nearer obstacle hides are followed by nearest neighbours, with a filter of constant velocity on each axis. An
/// object counts as moving once it is faster than `min_speed` and has left the place where it was first seen by
/// `min_way` and its radius, which the change of the visible part of a thing that stands does not reach.
///
/// Frame    M, the map's.
/// Errors   none: a scan without echoes ages the tracks.
/// Limits   at most max_tracks; objects at the first or last beam are left out; objects that cross nearer than their gap are mixed up; one that is hidden goes on
///          with its velocity for `keep_time`, then it is forgotten.
/// Cost     objects times tracks, some ten microseconds; no allocation once lists have grown.
/// Source   Y. Bar-Shalom, X. R. Li, T. Kirubarajan, Estimation with Applications to Tracking and Navigation
///          (2001), sec. 6.3 (white noise acceleration).
#include <span>
#include <vector>

#include "navigation/maps/obstacle_layer.h"
#include "navigation/planning/dwa.h"

namespace sandlot::navigation {

struct TrackerSpec {
  double gap_m = 0.25, max_radius_m = 0.5, match_m = 0.5;
  double min_speed_mps = 0.15, min_way_m = 0.25, keep_s = 0.7;
  double position_std_m = 0.04, acceleration_std_mps2 = 0.4;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"gap", "m", "Distance of neighbouring echoes of one object.", 0.01, 10}, s.gap_m);
    visit(Field{"max_radius", "m", "Radius of the largest object that is tracked.", 0.01, 10},
          s.max_radius_m);
    visit(
        Field{"match", "m", "Distance from its predicted place at which an object is recognised.", 0.01, 10},
        s.match_m);
    visit(Field{"min_speed", "m/s", "Speed from which an object counts as moving.", 0.01, 10},
          s.min_speed_mps);
    visit(Field{"min_way", "m", "Way from its first place after which an object counts as moving.", 0, 10},
          s.min_way_m);
    visit(Field{"keep_time", "s", "Time for which a hidden object is remembered.", 0, 60}, s.keep_s);
    visit(Field{"position_std", "m", "Standard deviation of an object's measured centre.", 1e-4, 10},
          s.position_std_m);
    visit(Field{"acceleration_std", "m/s^2", "Standard deviation of an object's acceleration.", 1e-3, 100},
          s.acceleration_std_mps2);
  }
};

struct Track {
  double x_m = 0, y_m = 0, vx_mps = 0, vy_mps = 0, radius_m = 0;
  double pp = 0, pv = 0, vv = 1;  ///< covariance of place and velocity, the same on both axes
  double first_x_m = 0, first_y_m = 0;
  double unseen_s = 0;
  std::uint32_t seen = 0;
  bool moving = false;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"x", "m", "Place of the object, x."}, s.x_m);
    visit(Field{"y", "m", "Place of the object, y."}, s.y_m);
    visit(Field{"vx", "m/s", "Velocity of the object along x."}, s.vx_mps);
    visit(Field{"vy", "m/s", "Velocity of the object along y."}, s.vy_mps);
    visit(Field{"radius", "m", "Radius of the object."}, s.radius_m);
    visit(Field{"pp", "m^2", "Variance of the place."}, s.pp);
    visit(Field{"pv", "m^2/s", "Covariance of place and velocity."}, s.pv);
    visit(Field{"vv", "m^2/s^2", "Variance of the velocity."}, s.vv);
    visit(Field{"first_x", "m", "Place where the object was first seen, x."}, s.first_x_m);
    visit(Field{"first_y", "m", "Place where the object was first seen, y."}, s.first_y_m);
    visit(Field{"unseen", "s", "Time since the object was last seen."}, s.unseen_s);
    visit(Field{"seen", "1", "Number of scans that showed the object."}, s.seen);
    visit(Field{"moving", "", "Whether the object counts as moving."}, s.moving);
  }
};

struct TrackerState {
  static constexpr std::size_t max_tracks = 64;
  std::vector<Track> tracks;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"tracks", "", "Objects that are followed.", 0, 0, Field::none, max_tracks}, s.tracks);
  }
};

/// Moves the tracks on by a time.
void predict(const TrackerSpec& spec, TrackerState& state, double dt_s);
/// Takes the echoes of a scan, in order of its beams.
void update(const TrackerSpec& spec, TrackerState& state, std::span<const Echo> echoes);
/// Objects that move. @param out  replaced
void moving_discs(const TrackerState& state, std::vector<MovingDisc>& out);

}  // namespace sandlot::navigation
