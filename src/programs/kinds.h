#pragma once
/// The kinds of programs that come with Sandlot and are not controllers: one line each, the name of the folder. Nothing else
/// knows their names.
// clang-format off
#define SANDLOT_PROGRAMS(program) \
  program(pipe) \
  program(robios) \
  program(remote)
// clang-format on
