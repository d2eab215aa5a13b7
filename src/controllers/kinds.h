#pragma once
/// The controllers that come with Sandlot: one line each, the name of the folder. Nothing else knows their names.
#define SANDLOT_CONTROLLERS(controller) \
  controller(wander)                    \
  controller(waypoints)
