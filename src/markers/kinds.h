#pragma once
/// The kinds of markers there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_MARKERS(marker) \
  marker(disc)                  \
  marker(grid)                  \
  marker(line)                  \
  marker(polygon)
// clang-format on
