#pragma once
/// The kinds of rules there are: one line each, the name of the folder. Nothing else knows their names.
// clang-format off
#define SANDLOT_RULES(rule) \
  rule(coverage)            \
  rule(energy)              \
  rule(episodes)            \
  rule(goals)               \
  rule(impact)              \
  rule(path)                \
  rule(place)               \
  rule(referee)             \
  rule(set)                 \
  rule(statistics)          \
  rule(zone)
// clang-format on
