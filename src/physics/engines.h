#pragma once
/// The engines there are: one line each. `find_engine` and `sandlot list engines` use this table.
// clang-format off
#define SANDLOT_ENGINES(engine) \
  engine(rigid)                 \
  engine(planar)
// clang-format on
