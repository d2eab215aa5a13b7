#pragma once
/// Settings of devices, and abilities of kinds, read without knowing the kind: for checks, listings and errors.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"

namespace sandlot {

struct Kind;

/// A number that a device was given, or its kind's default, by path: "max_linear_speed", "position/p". Nothing when the
/// kind has no such number, or it is optional and not given.
std::optional<double> setting(const model::DeviceDecl& device, std::string_view path);

/// Gives a device a rate, unless its keys or those of its preset give one, or its kind has none.
void set_default_rate(model::DeviceDecl& device, double rate_hz, const Place& place);

/// Joints that a device names in keys that end in "joint" or "joints", as indices of the model, in file order.
std::vector<std::uint32_t> joints_of(const model::DeviceDecl& device, const model::Model& model);

/// Whether devices of a kind take commands and have a hand in every sub-step.
bool drives(const Kind& kind);
/// Joints that a device of such a kind drives: those it names; where its list of joints may be left out and is, all that can turn
/// or slide.
std::vector<std::uint32_t> driven_joints(const model::DeviceDecl& device, const Kind& kind,
                                         const model::Model& model);

/// Kinds with a level that publishes messages of a type, or takes commands of it: "a, b or c"; "" for none.
std::string kinds_with(std::string_view message_type, bool commands);

}  // namespace sandlot
