#pragma once
/// The kinds of devices there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_DEVICES(device) \
  device(ackermann_drive)       \
  device(altimeter)             \
  device(barometer)             \
  device(body_velocity)         \
  device(contact)               \
  device(dc_motor)              \
  device(diff_drive)            \
  device(force_torque)          \
  device(gps)                   \
  device(ground_truth)          \
  device(imu)                   \
  device(joint_motor)           \
  device(joint_state)           \
  device(joint_trajectory)      \
  device(laser_scanner)         \
  device(laser_scanner_3d)      \
  device(magnetometer)          \
  device(mecanum_drive)         \
  device(omni_drive)            \
  device(proximity)             \
  device(range_finder)          \
  device(skid_drive)            \
  device(swerve_drive)          \
  device(track_drive)           \
  device(wheel_encoder)         \
  device(wheel_odometry)
// clang-format on
