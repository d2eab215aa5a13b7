#pragma once
/// Parameters of a simulation (sim/watch/parameters.h) in the form of the Foxglove protocol; names are their addresses.
///
/// Values    numbers, bools, names of choices; lists of numbers with a length.
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

/// The request that sets it. Errors: a name or a value that cannot be one.
Result<ParameterRequest> parameter_request(const foxglove::Parameter& parameter);

}  // namespace sandlot::server
