#pragma once
/// SDF's <noise> as keys of noise/range_noise.h, noise/channel_noise.h and noise/axes_noise.h; shared by the from_sdf functions
/// of kinds.
///
/// <stddev> is the error of a sample, <mean> and <bias_mean> are constant, <bias_stddev> is drawn once at the
/// start. <dynamic_bias_stddev> d with <dynamic_bias_correlation_time> T is a density to Gazebo: the bias
/// settles at a deviation of d sqrt(T / 2). <precision> of type gaussian_quantized is the resolution. Gazebo
/// turns the sign of the drawn bias at random; for a mean of zero that is the same thing, else the mean is
/// kept as written.
#include "devices/sdf_element.h"

namespace sandlot::sdf_element {

/// Keys of a RangeNoiseSpec; an empty map for no noise.
Result<Node> range_noise(const Node& noise, Diagnostics& diagnostics);
/// Keys of a ChannelNoiseSpec.
Result<Node> channel_noise(const Node& noise, Diagnostics& diagnostics);

/// Keys of an AxesNoiseSpec from a group of x, y, z with a <noise> each.
Result<Node> axes_noise(const Node& group, Diagnostics& diagnostics);

/// A <lidar> or <ray> of a sensor, or null.
const Node* lidar(const Node& sensor);
/// True when its beams lie in several planes.
bool has_planes(const Node& sensor);
/// Keys that laser scanners have in common: min_angle, max_angle, min_range, max_range, rate, noise.
/// @param sensor  the device's element; `scan` its <lidar> or <ray>
Status copy_scan(const Node& sensor, const Node& scan, Node& config, Diagnostics& diagnostics);
/// <update_rate> as `rate`: 0 when absent, which means every step in SDF and here.
void copy_rate(const Node& element, const char* name, Node& config);
/// The first of several spellings that is present, times a factor.
Status copy_number(const Node& element, std::initializer_list<const char*> names, double factor, Node& config,
                   const char* key);

}  // namespace sandlot::sdf_element
