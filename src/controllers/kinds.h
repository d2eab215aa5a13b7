#pragma once
/// The controllers that come with Sandlot: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_CONTROLLERS(controller) \
  controller(diffusion)                 \
  controller(formation)                 \
  controller(odometry_estimator)        \
  controller(playback)                  \
  controller(seeker)                    \
  controller(sequence)                  \
  controller(sine)                      \
  controller(wander)                    \
  controller(waypoints)
// clang-format on
