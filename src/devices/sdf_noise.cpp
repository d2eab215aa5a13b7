#include "devices/sdf_noise.h"

#include <cmath>

#include "base/text.h"

namespace sandlot::sdf_element {
namespace {

struct Read {
  double stddev = 0, mean = 0, bias_stddev = 0, drift = 0, precision = 0;
  double correlation_s = 1;
};

/// Nothing when the element has no noise.
Result<std::optional<Read>> read_sdf_noise(const Node& noise, Diagnostics& diagnostics) {
  const Node* const type = find(noise, "type") ? find(noise, "type") : find(noise, "@type");
  const std::string name = text(type);
  if (name == "none" || (name.empty() && !find(noise, "stddev"))) return std::optional<Read>();
  if (!name.empty() && name != "gaussian" && name != "gaussian_quantized") {
    diagnostics.warn(
        noise.error("noise of type '" + name.substr(0, 40) + "' is not supported and has no effect"));
    return std::optional<Read>();
  }
  warn_unknown(noise,
               {"type", "mean", "stddev", "bias_mean", "bias_stddev", "dynamic_bias_stddev",
                "dynamic_bias_correlation_time", "precision"},
               "<noise>", diagnostics);
  Read out;
  const auto take = [&](const char* key, double& value) -> Status {
    SL_ASSIGN(const auto found, number(noise, key));
    if (found) value += *found;
    return {};
  };
  double drift_density = 0, correlation_s = 0;
  SL_TRY(take("stddev", out.stddev));
  SL_TRY(take("mean", out.mean));
  SL_TRY(take("bias_mean", out.mean));
  SL_TRY(take("bias_stddev", out.bias_stddev));
  SL_TRY(take("dynamic_bias_stddev", drift_density));
  SL_TRY(take("dynamic_bias_correlation_time", correlation_s));
  if (drift_density > 0 && correlation_s > 0) {
    out.drift = drift_density * std::sqrt(0.5 * correlation_s);
    out.correlation_s = correlation_s;
  }
  if (name == "gaussian_quantized") SL_TRY(take("precision", out.precision));
  return std::optional<Read>(out);
}

void set_drift(const Read& read, const Node& noise, Node& keys) {
  if (read.drift == 0) return;
  Node bias = Node::map(noise.place());
  bias.set("bias_std", scalar(read.drift, noise));
  bias.set("correlation", scalar(read.correlation_s, noise));
  keys.set("bias", std::move(bias));
}

void set_nonzero(double value, const Node& noise, Node& keys, const char* key) {
  if (value != 0) keys.set(key, scalar(value, noise));
}

}  // namespace

Result<Node> range_noise(const Node& noise, Diagnostics& diagnostics) {
  Node keys = Node::map(noise.place());
  SL_ASSIGN(const auto read_noise, read_sdf_noise(noise, diagnostics));
  if (!read_noise) return keys;
  set_nonzero(read_noise->stddev, noise, keys, "white");
  set_nonzero(read_noise->mean, noise, keys, "mean");
  // A uniform error of half-width sqrt(3) s has the deviation s.
  set_nonzero(read_noise->bias_stddev * std::sqrt(3.0), noise, keys, "systematic");
  set_nonzero(read_noise->precision, noise, keys, "resolution");
  set_drift(*read_noise, noise, keys);
  return keys;
}

Result<Node> channel_noise(const Node& noise, Diagnostics& diagnostics) {
  Node keys = Node::map(noise.place());
  SL_ASSIGN(const auto read_noise, read_sdf_noise(noise, diagnostics));
  if (!read_noise) return keys;
  set_nonzero(read_noise->stddev, noise, keys, "white");
  set_nonzero(read_noise->mean, noise, keys, "mean");
  set_nonzero(read_noise->bias_stddev, noise, keys, "mean_std");
  set_nonzero(read_noise->precision, noise, keys, "resolution");
  set_drift(*read_noise, noise, keys);
  return keys;
}

const Node* lidar(const Node& sensor) {
  const Node* const found = find(sensor, "lidar");
  return found ? found : find(sensor, "ray");
}

bool has_planes(const Node& sensor) {
  const Node* const rays = lidar(sensor);
  if (!rays) return false;
  const auto planes = number(*rays, "scan/vertical/samples");
  return planes && planes->value_or(1) > 1;
}

Result<Node> axes_noise(const Node& group, Diagnostics& diagnostics) {
  Node keys = Node::map(group.place());
  for (const char* axis : {"x", "y", "z"}) {
    const Node* const noise = find(group, std::string(axis) + "/noise");
    if (!noise) continue;
    SL_ASSIGN(Node errors, channel_noise(*noise, diagnostics));
    if (!errors.entries().empty()) keys.set(axis, std::move(errors));
  }
  return keys;
}

Status copy_scan(const Node& sensor, const Node& scan, Node& config, Diagnostics& diagnostics) {
  copy(scan, "scan/horizontal/min_angle", config, "min_angle");
  copy(scan, "scan/horizontal/max_angle", config, "max_angle");
  copy(scan, "range/min", config, "min_range");
  copy(scan, "range/max", config, "max_range");
  copy_rate(sensor, "update_rate", config);
  if (const Node* const noise = find(scan, "noise")) {
    SL_ASSIGN(Node errors, range_noise(*noise, diagnostics));
    if (!errors.entries().empty()) config.set("noise", std::move(errors));
  }
  return {};
}

void copy_rate(const Node& element, const char* name, Node& config) {
  const Node* const rate = find(element, name);
  config.set("rate", Node::scalar(rate ? text(rate) : "0", rate ? rate->place() : element.place()));
}

Status copy_number(const Node& element, std::initializer_list<const char*> names, double factor, Node& config,
                   const char* key) {
  for (const char* name : names) {
    SL_ASSIGN(const auto value, number(element, name));
    if (!value) continue;
    config.set(key, scalar(*value * factor, *find(element, name)));
    return {};
  }
  return {};
}

}  // namespace sandlot::sdf_element
