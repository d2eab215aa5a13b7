#pragma once
/// The kinds of devices there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_DEVICES(device) \
  device(ackermann_drive)       \
  device(agent_eyes)            \
  device(altimeter)             \
  device(barometer)             \
  device(battery)               \
  device(body_velocity)         \
  device(boundingbox_camera)    \
  device(camera)                \
  device(charger)               \
  device(color_sensor)          \
  device(contact)               \
  device(dc_motor)              \
  device(depth_camera)          \
  device(diff_drive)            \
  device(ear)                   \
  device(force_torque)          \
  device(gps)                   \
  device(gripper)               \
  device(ground_sensor)         \
  device(ground_truth)          \
  device(heading_drive)         \
  device(imu)                   \
  device(infrared)              \
  device(joint_motor)           \
  device(joint_state)           \
  device(joint_trajectory)      \
  device(kicker)                \
  device(lamp)                  \
  device(laser_scanner)         \
  device(laser_scanner_3d)      \
  device(light_sensor)          \
  device(line_camera)           \
  device(magnetometer)          \
  device(mecanum_drive)         \
  device(omni_camera)           \
  device(omni_drive)            \
  device(overhead_camera)       \
  device(pan_tilt)              \
  device(proximity)             \
  device(radio)                 \
  device(range_bearing)         \
  device(range_finder)          \
  device(rgbd_camera)           \
  device(segmentation_camera)   \
  device(skid_drive)            \
  device(stereo_camera)         \
  device(swerve_drive)          \
  device(text_display)          \
  device(thermometer)           \
  device(track_drive)           \
  device(voice)                 \
  device(wheel_encoder)         \
  device(wheel_odometry)
// clang-format on
