#pragma once
/// The kinds of controllers: one line each, name, type and help. Headers are in kinds.cpp.
// clang-format off
#define SELFORG_CONTROLLERS(controller)                                                                        \
  controller(babbling, Babbling, "Moves each motor in sines with random periods.")                             \
  controller(braitenberg, Braitenberg, "Drives motors by weighted sums of sensors.")                           \
  controller(dep, Dep, "Finds behaviour by correlating the velocities of sensors (DEP).")                      \
  controller(experts, Experts, "Homeokinesis with competing experts as long-term memory of behaviours.")       \
  controller(primitives, Primitives, "Solves a task by Q-learning over ready behaviours.")                     \
  controller(replay, Replay, "Sends the motor values of a log file.")                                          \
  controller(semox, Semox, "Homeokinesis in motor space, for robots with many sensors (SeMoX).")               \
  controller(sine, Sine, "Moves motors back and forth, each a little later than the one before it.")           \
  controller(sox, Sox, "Homeokinesis: finds behaviour that is sensitive and predictable (Sox).")
// clang-format on
