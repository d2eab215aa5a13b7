#pragma once
/// Elements that Gazebo's drive plugins have in common, for the from_sdf functions of drives.
#include <initializer_list>

#include "devices/sdf_element.h"

namespace sandlot::sdf_element {

/// A number that the plugin leaves unlimited when it is absent.
inline constexpr const char* unlimited = "1e9";

/// Joint names under any of the given element names, repeated ones included.
void copy_joints(const Node& element, std::initializer_list<const char*> names, Node& config,
                 const char* key);

/// <min_linear_velocity>, <max_acceleration> ... as max_linear_speed and so on. Limits given as a minimum and
/// a maximum are symmetrical here: the larger magnitude counts.
Status copy_limits(const Node& element, Node& config, Diagnostics& diagnostics);

/// warn_unknown for a drive plugin: names of topics and frames and the limits of copy_limits are known.
void warn_unknown_of_drive(const Node& element, std::initializer_list<std::string_view> known,
                           const std::string& what, Diagnostics& diagnostics);

}  // namespace sandlot::sdf_element
