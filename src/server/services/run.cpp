/// Services of simulation_interfaces about the run as a whole.
#include "server/services/result.h"

namespace sandlot::server::service {
namespace {

using msg::simulation::GetSimulationState;
using msg::simulation::GetSimulatorFeatures;
using msg::simulation::ResetSimulation;
using msg::simulation::SetSimulationState;
using msg::simulation::SimulationState;
using msg::simulation::StepSimulation;

/// Features of the simulator; simulation_interfaces names these without their types.
constexpr std::uint16_t known_features[] = {
    1,           // deleting
    8,           // categories
    10, 11,      // states of entities: get, set
    20, 21, 22,  // reset
    24, 25, 26,  // state of the simulation: get, set, pause
    31, 32,      // steps
};

bool is_over(Session::State state) {
  return state == Session::State::ended || state == Session::State::failed;
}

/// For ServiceHost::wait(): the run was reset, or loaded, since `epoch`.
auto is_past(std::uint64_t epoch) {
  return [epoch](const Session::Report& report) {
    return report.epoch != epoch ? std::optional(Status()) : std::nullopt;
  };
}

}  // namespace

void get_features(const ServiceContext&, const GetSimulatorFeatures::Request&,
                  const Reply<GetSimulatorFeatures>& reply) {
  GetSimulatorFeatures::Response response;
  response.features.features.assign(std::begin(known_features), std::end(known_features));
  reply(response);
}

void get_simulation_state(const ServiceContext& context, const GetSimulationState::Request&,
                          const Reply<GetSimulationState>& reply) {
  GetSimulationState::Response response;
  switch (context.host.session().report().state) {
    case Session::State::playing:
    case Session::State::seeking: response.state.state = SimulationState::playing; break;
    case Session::State::paused: response.state.state = SimulationState::paused; break;
    default: response.state.state = SimulationState::stopped;
  }
  response.result = make_result(SimResult::ok);
  reply(response);
}

void set_simulation_state(const ServiceContext& context, const SetSimulationState::Request& request,
                          const Reply<SetSimulationState>& reply) {
  Session& session = context.host.session();
  using Response = SetSimulationState::Response;
  const Session::State now = session.report().state;
  const bool over = is_over(now);
  const auto answer = [reply](std::uint8_t code, std::string why = "") {
    reply_result(reply, code, std::move(why));
  };
  const auto done = [answer](const Status& status) {
    if (status) answer(SimResult::ok);
    else answer(Response::state_transition_error, status.error().text());
  };
  const auto pauses = [](bool yes) {
    return [yes](const Session::Report& report) {
      const bool there = is_over(report.state) || (report.state == Session::State::paused) == yes;
      return there ? std::optional(Status()) : std::nullopt;
    };
  };
  switch (request.state.state) {
    case SimulationState::playing:
      if (over) return answer(Response::incorrect_transition, "the run has ended; reset it first");
      if (now != Session::State::paused) return answer(Response::already_in_target_state, "it is playing");
      session.play();
      return context.host.wait(pauses(false), done);
    case SimulationState::paused:
      if (over) return answer(Response::incorrect_transition, "the run has ended; reset it first");
      if (now == Session::State::paused) return answer(Response::already_in_target_state, "it is paused");
      session.pause();
      return context.host.wait(pauses(true), done);
    case SimulationState::stopped: {
      session.pause();
      const std::uint64_t epoch = session.report().epoch;
      if (const Status status = session.reset(); !status) return done(status);
      return context.host.wait(is_past(epoch), done);
    }
    case SimulationState::quitting:
      answer(SimResult::ok);
      session.quit();
      return;
    default: return answer(Response::incorrect_transition, "it can be stopped, playing, paused or quitting");
  }
}

void step_simulation(const ServiceContext& context, const StepSimulation::Request& request,
                     const Reply<StepSimulation>& reply) {
  Session& session = context.host.session();
  const std::uint64_t steps = request.steps;
  const Session::Report before = session.report();
  constexpr std::uint64_t most_steps = 1'000'000'000;
  if (before.state != Session::State::paused || steps == 0 || steps > most_steps) {
    const bool paused = before.state == Session::State::paused;
    return reply_result(reply, SimResult::operation_failed,
                        paused ? "1 to 1000000000 steps can be taken" : "the simulation is not paused");
  }
  session.step(steps);
  const auto there = [epoch = before.epoch,
                      target = before.tick + steps](const Session::Report& report) -> std::optional<Status> {
    if (report.epoch != epoch) return Error{"the run was reset or rewound meanwhile"};
    if (report.tick >= target) return Status();
    if (is_over(report.state)) return Error{"the run has ended"};
    return std::nullopt;
  };
  context.host.wait(there, [reply](const Status& status) { reply_status(reply, status); });
}

void reset_simulation(const ServiceContext& context, const ResetSimulation::Request& request,
                      const Reply<ResetSimulation>& reply) {
  Session& session = context.host.session();
  using Scope = ResetSimulation::Request;
  const std::uint8_t scope = request.scope;
  constexpr std::uint8_t whole = Scope::scope_time | Scope::scope_state;
  if (scope != Scope::scope_default && (scope & whole) != whole)
    return reply_result(reply, SimResult::feature_unsupported,
                        "time, state and what was spawned are reset together");
  const std::uint64_t epoch = session.report().epoch;
  if (const Status status = session.reset(); !status) return reply_status(reply, status);
  context.host.wait(is_past(epoch), [reply](const Status& status) { reply_status(reply, status); });
}

}  // namespace sandlot::server::service
