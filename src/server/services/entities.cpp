/// Services of simulation_interfaces about what stands in the world.
#include <algorithm>

#include "server/services/entity_filter.h"
#include "server/services/frames.h"
#include "sim/world/lookup.h"

namespace sandlot::server::service {
namespace {

using msg::simulation::DeleteEntity;
using msg::simulation::EntityCategory;
using msg::simulation::EntityInfo;
using msg::simulation::EntityState;
using msg::simulation::GetEntities;
using msg::simulation::GetEntitiesStates;
using msg::simulation::GetEntityBounds;
using msg::simulation::GetEntityInfo;
using msg::simulation::GetEntityState;
using msg::simulation::SetEntityInfo;
using msg::simulation::SetEntityState;

/// Submits requests about an entity and answers when they have been carried out; while the run is paused at once, since the
/// next tick may be far away.
/// @param note  of an answer without a failure
template <class S>
void submit_requests(Session& session, ClientId client, const Reply<S>& reply, std::vector<Request> requests,
                     const std::string& note = "") {
  const bool waits = session.report().state == Session::State::paused;
  // They are carried out in one tick, in their order; the first that fails is the answer.
  const auto first = std::make_shared<Status>();
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const bool last = i + 1 == requests.size();
    const auto submitted = session.submit(std::move(requests[i]), {Source::Kind::admin, client},
                                          [reply, first, last, note](const Status& status) {
                                            if (*first && !status) *first = status;
                                            if (!last) return;
                                            if (*first) reply_result(reply, SimResult::ok, note);
                                            else reply_status(reply, *first);
                                          });
    if (!submitted) return reply_result(reply, SimResult::operation_failed, submitted.error().text());
  }
  if (waits || requests.empty())
    reply_result(reply, SimResult::ok,
                 (requests.empty() ? "" : "with the next tick") + (note.empty() ? "" : "; " + note));
}

const Simulation::Entity* find(const Session& session, const std::string& name) {
  return session.simulation().find_entity(name);
}

EntityState state_of(const Simulation& simulation, const Simulation::Entity& entity) {
  EntityState out;
  out.header.stamp = simulation.now();
  out.header.frame_id = "world";
  out.pose = simulation.engine().pose(entity.id);
  const Velocity velocity = velocity_of(simulation, entity);
  out.twist.linear = velocity.linear;
  out.twist.angular = velocity.angular;
  return out;
}

/// What the requested state asks of the entity. @return a result other than ok: why it cannot be had
SimResult requests_for(const Simulation& simulation, const Simulation::Entity& entity,
                       const SetEntityState::Request& wanted, std::vector<Request>& out, std::string& note) {
  using Response = SetEntityState::Response;
  constexpr double most_m = 1e6;
  const std::string& name = entity.instance.name;
  const EntityState& state = wanted.state;
  const auto frame = find_frame(simulation, state.header.frame_id);
  if (!frame)
    return make_result(Response::invalid_pose, "there is no frame '" + state.header.frame_id.substr(0, 100) +
                                                   "'; world, an entity, or one of its links and devices is");
  Pose X_WM = simulation.engine().pose(entity.id);
  if (wanted.set_pose) {
    if (!is_finite(state.pose) || norm(state.pose.q) < 1e-6)
      return make_result(Response::invalid_pose, "the pose is not finite, or its quaternion is zero");
    X_WM = frame->X_WF * Pose{state.pose.p, normalised(state.pose.q)};
    if (!(norm(X_WM.p) <= most_m))
      return make_result(Response::invalid_pose, "the pose is farther away than 1000 km");
    out.emplace_back(PoseRequest{name, X_WM});
  }
  const bool is_static = entity.instance.model->is_static;
  const auto moves = [](Vec3 a, Vec3 b) { return a != Vec3{} || b != Vec3{}; };
  if (wanted.set_acceleration) {
    if (is_static && moves(state.acceleration.linear, state.acceleration.angular))
      return make_result(SimResult::operation_failed, "'" + name + "' never moves");
    note = "accelerations are not set";
  }
  if (!wanted.set_twist) return make_result(SimResult::ok);
  if (!is_finite(state.twist.linear) || !is_finite(state.twist.angular))
    return make_result(SimResult::operation_failed, "the twist is not finite");
  if (is_static) {
    if (moves(state.twist.linear, state.twist.angular))
      return make_result(SimResult::operation_failed, "'" + name + "' never moves");
    return make_result(SimResult::ok);
  }
  // The twist is what the frame sees, which may move itself.
  const Velocity& V_WF = frame->V_WF;
  const Quat q = frame->X_WF.q;
  const Velocity V_WM{
      V_WF.linear + cross(V_WF.angular, X_WM.p - frame->X_WF.p) + rotate(q, state.twist.linear),
      V_WF.angular + rotate(q, state.twist.angular)};
  if (simulation.engine().capabilities().planar &&
      (V_WM.linear.z != 0 || V_WM.angular.x != 0 || V_WM.angular.y != 0))
    note = std::string(note.empty() ? "" : note + "; ") + "the planar engine keeps x, y and the turn about z";
  out.emplace_back(VelocityRequest{name, V_WM});
  return make_result(SimResult::ok);
}

}  // namespace

