#pragma once
/// Sandlot inside a program of your own: load, step, read, command, save.
///
///   auto sim = or_exit(load_simulation("scenarios/indoor.yaml"));
///   while (sim->now().s() < 10) {
///     const auto scan = or_exit(reading<msg::LaserScan>(*sim, "rover/laser"));
///     or_exit(command(*sim, "rover/drive", msg::Twist{.linear = {scan.valid ? 0.3 : 0.0, 0, 0}}));
///     or_exit(sim->tick());
///   }
///
/// Errors    a Result or Status with the text to show: error().text(). or_exit() does so and ends the
///           program.
/// Threads   one thread at a time may use a Simulation; submit() (and command()) may be called from any.
///           Inside, a tick uses as many threads as SimulationOptions asks for; the result does not depend on
///           it.
/// Lifetime  a Simulation owns everything in it. What reading() returns is valid until the next tick.
///           Simulations are independent of each other; any number may live in one process.
/// Determinism  the same file, seed and commands at the same ticks give the same state_hash() after each.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "messages/command.h"
#include "messages/messages.h"
#include "messages/services.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"

namespace sandlot {

struct EmbedOptions {
  LoadOptions load;
  SimulationOptions simulation;
};

/// From a scenario, a world or a robot, as `sandlot run` takes it. Warnings go to `diagnostics`, or to
/// standard error.
Result<std::unique_ptr<Simulation>> load_simulation(const std::string& file, const EmbedOptions& options = {},
                                                    Diagnostics* diagnostics = nullptr);
/// From the text of a scenario; `name` stands for it in messages, and relative paths begin at its folder.
Result<std::unique_ptr<Simulation>> load_simulation_text(const std::string& yaml,
                                                         const std::string& name = "scenario.yaml",
                                                         const EmbedOptions& options = {},
                                                         Diagnostics* diagnostics = nullptr);
/// From what Simulation::snapshot() returned, in this process or another.
Result<std::unique_ptr<Simulation>> restore_simulation(std::span<const std::byte> snapshot,
                                                       const SimulationOptions& options = {},
                                                       Diagnostics* diagnostics = nullptr);

/// The topic of a device ("rover/laser": its active level; "rover/laser/ranges": that one) or of a program
/// ("rover/estimator/estimate") that carries `type`.
Result<const TopicBase*> find_reading(const Simulation& sim, std::string_view device, const char* type);

/// The latest message of a device. `valid`: there is one; `fresh`: it came in the latest tick.
/// Errors   no such device, or none with messages of this type: the message names what there is.
template <class M>
Result<View<M>> reading(const Simulation& sim, std::string_view device) {
  SL_ASSIGN(const TopicBase* const base, find_reading(sim, device, M::ros_type));
  const Topic<M>* const topic = topic_cast<M>(base);
  SL_CHECK(topic != nullptr);
  return View<M>{topic->message, topic->stamp, topic->count > 0 && topic->stamp == sim.now(),
                 topic->count > 0};
}

/// Fails unless the device ("rover/drive") takes commands of `type`, at whatever level.
Status check_commandable(const Simulation& sim, std::string_view device, const char* type);

/// Queues a command for the next tick. Its outcome: Simulation::outcomes().
/// Errors   no such device, or none that takes this type.
template <class M>
Status command(Simulation& sim, const std::string& device, const M& message) {
  SL_TRY(check_commandable(sim, device, M::ros_type));
  sim.submit(CommandRequest{device, M::ros_type, command_bytes(message)});
  return {};
}

/// Fails unless the device offers a service of that name and type.
Status check_callable(const Simulation& sim, std::string_view device, std::string_view service,
                      const char* type);

/// Queues a call of a device's service for the next tick, such as call<msg::std_srvs::Trigger>(sim, "rover/odometry", "reset").
/// @return number of the call, for response()
/// Errors   no such device or service, or one of another type.
template <class S>
Result<std::uint64_t> call(Simulation& sim, const std::string& device, const std::string& service,
                           const typename S::Request& request = {}) {
  SL_TRY(check_callable(sim, device, service, S::ros_type));
  CallRequest made{device, service, {}};
  write_cdr(message_info<typename S::Request>(), &request, made.bytes);
  return sim.submit(std::move(made));
}
/// Response to a call that the latest tick carried out. Errors: refused, or not in the latest tick.
template <class S>
Result<typename S::Response> response(const Simulation& sim, std::uint64_t call) {
  for (const Outcome& outcome : sim.outcomes()) {
    if (outcome.sequence != call) continue;
    SL_TRY(outcome.status);
    typename S::Response out{};
    SL_TRY(read_cdr(message_info<typename S::Response>(), outcome.response, &out));
    return out;
  }
  return Error{"the latest tick carried out no call of this number", "ask for it right after the tick"};
}

/// Present pose of an instance in the world.
Result<Pose> pose(const Simulation& sim, std::string_view instance);

/// The value, or the error on standard error and the end of the program with exit code 2: for main().
template <class T>
T or_exit(Result<T> result) {
  if (!result) {
    std::fprintf(stderr, "error: %s\n", result.error().text().c_str());
    std::exit(2);
  }
  if constexpr (!std::is_void_v<T>) return std::move(result).value();
}

}  // namespace sandlot
