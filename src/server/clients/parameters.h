#pragma once
/// Tunable fields of devices and programs as parameters by name: "rover/laser.noise.white", "rover/controller.speed".
///
/// Names     those of addresses (docs/values.md): parts behind the first dot, elements as "[3]" or ".3".
/// Values    numbers and bools; lists of numbers with a length.
/// Limits    list_parameters() leaves out fields inside lists of maps (stages of noise): they can be read and set by name.
/// Threads   the simulation's, for what takes a Simulation.
#include <span>
#include <vector>

#include "sim/world/simulation.h"
#include "wire/foxglove.h"

namespace sandlot::server {

inline constexpr std::size_t most_parameters = 10'000, most_named_parameters = 1000;

/// @return whether all fit
bool list_parameters(const Simulation& simulation, std::vector<foxglove::Parameter>& out);
/// Without a value when there is no such thing.
foxglove::Parameter read_parameter(const Simulation& simulation, const std::string& name);
/// The same for many, which costs less than one by one.
std::vector<foxglove::Parameter> read_parameters(const Simulation& simulation,
                                                 std::span<const std::string> names);

std::string parameter_name(std::string_view target, std::string_view field);
/// The request that sets it. Errors: a name or a value that cannot be one.
Result<ParameterRequest> parameter_request(const foxglove::Parameter& parameter);

}  // namespace sandlot::server
