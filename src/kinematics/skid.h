#pragma once
/// Skid steering: wheels or tracks on two sides that all point ahead; the robot turns because they slide
/// sideways.
///
///   v = (v_left + v_right) / 2      w = (v_right - v_left) / (x T)      v_y = -w x_pivot
///
/// T is the track (distance of the sides), x the track ratio: the instantaneous centres of rotation of the
/// two sides lie x T apart instead of T, since the treads slip. x >= 1 depends on the ground little, on
/// geometry and load a lot.
///
/// track_ratio() is what isotropic Coulomb friction of any size predicts for turning in place with equal
/// loads: at each wheel slip and friction are parallel, and their moments about the middle cancel when
///
///   sum_i (T c / 2 - x_i^2) / sqrt(c^2 + x_i^2) = 0,   x = 1 + 2 c / T,
///
/// with x_i the wheels of one side from the middle. Four wheels, wheelbase L: x = 1 + (L / T)^2.
///
/// Frame    D: middle between the sides, x forward, y left.
/// Limits   turning in place; on wide arcs, slopes and with a shifted load the true ratio is another one.
/// Cost     track_ratio: some 60 sums over the wheels, once.
/// Source   J. L. Martinez, A. Mandow, J. Morales, S. Pedraza, A. Garcia-Cerezo, Int. J. Robotics Research 24
///          (2005) 867-878 (ICRs of tracks); A. Mandow et al., IROS 2007, 1222-1227 (of wheels); the balance
///          of moments is ours.
#include <span>

#include "kinematics/wheels.h"

namespace sandlot::kinematics {

struct Skid {
  double radius_m = 0.1;   ///< of wheels or sprockets, > 0
  double track_m = 0.5;    ///< > 0
  double track_ratio = 1;  ///< >= 1
  double pivot_x_m = 0;    ///< x of the centres of rotation

  WheelSpeeds inverse(const PlanarMotion& velocity) const;
  PlanarMotion forward(WheelSpeeds speeds) const;
};

/// @param x_m  of the wheels of one side, from the middle; @pre not empty, track > 0
double track_ratio(std::span<const double> x_m, double track_m);

}  // namespace sandlot::kinematics
