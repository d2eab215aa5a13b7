#pragma once
/// Pose of a robot from one laser scan and a map of walls.
///
/// Point to line: each point of the scan belongs to the wall nearest to it, if one is within `reach`; the
/// pose that makes the sum of squared distances least is found by Gauss-Newton steps, and walls are chosen
/// again until nothing moves.
///
/// Frame    the map's. Scans are in the laser's frame, X_BL is the laser's pose on the robot.
/// Limits   finds the place near a first guess (half a metre, 20 degrees in rooms); directions in which the
///          walls give no information (a corridor's length) keep the guess.
/// Source   A. Censi, An ICP variant using a point-to-line metric (2008).
#include <array>
#include <span>
#include <vector>

#include "geometry/pose.h"
#include "messages/sensor_ranges.h"

namespace sandlot::perception {

struct Wall {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct Pose2 {
  double x = 0, y = 0, theta = 0;
};

struct ScanMatch {
  Pose2 pose;
  double rms_m = 0;  ///< of the distances of points from their walls
  int points = 0;    ///< that have one
  int steps = 0;
  bool converged = false;
};

/// @param reach_m  points farther from every wall are somebody else
ScanMatch match_scan(const msg::LaserScan& scan, const Pose& X_BL, std::span<const Wall> walls, Pose2 guess,
                     double reach_m = 0.6);

}  // namespace sandlot::perception
