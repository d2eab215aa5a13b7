#pragma once
/// The kinds of devices there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_DEVICES(device) \
  device(body_velocity)         \
  device(diff_drive)            \
  device(ground_truth)          \
  device(imu)                   \
  device(joint_motor)           \
  device(joint_state)           \
  device(joint_trajectory)      \
  device(laser_scanner)         \
  device(laser_scanner_3d)      \
  device(range_finder)          \
  device(wheel_encoder)
// clang-format on
