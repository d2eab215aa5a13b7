#pragma once
/// Where a robot is and how it gets somewhere: estimators, localisation, maps, planners and the navigator that joins them, without a
/// simulator. Messages in, estimates and velocities out. The package `sandlot_navigation` alone is enough to use them.
///
///   SL_ASSIGN(const Node node, parse_yaml(text, "filter.yaml"));            // keys of robot_localization
///   SL_ASSIGN(const auto spec, read_spec<navigation::ekf::Spec>(node));
///   SL_ASSIGN(navigation::ekf::State state, navigation::ekf::begin(spec));
///   navigation::ekf::add(spec, state, 0, odometry);                         // messages as they come
///   navigation::ekf::advance(spec, state, now);
///   const auto estimate = navigation::ekf::estimate(spec, state, now);
#include "base/read.h"
#include "files/yaml.h"
#include "messages/cdr.h"
#include "messages/json.h"
#include "messages/messages.h"
#include "navigation/estimation/ekf.h"
#include "navigation/localisation/amcl.h"
#include "navigation/localisation/scan_odometry.h"
#include "navigation/maps/map_file.h"
#include "navigation/maps/obstacle_layer.h"
#include "navigation/navigator/navigator.h"
#include "navigation/planning/grid_planner.h"
#include "navigation/planning/hybrid_astar.h"
#include "navigation/visual_odometry/mono_odometry.h"
#include "navigation/visual_odometry/stereo_odometry.h"
