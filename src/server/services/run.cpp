/// Services of simulation_interfaces about the run as a whole.
#include <algorithm>

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
    0,  1,           // spawning, deleting
    2,  3,           // named poses, their bounds
    4,  5,  6,  7,   // tags and bounds of entities; boxes and hulls as filters
    8,  9,           // categories; spawning from a text
    10, 11, 12, 13,  // states and descriptions of entities: get, set
    14,              // spawnables
    20, 21, 22, 23,  // reset
    24, 25, 26,      // state of the simulation: get, set, pause
    31, 32,          // steps
    40, 41,          // loading of worlds, also from a text
    44, 45,          // the present world and those that there are
    50,              // spawning of several entities at once
};
/// Not here: 33 (an action), 42 (tags of worlds), 43 (unloading).

/// Whether it stands at its beginning because it was stopped.
bool is_stopped(ServiceHost& host) {
  const Session::Report report = host.session().report();
  return report.state == Session::State::paused && report.now == report.begin &&
         host.memory().stopped_at == report.epoch;
}

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
  response.features.spawn_formats = {"sdf", "urdf"};
  response.features.custom_info =
      "Sandlot: simulation_interfaces 2.1.0. Time and state are reset together. Requests that come while the "
      "run is "
      "paused act with the next step. Steps are a service, no action. docs/viewer_protocol.md";
  reply(response);
}

void get_simulation_state(const ServiceContext& context, const GetSimulationState::Request&,
                          const Reply<GetSimulationState>& reply) {
  GetSimulationState::Response response;
  const Session::Report report = context.host.session().report();
  switch (report.state) {
    case Session::State::playing:
    case Session::State::seeking: response.state.state = SimulationState::playing; break;
    case Session::State::paused:
      response.state.state = is_stopped(context.host) ? SimulationState::stopped : SimulationState::paused;
      break;
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
      if (is_stopped(context.host)) {  // it stands as it did, under another name
        context.host.memory().stopped_at = 0;
        return answer(SimResult::ok);
      }
      if (now == Session::State::paused) return answer(Response::already_in_target_state, "it is paused");
      session.pause();
      return context.host.wait(pauses(true), done);
    case SimulationState::stopped: {
      if (is_stopped(context.host)) return answer(Response::already_in_target_state, "it is stopped");
      session.pause();
      const std::uint64_t epoch = session.report().epoch;
      if (const Status status = session.reset(); !status) return done(status);
      return context.host.wait(is_past(epoch), [done, &host = context.host](const Status& status) {
        if (status) host.memory().stopped_at = host.session().report().epoch;
        done(status);
      });
    }
    case SimulationState::quitting:
      answer(SimResult::ok);
      session.quit();
      return;
    case SimulationState::no_world:
    case SimulationState::loading_world:
      return answer(Response::incorrect_transition, "worlds are loaded by /load_world");
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

/// Removes what came while the run went on.
void delete_spawned(const ServiceContext& context, const Reply<ResetSimulation>& reply) {
  context.host.post([client = context.client, reply](Session& session) {
    std::vector<std::string> names;
    for (const auto& each : std::as_const(session).simulation().entities())
      if (session.is_spawned(*each)) names.push_back(each->instance.name);
    struct Call {
      Reply<ResetSimulation> reply;
      Status status;
      ~Call() { reply_status(reply, status); }
    };
    const auto call = std::make_shared<Call>(Call{reply, {}});
    const bool waits = session.report().state == Session::State::paused;
    for (const std::string& name : names) {
      const auto submitted = session.submit(DeleteRequest{name}, {Source::Kind::admin, client},
                                            [call](const Status& status) {
                                              if (call->status && !status) call->status = status;
                                            });
      if (!submitted) call->status = submitted.error();
    }
    if (waits && call->status && !names.empty()) reply_result(reply, SimResult::ok, "with the next tick");
  });
}

void reset_whole(const ServiceContext& context, const Reply<ResetSimulation>& reply) {
  Session& session = context.host.session();
  const std::uint64_t epoch = session.report().epoch;
  if (const Status status = session.reset(); !status) return reply_status(reply, status);
  context.host.wait(is_past(epoch), [reply](const Status& status) { reply_status(reply, status); });
}

void reset_simulation(const ServiceContext& context, const ResetSimulation::Request& request,
                      const Reply<ResetSimulation>& reply) {
  using Scope = ResetSimulation::Request;
  const std::uint8_t scope = request.scope == Scope::scope_default ? Scope::scope_all : request.scope;
  constexpr std::uint8_t run = Scope::scope_time | Scope::scope_state;
  if (scope == Scope::scope_spawned) return delete_spawned(context, reply);
  if ((scope & run) != run)
    return reply_result(reply, SimResult::feature_unsupported,
                        "time and state are reset together: scope 3, 7 or 255; 4 removes what was spawned");
  if ((scope & Scope::scope_spawned) != 0) return reset_whole(context, reply);
  // The first state has nothing that came later.
  context.host.post([reply, context, back = context.host.way_back()](Session& session) {
    const auto entities = std::as_const(session).simulation().entities();
    const bool spawned = std::any_of(entities.begin(), entities.end(),
                                     [&](const auto& each) { return session.is_spawned(*each); });
    if (spawned)
      return reply_result(
          reply, SimResult::operation_failed,
          "what was spawned would go, too: reset it as well with scope 7, or remove it first");
    back([context, reply] { reset_whole(context, reply); });
  });
}

}  // namespace sandlot::server::service
