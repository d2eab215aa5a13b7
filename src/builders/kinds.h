#pragma once
/// The builders that come with Sandlot: one line each, the name of the folder. Nothing else knows their
/// names.
// clang-format off
#define SANDLOT_BUILDERS(builder) \
  builder(two_wheeled)            \
  builder(four_wheeled)           \
  builder(sphere_robot)           \
  builder(barrel_robot)           \
  builder(snake)                  \
  builder(slider_wheelie)         \
  builder(armband)                \
  builder(hexapod)                \
  builder(dog)                    \
  builder(humanoid)               \
  builder(wheel_chain)            \
  builder(diff_robot)             \
  builder(blade_robot)            \
  builder(skid_robot)             \
  builder(ackermann_robot)        \
  builder(omni_robot)             \
  builder(msl_robot)              \
  builder(mecanum_robot)          \
  builder(swerve_robot)           \
  builder(tracked_robot)          \
  builder(square_playground)      \
  builder(octagon_playground)     \
  builder(terrain)                \
  builder(basin)                  \
  builder(box_pile)               \
  builder(block)                  \
  builder(soccer_field)           \
  builder(soccer_goal)            \
  builder(seesaw)                 \
  builder(stairs)
// clang-format on
