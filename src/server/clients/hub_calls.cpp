/// The services: console, watches, and those of simulation_interfaces.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "messages/services.h"
#include "server/clients/hub.h"
#include "server/clients/name_filter.h"

namespace sandlot::server {
namespace {

using msg::simulation::EntityCategory;
using SimResult = msg::simulation::Result;

/// simulation_interfaces names these without their types.
constexpr std::uint16_t known_features[] = {
    1,           // deleting
    8,           // categories
    10, 11,      // states of entities: get, set
    20, 21, 22,  // reset
    24, 25, 26,  // state of the simulation: get, set, pause
    31, 32,      // steps
};

SimResult result(std::uint8_t code, std::string why = "") {
  SimResult out;
  out.result = code;
  out.error_message = std::move(why);
  return out;
}

template <class M>
const M& as(const AnyMessage& message) {
  SL_CHECK(&message.info() == &message_info<M>());
  return *static_cast<const M*>(message.data());
}

std::uint8_t category_of(const Simulation::Entity& entity) {
  if (entity.instance.is_robot) return EntityCategory::robot;
  return entity.instance.model->is_static ? EntityCategory::static_object : EntityCategory::dynamic_object;
}

/// Answers a service whose response is but a result.
template <class Response>
void answer_result(Call& call, SimResult value) {
  Response response;
  response.result = std::move(value);
  call.answer(response);
}

template <class Response>
void answer_status(Call& call, const Status& status) {
  answer_result<Response>(
      call, status ? result(SimResult::ok) : result(SimResult::operation_failed, status.error().text()));
}

bool is_over(Session::State state) {
  return state == Session::State::ended || state == Session::State::failed;
}

}  // namespace

void Hub::add_services() {
  const auto add = [&](const char* name, const char* type, bool steers, auto act) {
    services_.push_back({name, find_service(type).value(), steers, act});
  };
  add("/sandlot/console", "sandlot_msgs/srv/Console", false, &Hub::on_console);
  add("/sandlot/complete", "sandlot_msgs/srv/Complete", false, &Hub::on_complete);
  add("/sandlot/watch", "sandlot_msgs/srv/Watch", false, &Hub::on_watch);
  add("/get_simulator_features", "simulation_interfaces/srv/GetSimulatorFeatures", false, &Hub::on_features);
  add("/get_simulation_state", "simulation_interfaces/srv/GetSimulationState", false, &Hub::on_get_state);
  add("/set_simulation_state", "simulation_interfaces/srv/SetSimulationState", true, &Hub::on_set_state);
  add("/step_simulation", "simulation_interfaces/srv/StepSimulation", true, &Hub::on_step);
  add("/reset_simulation", "simulation_interfaces/srv/ResetSimulation", true, &Hub::on_reset);
  add("/get_entities", "simulation_interfaces/srv/GetEntities", false, &Hub::on_entities);
  add("/get_entity_state", "simulation_interfaces/srv/GetEntityState", false, &Hub::on_get_entity);
  add("/set_entity_state", "simulation_interfaces/srv/SetEntityState", true, &Hub::on_set_entity);
  add("/delete_entity", "simulation_interfaces/srv/DeleteEntity", true, &Hub::on_delete_entity);
}

void Hub::call(ClientId id, Client& client, const foxglove::CallService& request) {
  const auto fail = [&](const std::string& why) {
    ++counts_.refused;
    transport_->send_text(id, foxglove::service_failure(request.service, request.call, why));
  };
  if (request.service == 0 || request.service > services_.size())
    return fail("there is no service " + std::to_string(request.service));
  const Service& service = services_[request.service - 1];
  if (service.steers && !client.may_steer) {
    fail("a spectator may not call " + std::string(service.name));
    refuse(id, "a spectator may not call " + std::string(service.name));
    return;
  }
  if (client.calls >= most_calls)
    return fail("more than " + std::to_string(most_calls) + " calls wait for their answers");
  const bool json = request.encoding == "json";
  if (!json && request.encoding != "cdr")
    return fail("'" + request.encoding.substr(0, 60) + "' is no encoding of requests; cdr and json are");
  const MessageInfo& info = *service.type->request;
  const auto message = json ? message_from_json(info, {reinterpret_cast<const char*>(request.bytes.data()),
                                                       request.bytes.size()})
                            : message_from_cdr(info, request.bytes);
  if (!message) return fail(std::string(service.name) + ": " + message.error().text());
  ++client.calls;
  const auto made = std::make_shared<Call>(mailbox_, id, request.service, request.call, request.encoding);
  (this->*service.act)(id, made, *message);
}

void Hub::on_console(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  const Speaker speaker{clients_.at(id).may_steer, {Source::Kind::admin, id}};
  post([&console = console_, speaker, call, line = as<msg::Console::Request>(request).line](Session&) {
    console.execute(line, speaker, [call](const Answer& answer) {
      msg::Console::Response response;
      response.ok = answer.ok;
      response.text = answer.text;
      call->answer(response);
    });
  });
}

void Hub::on_complete(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  post([&console = console_, call, line = as<msg::Complete::Request>(request).line](Session&) {
    msg::Complete::Response response;
    response.candidates = console.complete(line);
    call->answer(response);
  });
}

void Hub::on_watch(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  const auto& asked = as<msg::WatchValues::Request>(request);
  const auto no = [&](std::string why) {
    msg::WatchValues::Response response;
    response.text = std::move(why);
    call->answer(response);
  };
  Client& client = clients_.at(id);
  const std::size_t count = asked.values.size();
  if (count == 0) return no("no values were asked for");
  if (!(asked.rate_hz >= 0 && asked.rate_hz <= 1e6)) return no("the rate is not within 0 and 1e6 Hz");
  if (client.watched + count > most_watched || watched_ + count > most_watched_by_all) {
    ++counts_.refused;
    return no("at most " + std::to_string(most_watched) + " numbers can be watched, " +
              std::to_string(most_watched_by_all) + " by all viewers together");
  }
  const std::uint32_t made = next_channel_++;
  const bool posted = post([feed = feed_, mailbox = mailbox_, call, id, made, values = asked.values,
                            rate_hz = asked.rate_hz](Session&) {
    const Status status = feed->watch(made, values, rate_hz);
    mailbox->put([call, id, made, count = values.size(), status](Hub& hub) {
      hub.answer_watch(id, made, count, status, call);
    });
  });
  if (!posted) return;  // nobody will give them back
  client.watched += count;
  watched_ += count;
}

void Hub::answer_watch(ClientId id, std::uint32_t channel_id, std::size_t values, const Status& status,
                       const std::shared_ptr<Call>& call) {
  Client* const client = find(id);
  msg::WatchValues::Response response;
  if (!status || !client) {
    watched_ -= values;
    if (client) client->watched -= values;
    else post([feed = feed_, channel_id](Session&) { feed->unwatch(channel_id); });
    if (!status) response.text = status.error().text();
    call->answer(response);
    return;
  }
  Channel& made = channels_[channel_id];
  made.what = What::watch;
  made.owner = id;
  made.numbers = values;
  made.unused_since = Clock::now();
  const MessageInfo& info = *find_message("sandlot_msgs/msg/Samples").value();
  made.said = {channel_id, "/sandlot/watch/" + std::to_string(channel_id), "cdr", info.name, info.schema,
               "ros2msg"};
  transport_->send_text(id, foxglove::advertise(std::span(&made.said, 1)));
  response.ok = true;
  response.topic = made.said.topic;
  call->answer(response);
}

void Hub::on_features(ClientId, const std::shared_ptr<Call>& call, const AnyMessage&) {
  msg::simulation::GetSimulatorFeatures::Response response;
  response.features.features.assign(std::begin(known_features), std::end(known_features));
  call->answer(response);
}

void Hub::on_get_state(ClientId, const std::shared_ptr<Call>& call, const AnyMessage&) {
  using msg::simulation::SimulationState;
  msg::simulation::GetSimulationState::Response response;
  switch (session_.report().state) {
    case Session::State::playing:
    case Session::State::seeking: response.state.state = SimulationState::playing; break;
    case Session::State::paused: response.state.state = SimulationState::paused; break;
    default: response.state.state = SimulationState::stopped;
  }
  response.result = result(SimResult::ok);
  call->answer(response);
}

void Hub::on_set_state(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using msg::simulation::SimulationState;
  using Response = msg::simulation::SetSimulationState::Response;
  const Session::State now = session_.report().state;
  const bool over = is_over(now);
  const auto answer = [call](std::uint8_t code, std::string why = "") {
    answer_result<Response>(*call, result(code, std::move(why)));
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
  switch (as<msg::simulation::SetSimulationState::Request>(request).state.state) {
    case SimulationState::playing:
      if (over) return answer(Response::incorrect_transition, "the run has ended; reset it first");
      if (now != Session::State::paused) return answer(Response::already_in_target_state, "it is playing");
      session_.play();
      return wait(pauses(false), done);
    case SimulationState::paused:
      if (over) return answer(Response::incorrect_transition, "the run has ended; reset it first");
      if (now == Session::State::paused) return answer(Response::already_in_target_state, "it is paused");
      session_.pause();
      return wait(pauses(true), done);
    case SimulationState::stopped: {
      session_.pause();
      const std::uint64_t epoch = session_.report().epoch;
      if (const Status status = session_.reset(); !status) return done(status);
      return wait(
          [epoch](const Session::Report& report) {
            return report.epoch != epoch ? std::optional(Status()) : std::nullopt;
          },
          done);
    }
    case SimulationState::quitting:
      answer(SimResult::ok);
      session_.quit();
      return;
    default: return answer(Response::incorrect_transition, "it can be stopped, playing, paused or quitting");
  }
}

void Hub::on_step(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using Response = msg::simulation::StepSimulation::Response;
  const std::uint64_t steps = as<msg::simulation::StepSimulation::Request>(request).steps;
  const Session::Report before = session_.report();
  constexpr std::uint64_t most_steps = 1'000'000'000;
  if (before.state != Session::State::paused || steps == 0 || steps > most_steps) {
    const bool paused = before.state == Session::State::paused;
    return answer_result<Response>(
        *call, result(SimResult::operation_failed,
                      paused ? "1 to 1000000000 steps can be taken" : "the simulation is not paused"));
  }
  session_.step(steps);
  const auto there = [epoch = before.epoch,
                      target = before.tick + steps](const Session::Report& report) -> std::optional<Status> {
    if (report.epoch != epoch) return Error{"the run was reset or rewound meanwhile"};
    if (report.tick >= target) return Status();
    if (is_over(report.state)) return Error{"the run has ended"};
    return std::nullopt;
  };
  wait(there, [call](const Status& status) { answer_status<Response>(*call, status); });
}

void Hub::on_reset(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using Scope = msg::simulation::ResetSimulation::Request;
  using Response = msg::simulation::ResetSimulation::Response;
  const std::uint8_t scope = as<Scope>(request).scope;
  constexpr std::uint8_t whole = Scope::scope_time | Scope::scope_state;
  if (scope != Scope::scope_default && (scope & whole) != whole)
    return answer_result<Response>(
        *call, result(SimResult::feature_unsupported, "time, state and what was spawned are reset together"));
  const std::uint64_t epoch = session_.report().epoch;
  if (const Status status = session_.reset(); !status) return answer_status<Response>(*call, status);
  wait(
      [epoch](const Session::Report& report) {
        return report.epoch != epoch ? std::optional(Status()) : std::nullopt;
      },
      [call](const Status& status) { answer_status<Response>(*call, status); });
}

void Hub::wait(std::function<std::optional<Status>(const Session::Report&)> there,
               std::function<void(const Status&)> end) {
  waiting_.push_back({std::move(there), std::move(end), report_.tick, Clock::now()});
}

/// Calls that wait for the run to get somewhere. One that stands still does not get there any more.
void Hub::end_waiting() {
  constexpr std::chrono::seconds patience{5};
  const auto now = Clock::now();
  for (Waiting& each : waiting_) {
    std::optional<Status> there = each.there(report_);
    if (!there && std::exchange(each.tick, report_.tick) != report_.tick) each.since = now;
    if (!there && now > each.since + patience && report_.state != Session::State::playing)
      there = Error{"something else was asked of the run meanwhile"};
    if (!there) continue;
    each.end(*there);
    each.end = nullptr;
  }
  std::erase_if(waiting_, [](const Waiting& each) { return !each.end; });
}

void Hub::on_entities(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using msg::simulation::GetEntities;
  const auto& filters = as<GetEntities::Request>(request).filters;
  GetEntities::Response no;
  const auto filter = NameFilter::compile(filters.filter);
  if (!filter) no.result = result(SimResult::operation_failed, filter.error().text());
  if (!filters.tags.tags.empty()) no.result = result(SimResult::feature_unsupported, "entities have no tags");
  if (filters.bounds.type != msg::simulation::Bounds::empty)
    no.result = result(SimResult::feature_unsupported, "bounds are no filter here");
  if (!no.result.error_message.empty()) return call->answer(no);
  std::vector<std::uint8_t> categories;
  for (const EntityCategory& each : filters.categories) categories.push_back(each.category);
  post([call, filter = *filter, categories](Session& session) {
    GetEntities::Response response;
    response.result = result(SimResult::ok);
    for (const auto& entity : session.simulation().entities()) {
      if (!filter.matches(entity->instance.name)) continue;
      if (!categories.empty() &&
          std::find(categories.begin(), categories.end(), category_of(*entity)) == categories.end())
        continue;
      response.entities.push_back(entity->instance.name);
    }
    call->answer(response);
  });
}

void Hub::on_get_entity(ClientId, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using msg::simulation::GetEntityState;
  post([call, name = as<GetEntityState::Request>(request).entity](Session& session) {
    GetEntityState::Response response;
    const Simulation& simulation = session.simulation();
    const Simulation::Entity* const entity = simulation.find_entity(name);
    if (!entity || entity->instance.name != name) {
      response.result = result(SimResult::not_found, "there is nothing named '" + name.substr(0, 200) + "'");
      return call->answer(response);
    }
    response.result = result(SimResult::ok);
    response.state.header.stamp = simulation.now();
    response.state.header.frame_id = "world";
    response.state.pose = simulation.engine().pose(entity->id);
    const auto body = simulation.engine().bodies(entity->id).front();
    const Velocity& velocity = simulation.engine().states()[body.index].V_WB;
    response.state.twist.linear = velocity.linear;
    response.state.twist.angular = velocity.angular;
    call->answer(response);
  });
}

namespace {

/// Orders something of an entity and answers when it was carried out; while the run is paused at once, for that may be long.
template <class Response>
void order(Session& session, ClientId client, const std::shared_ptr<Call>& call, const std::string& name,
           Request request) {
  if (!session.simulation().find_instance(name))
    return answer_result<Response>(
        *call, result(SimResult::not_found, "there is nothing named '" + name.substr(0, 200) + "'"));
  const bool waits = session.report().state == Session::State::paused;
  const auto submitted = session.submit(
      std::move(request), {Source::Kind::admin, client}, [call](const Status& status) {
        answer_result<Response>(*call, status ? result(SimResult::ok)
                                              : result(SimResult::operation_failed, status.error().text()));
      });
  if (!submitted)
    answer_result<Response>(*call, result(SimResult::operation_failed, submitted.error().text()));
  else if (waits) answer_result<Response>(*call, result(SimResult::ok, "with the next tick"));
}

}  // namespace

void Hub::on_set_entity(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using msg::simulation::SetEntityState;
  using Response = SetEntityState::Response;
  const auto& asked = as<SetEntityState::Request>(request);
  if (asked.set_twist || asked.set_acceleration)
    return answer_result<Response>(*call, result(SimResult::feature_unsupported, "only poses can be set"));
  const std::string& frame = asked.state.header.frame_id;
  if (!frame.empty() && frame != "world")
    return answer_result<Response>(*call, result(Response::invalid_pose, "poses are in the frame 'world'"));
  const Pose pose = asked.state.pose;
  if (!is_finite(pose) || norm(pose.q) < 1e-6)
    return answer_result<Response>(*call, result(Response::invalid_pose, "the pose is not finite"));
  post([id, call, name = asked.entity, set = asked.set_pose, pose](Session& session) {
    if (!set) return answer_result<Response>(*call, result(SimResult::ok));
    order<Response>(session, id, call, name, PoseRequest{name, pose});
  });
}

void Hub::on_delete_entity(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request) {
  using msg::simulation::DeleteEntity;
  post([id, call, name = as<DeleteEntity::Request>(request).entity](Session& session) {
    order<DeleteEntity::Response>(session, id, call, name, DeleteRequest{name});
  });
}

}  // namespace sandlot::server
