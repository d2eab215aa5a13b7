#pragma once
/// The kinds of media there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_MEDIA(medium) \
  medium(infrared)            \
  medium(radio)               \
  medium(shout)               \
  medium(wind)
// clang-format on
