#pragma once
/// The controllers that come with Sandlot: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_CONTROLLERS(controller) \
  controller(carrier)                   \
  controller(carriers)                  \
  controller(clearing)                  \
  controller(diffusion)                 \
  controller(disturber)                 \
  controller(estimate)                  \
  controller(footballer)                \
  controller(forager)                   \
  controller(formation)                 \
  controller(four_wheel_steer)          \
  controller(localise)                  \
  controller(navigate)                  \
  controller(odometry_estimator)        \
  controller(playback)                  \
  controller(predator)                  \
  controller(prey)                      \
  controller(seeker)                    \
  controller(selforg)                   \
  controller(sequence)                  \
  controller(sine)                      \
  controller(soccer_player)             \
  controller(visual_odometry)           \
  controller(wander)                    \
  controller(waypoints)
// clang-format on