void get_entities(const ServiceContext& context, const GetEntities::Request& request,
                  const Reply<GetEntities>& reply) {
  GetEntities::Response response;
  EntityFilter filter;
  response.result = EntityFilter::compile(request.filters, filter);
  if (response.result.result != SimResult::ok) return reply(response);
  context.host.post([reply, filter = std::move(filter), response](Session& session) mutable {
    for (const Simulation::Entity* const each : filter.select(session.simulation()))
      response.entities.push_back(each->instance.name);
    reply(response);
  });
}

void get_entities_states(const ServiceContext& context, const GetEntitiesStates::Request& request,
                         const Reply<GetEntitiesStates>& reply) {
  GetEntitiesStates::Response response;
  EntityFilter filter;
  response.result = EntityFilter::compile(request.filters, filter);
  if (response.result.result != SimResult::ok) return reply(response);
  context.host.post([reply, filter = std::move(filter), response](Session& session) mutable {
    const Simulation& simulation = session.simulation();
    for (const Simulation::Entity* const each : filter.select(simulation)) {
      response.entities.push_back(each->instance.name);
      response.states.push_back(state_of(simulation, *each));
    }
    reply(response);
  });
}

void get_entity_state(const ServiceContext& context, const GetEntityState::Request& request,
                      const Reply<GetEntityState>& reply) {
  context.host.post([reply, name = request.entity](Session& session) {
    GetEntityState::Response response;
    const Simulation::Entity* const entity = find(session, name);
    response.result = entity ? make_result(SimResult::ok)
                             : make_result(SimResult::not_found, no_entity(name).what);
    if (entity) response.state = state_of(session.simulation(), *entity);
    reply(response);
  });
}

void set_entity_state(const ServiceContext& context, const SetEntityState::Request& request,
                      const Reply<SetEntityState>& reply) {
  context.host.post([client = context.client, reply, request](Session& session) {
    const Simulation::Entity* const entity = find(session, request.entity);
    if (!entity) return reply_result(reply, SimResult::not_found, no_entity(request.entity).what);
    std::vector<Request> requests;
    std::string note;
    SimResult fits = requests_for(session.simulation(), *entity, request, requests, note);
    if (fits.result != SimResult::ok) return reply_result(reply, fits.result, fits.error_message);
    submit_requests(session, client, reply, std::move(requests), note);
  });
}

void get_entity_info(const ServiceContext& context, const GetEntityInfo::Request& request,
                     const Reply<GetEntityInfo>& reply) {
  context.host.post([reply, name = request.entity](Session& session) {
    GetEntityInfo::Response response;
    const Simulation::Entity* const entity = find(session, name);
    response.result = entity ? make_result(SimResult::ok)
                             : make_result(SimResult::not_found, no_entity(name).what);
    if (entity) {
      response.info.category.category = category_of(*entity);
      response.info.description = entity->instance.info.description;
      response.info.tags = entity->instance.info.tags;
    }
    reply(response);
  });
}

void set_entity_info(const ServiceContext& context, const SetEntityInfo::Request& request,
                     const Reply<SetEntityInfo>& reply) {
  model::EntityInfo info;
  info.description = request.info.description;
  info.tags = request.info.tags;
  using model::Category;
  switch (request.info.category.category) {
    case EntityCategory::object: info.category = Category::object; break;
    case EntityCategory::robot: info.category = Category::robot; break;
    case EntityCategory::human: info.category = Category::human; break;
    case EntityCategory::dynamic_object: info.category = Category::dynamic_object; break;
    case EntityCategory::static_object: info.category = Category::static_object; break;
    default:
      return reply_result(reply, SimResult::operation_failed,
                          "there is no category " + std::to_string(request.info.category.category));
  }
  context.host.post([client = context.client, reply, name = request.entity, info](Session& session) {
    if (!find(session, name)) return reply_result(reply, SimResult::not_found, no_entity(name).what);
    submit_requests(session, client, reply, {InfoRequest{name, info}});
  });
}

void get_entity_bounds(const ServiceContext& context, const GetEntityBounds::Request& request,
                       const Reply<GetEntityBounds>& reply) {
  context.host.post([reply, name = request.entity](Session& session) {
    GetEntityBounds::Response response;
    const Simulation& simulation = session.simulation();
    const Simulation::Entity* const entity = find(session, name);
    response.result = entity ? make_result(SimResult::ok)
                             : make_result(SimResult::not_found, no_entity(name).what);
    if (entity) {
      const BodyId base = simulation.engine().bodies(entity->id).front();
      response.bounds = bounds_message(
          bounds_in(simulation, *entity, simulation.engine().states()[base.index].X_WB));
    }
    reply(response);
  });
}

void delete_entity(const ServiceContext& context, const DeleteEntity::Request& request,
                   const Reply<DeleteEntity>& reply) {
  context.host.post([client = context.client, reply, name = request.entity](Session& session) {
    if (!find(session, name)) return reply_result(reply, SimResult::not_found, no_entity(name).what);
    submit_requests(session, client, reply, {DeleteRequest{name}});
  });
}

}  // namespace sandlot::server::service
