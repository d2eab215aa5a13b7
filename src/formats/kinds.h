#pragma once
/// The file formats there are: one line each. A format NAME defines `const FormatKind NAME_format` in its folder.
// clang-format off
#define SANDLOT_FORMATS(format) \
  format(scenario)              \
  format(sdf)                   \
  format(urdf)                  \
  format(eyesim_world)          \
  format(eyesim_maze)           \
  format(eyesim_robot)          \
  format(eyesim_object)         \
  format(eyesim_scenario)
// clang-format on
