#pragma once
/// The kinds of devices there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_DEVICES(device) \
  device(diff_drive)            \
  device(ground_truth)          \
  device(joint_motor)           \
  device(laser_scanner)         \
  device(wheel_encoder)
// clang-format on
